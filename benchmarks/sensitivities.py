"""How the last state of a run changes with five parameters, and what that costs over the run."""

import statistics
from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np

from benchmarks import decay, lugre
from benchmarks.kernel import Kernel
from benchmarks.measuring import REPEATS, TIERS, TOLERANCES, Section, Target, mean_time
from benchmarks.variations import bristles, fading, swinging
from stickslip import Axis, Stribeck
from stickslip.friction import FrictionLaw
from stickslip.mechanisms import Mechanism
from stickslip.mechanisms.drives import Sine

MOST = 4.0
"""What a run with sensitivities may take, over a plain run."""
NUDGE = 1e-4
"""Relative change of a parameter in central differences."""
HEADS = (
    "case", "tolerance", "error", "plain run, us", "with sensitivities, us", "over a plain run",
    "by differences", "their error",
)  # fmt: skip
WHY = {
    "exact modes": ("each row of the record is gone through once more"),
    "smooth modes": ("each row of the record is gone through once more"),
}


@dataclass(frozen=True, kw_only=True)
class Case:
    """A run and what is known of its sensitivities at the end."""

    title: str
    modes: str
    mechanism: Mechanism
    law: FrictionLaw
    t_end: float
    error: float
    """What the error must stay below."""
    values: dict[str, float]
    """Parameters by path."""
    reference: Callable[[], np.ndarray]
    """Returns sensitivities of place and velocity (2, parameters) at the end."""


FADING = {"inertia": 1.0, "mu_k": 1.0, "mu_s": 1.5, "v_s": 0.05, "sigma_2": 0.1}
CASES = (
    Case(
        title="Block on a spring, in its fourth swing at 1.1 s",
        modes="exact modes", mechanism=decay.RIG, law=decay.LAW, t_end=1.1, error=1e-9,
        values={
            "mechanism.mass": decay.M,
            "mechanism.stiffness": decay.K,
            "mechanism.compression": decay.X_0,
            "mechanism.gravity": decay.G,
            "friction.kinetic_coefficient": decay.MU,
        },
        reference=lambda: swinging(1.1),
    ),
    Case(
        title="Axis driven by a sine, Stribeck friction, 2.8 s",
        modes="smooth modes",
        mechanism=Axis(inertia=1.0, drive=Sine(amplitude=2.0, frequency=1.0)),
        law=Stribeck(
            kinetic_coefficient=1.0, static_coefficient=1.5, stribeck_velocity=0.05,
            viscous_coefficient=0.1,
        ),
        t_end=2.8, error=1e-9,
        values={
            "mechanism.inertia": 1.0,
            "friction.kinetic_coefficient": 1.0,
            "friction.static_coefficient": 1.5,
            "friction.stribeck_velocity": 0.05,
            "friction.viscous_coefficient": 0.1,
        },
        reference=lambda: fading(2.8, **FADING),
    ),
    Case(
        title="Towed block with LuGre friction, 9 s",
        modes="stiff modes", mechanism=lugre.BLOCK, law=lugre.LAW, t_end=9.0, error=1e-6,
        values={
            "friction.kinetic_coefficient": lugre.F_K,
            "friction.static_coefficient": lugre.F_S,
            "friction.stribeck_velocity": lugre.V_S,
            "friction.bristle_stiffness": lugre.S0,
            "friction.bristle_damping": lugre.S1,
        },
        reference=lambda: bristles(9.0),
    ),
)  # fmt: skip


def off(found: np.ndarray, known: np.ndarray, values: Sequence[float]) -> float:
    """Return the largest error of p dx/dp, over the largest of its state."""
    scaled, right = found[:2] * values, known * values
    return float((np.abs(scaled - right).max(axis=1) / np.abs(right).max(axis=1)).max())


def differences(case: Case, compiled: bool) -> Callable[[float], np.ndarray]:
    """Return what takes central differences over ten runs."""
    runs = []
    for path, value in case.values.items():
        for side in (1, -1):
            kernel = Kernel(case.mechanism, case.law, case.t_end, compiled=compiled)
            kernel.change(path, value * (1 + side * NUDGE))
            runs.append(kernel)
    widths = [2 * NUDGE * value for value in case.values.values()]

    def take(tolerance: float) -> np.ndarray:
        ends = [kernel.run(tolerance).final()[:2] for kernel in runs]
        return np.transpose(np.array(ends[::2]) - np.array(ends[1::2])) / widths

    return take


def measured(case: Case, repeats: int, compiled: bool) -> tuple[tuple[str, ...], float, float]:
    """Return a row, and time over a plain run and error."""
    plain = Kernel(case.mechanism, case.law, case.t_end, compiled=compiled)
    slopes = Kernel(case.mechanism, case.law, case.t_end, compiled=compiled, slopes=True)
    sense, take = slopes.sensing(list(case.values)), differences(case, compiled)
    known, values = case.reference(), list(case.values.values())
    for tolerance in TOLERANCES:
        slopes.run(tolerance)
        error = off(sense(), known, values)
        if error <= case.error:
            break
    else:
        raise ArithmeticError(f"{case.title}: an error of {case.error:g} is not reached.")
    works = (
        lambda: plain.run(tolerance),
        lambda: (slopes.run(tolerance), sense()),
        lambda: take(tolerance),
    )
    times = [[mean_time(work) for work in works] for _ in range(repeats)]
    own, both, many = (statistics.median(column) for column in zip(*times, strict=True))
    cells = (
        f"{tolerance:.1e}", f"{error:.0e}", f"{1e6 * own:.3g}", f"{1e6 * both:.3g}",
        f"{both / own:.2f}", f"{many / own:.1f}", f"{off(take(tolerance), known, values):.0e}",
    )  # fmt: skip
    return (case.title, *cells), both / own, error


def run(repeats: int = REPEATS, tiers: Sequence[str] = tuple(TIERS)) -> Section:
    """Run the case."""
    rows, targets = [], []
    for case in CASES:
        row, ratio, error = measured(case, repeats, "compiled" in tiers)
        rows.append(row)
        if case.modes in WHY:
            targets.append(
                Target(
                    work=f"sensitivities, 5 parameters, {case.modes}",
                    goal=f"<= {MOST:g} x a plain run, {case.error:.0e}",
                    measured=f"{ratio:.2f} x, {error:.0e}",
                    met=ratio <= MOST and error <= case.error,
                    reason=WHY[case.modes],
                )
            )
    return Section(
        title="Sensitivities to five parameters", heads=HEADS, rows=tuple(rows), notes=NOTES,
        targets=tuple(targets),
    )  # fmt: skip


NOTES = (
    "- The kernel alone: a plain run; a run and the sensitivities of the last state; ten runs for"
    f" central differences of relative width {NUDGE:g}, at the same tolerance.",
    "- The error is that of p dx/dp over the largest of its state: against the closed form in"
    " complex numbers, and against the variational equations by hand in SciPy, DOP853 at 1e-13 from"
    " event to event, Radau at 1e-10 for the bristles.",
    "- Tolerances are the loosest that keep the error below 1e-9; below 1e-6 for the bristles.",
)
