"""Draw the figures of the README into docs/figures/: python docs/make_figures.py."""

import re
from pathlib import Path

import numpy as np

from stickslip import (
    PID,
    Axis,
    Capsule,
    Coulomb,
    FixedStep,
    Sine,
    Torque,
    average_velocity,
    closed_loop,
    load_rig,
    select,
    simulate,
)
from stickslip.plots import SURFACE, Draw, Size, standalone_svg
from stickslip.plots.loop import LOOP_SIZES, draw_closed_loop
from stickslip.plots.maps import draw_velocity_map
from stickslip.plots.separation import SEPARATION_SIZES, draw_separation
from stickslip.plots.steps import draw_fixed_steps

FOLDER = Path(__file__).parent / "figures"
PAD = 16
"""Of the card around a figure, which keeps it readable on dark pages [CSS px]."""


def card(name: str, draw: Draw, size: Size, title: str) -> None:
    """Save a figure on a card with round corners."""
    svg = standalone_svg(draw, size=size, title=title)
    width, height = size[0] + 2 * PAD, size[1] + 2 * PAD
    rest = svg[svg.index(">") + 1 :]
    head = svg[: svg.index(">") + 1]
    for key, value in (("width", width), ("height", height)):
        head = re.sub(rf' {key}="[^"]*"', f' {key}="{value:g}"', head)
    box = f"{-PAD} {-PAD} {width:g} {height:g}"
    head = re.sub(r'viewBox="[^"]*"', f'viewBox="{box}"', head)
    x, y, w, h = box.split()
    paper = f'<rect x="{x}" y="{y}" width="{w}" height="{h}" rx="8" fill="{SURFACE}"/>'
    (FOLDER / name).write_text(head + paper + rest, encoding="utf-8", newline="\n")


def separation() -> None:
    """Six laws that agree on the one travel that was measured."""
    rig = load_rig()
    verdict = select(rig.mechanism, rig.measurement, rig.laws, t_end=rig.t_end)
    draw = draw_separation(
        verdict.separations,
        "coulomb",
        [(rig.mechanism.compression, rig.measurement.travel)],
        proposed=[row.value for row in verdict.proposal.settings],
        titles={candidate.name: candidate.title for candidate in verdict.candidates},
    )
    card(
        "separation.svg",
        draw,
        SEPARATION_SIZES["wide"],
        "Travel that six fitted friction laws predict against the compression of the spring:"
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
    card(
        "chatter.svg",
        draw,
        (880, 260),
        "Velocity around the stop: the event-driven run ends at zero, fixed steps chatter",
    )


def reversal() -> None:
    """The direction of a vibro-impact capsule against the frequency of its drive."""
    capsule = Capsule(
        capsule_mass=0.8,
        inner_mass=0.2,
        stiffness=100.0,
        damping=0.3,
        upper_stop=0.02,
        restitution=0.6,
        drive=Torque(drive=Sine(amplitude=1.0, frequency=4.0)),
    )
    found = average_velocity(
        capsule,
        Coulomb(kinetic_coefficient=0.05),
        {"mechanism.drive.drive.frequency": np.linspace(2.5, 6.0, 141)},
    )
    card(
        "reversal.svg",
        draw_velocity_map(found),
        (800, 320),
        "Mean velocity of a capsule against the frequency of its drive: forward at resonance,"
        " backward above 4.42 Hz, none where the inner mass does not reach its stop",
    )


def hunting() -> None:
    """Integral action that hunts about its target, because rest holds more than sliding."""
    law = Coulomb(kinetic_coefficient=1.0, static_coefficient=1.5)
    pid = PID(proportional=100.0, integral=300.0, derivative=20.0, reference=0.1)
    loop = closed_loop(Axis(inertia=1.0), law, pid, period=5e-3, t_end=40.0)
    card(
        "hunting.svg",
        draw_closed_loop(loop, reference=0.1, level=1.5, since=2.0),
        LOOP_SIZES["wide"],
        "Position and command of an axis whose integral action hunts: it rests beside its target"
        " while the command grows to the break-away level, jumps past the target and rests again",
    )


if __name__ == "__main__":
    FOLDER.mkdir(exist_ok=True)
    reversal()
    separation()
    chatter()
    hunting()
