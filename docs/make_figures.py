"""Draw the figures of the README into docs/figures/: python docs/make_figures.py."""

from pathlib import Path

from stickslip import FixedStep, load_rig, select, simulate
from stickslip.plots import save
from stickslip.plots.separation import SEPARATION_SIZES, draw_separation
from stickslip.plots.steps import draw_fixed_steps

FOLDER = Path(__file__).parent / "figures"


def separation() -> None:
    """Six laws that agree on the one travel that was measured."""
    rig = load_rig()
    verdict = select(rig.mechanism, rig.measurement, rig.laws, t_end=rig.t_end)
    draw = draw_separation(
        verdict.separations,
        "coulomb",
        [(rig.mechanism.compression, rig.measurement.travel)],
        titles={candidate.name: candidate.title for candidate in verdict.candidates},
    )
    save(
        draw,
        FOLDER / "separation.svg",
        size=SEPARATION_SIZES["wide"],
        title="Travel that six fitted friction laws predict against the compression of the spring:"
        " all meet at the one measured point and part at 40 and 150 mm",
    )


def chatter() -> None:
    """The stop of the block, event-driven and with a fixed step."""
    rig = load_rig()
    law = rig.laws["coulomb"]
    fixed = {
        "fixed step of 10 ms, no stick rule": FixedStep(dt=0.01, stick_rule=False),
        "fixed step of 1 ms, no stick rule": FixedStep(dt=0.001, stick_rule=False),
    }
    draw = draw_fixed_steps(
        simulate(rig.mechanism, law, t_end=1.0),
        {
            label: simulate(rig.mechanism, law, t_end=1.0, solver=solver)
            for label, solver in fixed.items()
        },
    )
    save(
        draw,
        FOLDER / "chatter.svg",
        size=(880, 260),
        title="Velocity around the stop: the event-driven run ends at zero, fixed steps chatter",
    )


if __name__ == "__main__":
    FOLDER.mkdir(exist_ok=True)
    separation()
    chatter()
