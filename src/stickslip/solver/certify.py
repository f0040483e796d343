"""The certificate of a run: evidence that does not come from error control."""

from collections.abc import Sequence
from types import ModuleType

import numpy as np

from stickslip.solver.playback import Playback
from stickslip.trajectory import Certificate

__all__ = ["certify"]

VIOLATION_LIMIT = 1e-9
ENERGY_LIMIT = 1e-8
"""Steps of relative error 1e-12 add up over a long run, and rounding over a longer one."""
RESIDUAL_LIMIT = 1e-6
"""Events are located to rounding of the time; a steep guard at a late time leaves this much."""


def certify(
    playback: Playback,
    module: ModuleType,
    real: Sequence[float],
    whole: Sequence[int],
    tolerance: float,
) -> Certificate:
    """Check energy, guards, events and stick of a finished run."""
    books = _books(playback, module, real)
    energy_error = books["energy_error"]
    violation, residual = real[module.VIOLATION], real[module.RESIDUAL]
    drift = _stick_drift(playback, module)
    energy_limit = max(ENERGY_LIMIT, 1e3 * tolerance)
    problems = []
    if not energy_error <= energy_limit:
        problems.append(f"energy does not balance: {energy_error:.1e}, allowed {energy_limit:.0e}")
    if not violation <= VIOLATION_LIMIT:
        problems.append(f"a condition of a mode is violated by {violation:.1e} of its size")
    if not residual <= RESIDUAL_LIMIT:
        problems.append(f"an event was located only to {residual:.1e} of its guard")
    if drift != 0:
        problems.append(f"a stuck body moved by {drift:.1e} m")
    return Certificate(
        **books,
        guard_violation=violation,
        event_residual=residual,
        stick_drift=drift,
        steps=whole[module.STEPS],
        rejected=whole[module.REJECTED],
        problems=tuple(problems),
    )


def _books(playback: Playback, module: ModuleType, real: Sequence[float]) -> dict[str, float]:
    """Return energies and works, and their mismatch over the largest of them."""
    start, end = (_energy(playback, module, at) for at in (0, -1))
    supplied, taken = real[module.SUPPLIED], real[module.TAKEN]
    size = max(abs(start), abs(end), abs(supplied), abs(taken))
    mismatch = abs(end - start - supplied + taken)
    return {
        "energy_error": mismatch / size if size > 0 else 0.0,
        "energy_start": start,
        "energy_end": end,
        "work_supplied": supplied,
        "work_friction": taken,
    }


def _energy(playback: Playback, module: ModuleType, at: int) -> float:
    """Return the energy at the start of the first row or the end of the last."""
    row = playback.rows[at]
    t = row[0] if at == 0 else row[1]
    index = np.array([at % len(playback.rows)])
    state = playback.states(np.array([t]), index)[0].tolist()
    out = [0.0]
    module.energy(int(row[4]), float(t), state, playback.parameters(int(row[5])), out)
    return out[0]


def _stick_drift(playback: Playback, module: ModuleType) -> float:
    """Return the largest change of the slip coordinate within a row of sticking."""
    rows = playback.rows
    stuck = rows[rows[:, 3] == 0]
    coordinate = module.SLIP - module.N_COORDINATES
    n = module.N_STATES
    places = [module.DENSE_AT + term * n + coordinate for term in range(module.TERMS)]
    return float(np.abs(stuck[:, places]).max()) if len(stuck) else 0.0
