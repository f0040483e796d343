"""``python -m benchmarks.identification_table``: what fits reach on measured records, and the bars.

Records come from the catalogue, which downloads them, or from the folder that ``STICKSLIP_DATA``
names. A record that cannot be had is said, and its rows are left out.
"""

import functools
import math
from collections.abc import Callable, Iterator
from dataclasses import dataclass, replace

import numpy as np
from stickslip.identify.fits.force_map.problem import force_map

from stickslip import (
    Axis,
    Coulomb,
    CoulombViscous,
    Dahl,
    DirectionDependent,
    FrictionLaw,
    Measurement,
    Stribeck,
    TowedBlock,
    fit,
)
from stickslip.data.catalogue import dataset
from stickslip.errors import StickslipError
from stickslip.identify.fits import RecordFit
from stickslip.identify.fits.estimation.levenberg_marquardt import search
from stickslip.identify.fits.records.fitting import fit_record
from stickslip.identify.fits.series.inverse_dynamics import inverse_dynamics
from stickslip.identify.kinds import features_of, fit_rate_state

AXIS = Axis(inertia=95.0)
"""EMPS; its mass is looked for."""
UNIT = Axis(inertia=1.0)
SLIDER_MASS = 0.0307
AFTER = 120e-6
"""Load-point displacement [m] behind the step that published fits of the rock use."""

PUBLISHED = (95.1089, 203.5034, 20.3935, -3.1648)
"""EMPS: mass [kg], viscous part [N s/m], level [N], offset [N] (Janot, Gautier, Brunot 2019)."""
DEVIATIONS = (0.1085, 1.146, 0.1012, 0.0444)
"""The second is printed to three decimals."""
BY_DIRECTION = (95.1540, 166.7061, 20.1440, 240.4236, 20.6277)


@dataclass(frozen=True, kw_only=True)
class Row:
    """One thing that was measured."""

    record: str
    what: str
    bar: str
    reached: str
    met: bool | None = None
    """None if there is no bar."""


def _below(record: str, what: str, bar: float, value: float, unit: str, digits: int = 3) -> Row:
    return Row(
        record=record,
        what=what,
        bar=f"<= {bar:g} {unit}",
        reached=f"{value:.{digits}g} {unit}",
        met=abs(value) <= bar,
    )


def emps_fit(law: type[FrictionLaw]) -> RecordFit:
    """Return a law fitted to EMPS, segments of 1 s, the mass looked for."""
    record = dataset("emps").measurement()
    return fit_record(AXIS, law, record, unknown=("inertia",))


def emps_shooting() -> Iterator[Row]:
    for law, bar in ((CoulombViscous, 0.47), (DirectionDependent, 0.14)):
        found = emps_fit(law)
        yield _below("emps", f"{law.title}, 1 s segments", bar, 1e3 * found.rms, "mm", 4)


def emps_stribeck() -> Iterator[Row]:
    found = emps_fit(Stribeck)
    told = [s for s in found.sentences if "mu_s" in s or "v_s" in s or "step" in s]
    yield Row(
        record="emps",
        what="Stribeck step",
        bar="reported as undetermined",
        reached=told[0] if told else "told",
        met=bool(told),
    )


def emps_least_squares() -> Iterator[Row]:
    record = dataset("emps").measurement()
    filtered = functools.partial(inverse_dynamics, UNIT, record, cutoff=100, decimate=10)
    both, apart = filtered(), filtered(directional=True, offset=False)
    errors = [100 * both.relative_error, 100 * apart.relative_error]
    for what, values, known in (
        ("least squares", both.values, PUBLISHED),
        ("their standard deviations", both.deviations, DEVIATIONS),
        ("least squares by direction", apart.values[[0, 1, 3, 2, 4]], BY_DIRECTION),
        ("relative errors, %", errors, (4.0834, 3.1117)),
    ):  # fmt: skip
        found = [round(float(value), 4) for value in values]
        yield Row(
            record="emps",
            what=what,
            bar=", ".join(f"{value:.7g}" for value in known),
            reached=", ".join(f"{value:.7g}" for value in found),
            # a printed digit may be rounded the other way
            met=all(
                abs(f - k) <= 1.01 * 10.0 ** -_decimals(k)
                for f, k in zip(found, known, strict=True)
            ),
        )


def _decimals(printed: float) -> int:
    return len(f"{printed:.7g}".partition(".")[2])


def between(record: Measurement, first: float, last: float) -> Measurement:
    """Return the samples of a stretch of time."""
    assert isinstance(record.time, np.ndarray)
    kept = (record.time >= first) & (record.time < last)
    names = ("time", *record.quantities())
    return Measurement(**{name: np.asarray(getattr(record, name))[kept] for name in names})


def tribometer() -> Iterator[Row]:
    record = dataset("reciprocating_tribometer").measurement()
    for law, bar in (
        (Coulomb, None),
        (Dahl(kinetic_coefficient=0.4, bristle_stiffness=4e3), 11.6),
        (Dahl, 5.5),
    ):
        problem = force_map(law, UNIT, between(record, 12.0, 75.0))
        values = search(problem, starts=1).best.values
        judged = force_map(problem.law, UNIT, between(record, 12.0, 110.0), samples=math.inf)
        judged = replace(judged, free_parameters=problem.free_parameters)
        late = judged.times >= 75.0
        residual = (judged.measured - judged.predicted(values))[late]
        error = 100.0 * float(np.sqrt(np.mean(residual**2) / np.mean(judged.measured[late] ** 2)))
        title = "Coulomb" if law is Coulomb else "Dahl" if law is not Dahl else "Dahl with exponent"
        yield Row(
            record="tribometer",
            what=f"{title}, 12 to 75 s, judged 75 to 110 s",
            bar="" if bar is None else f"<= {bar:g} %",
            reached=f"{error:.3g} %",
            met=None if bar is None else error <= bar,
        )


def rock() -> Iterator[Row]:
    record = dataset("rock_velocity_step").measurement()
    machine = TowedBlock(mass=1e-3, stiffness=1e3, speed=2e-7, load=1.0)
    free = ["friction.*", "mechanism.stiffness"]
    found = fit_rate_state(machine, "rate-and-state", record, vary=free, after=AFTER)
    rate = found.derived[0]
    value = rate.value
    yield Row(
        record="rock",
        what="a - b, first 120 um behind the step",
        bar="0.0157 +- 0.001",
        reached=f"{value:.4f} ({rate.low:.4f} to {rate.high:.4f})",
        met=abs(value - 0.0157) <= 0.001,
    )
    yield _below("rock", "residual", 1.13e-3, found.rms, "")
    yield Row(
        record="rock",
        what="a and b",
        bar="inseparable",
        reached="separable" if found.details["separable"] else "inseparable",
        met=not found.details["separable"],
    )
    whole = fit_rate_state(machine, "rate-and-state", record, vary=free)
    yield Row(
        record="rock",
        what="a - b, whole record",
        bar="",
        reached=f"{whole.derived[0].value:.4f}: it depends on how much is used",
    )


def _slider(file: str) -> tuple[Measurement, TowedBlock]:
    record = dataset("spring_pulled_slider")
    known = record.file(file).known
    block = TowedBlock(
        mass=SLIDER_MASS,
        stiffness=float(known["stiffness_N_per_m"]),
        speed=float(known["speed_m_per_s"]),
    )
    return record.measurement(file), block


def slider() -> Iterator[Row]:
    record, block = _slider("k1002_v4300")
    half = len(record.time) // 2
    first, second = (
        Measurement(time=record.time[rows], spring_force=record.values("spring_force")[rows])
        for rows in (slice(half), slice(half, None))
    )
    free = fit(block, Coulomb, first, vary=["friction.*", "mechanism.mass"])
    errors = free.judged(second)
    for name, bar in (("frequency", 5.0), ("mean", 6.0), ("standard_deviation", 10.0)):
        what = f"{name.replace('_', ' ')} of the second half, mass free"
        yield _below("slider", what, bar, 100.0 * errors[name], "%", 2)
    stated = {"mass": block.mass, "stiffness": block.stiffness}
    nominal = fit(block, Coulomb, record, fixed=stated)
    warned = any("effective mass" in sentence for sentence in nominal.sentences)
    yield Row(
        record="slider",
        what="frequency with the nominal mass",
        bar="18.6 % off, with a warning",
        reached=f"{100 * nominal.details['errors']['frequency']:.1f} %,"
        f" {'with' if warned else 'without'} a warning",
        met=warned,
    )


def drifting_slider() -> Iterator[Row]:
    found = features_of(_slider("k168_v4300")[0], mechanism=_slider("k168_v4300")[1])
    yield Row(
        record="slider",
        what="drift of k168_v4300",
        bar="flagged",
        reached=f"{found.halves[0]:.3f} -> {found.halves[1]:.3f},"
        f" {'flagged' if found.drifts else 'not flagged'}",
        met=found.drifts,
    )


PARTS: tuple[tuple[str, Callable[[], Iterator[Row]]], ...] = (
    ("emps", emps_shooting),
    ("emps", emps_stribeck),
    ("emps", emps_least_squares),
    ("reciprocating_tribometer", tribometer),
    ("rock_velocity_step", rock),
    ("spring_pulled_slider", slider),
    ("spring_pulled_slider", drifting_slider),
)


def rows(name: str, part: Callable[[], Iterator[Row]]) -> Iterator[Row]:
    """Yield the rows of a part, or why there are none."""
    try:
        yield from part()
    except StickslipError as error:
        yield Row(record=name, what="missing", bar="", reached=str(error))


def main() -> None:
    print("| record | what | bar | reached | met |\n|---|---|---|---|---|")
    for name, part in PARTS:
        for row in rows(name, part):
            met = "" if row.met is None else "yes" if row.met else "no"
            cells = (row.record, row.what, row.bar, row.reached, met)
            print(f"| {' | '.join(cells)} |", flush=True)


if __name__ == "__main__":
    main()
