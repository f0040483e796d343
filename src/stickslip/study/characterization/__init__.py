"""Characteristics of friction laws: what experiments on the contact would record."""

from stickslip.lazy import attach

HOMES = {
    "Bench": "bench",
    "BreakAway": "presliding_tests",
    "Characteristic": "bench",
    "Characterization": "battery",
    "Cost": "stick_slip_tests",
    "Creep": "presliding_tests",
    "Drift": "presliding_tests",
    "Hunting": "stick_slip_tests",
    "Lag": "sliding_tests",
    "Passivity": "sliding_tests",
    "Presliding": "presliding_tests",
    "PreslidingLoop": "bench",
    "SteadyCurve": "sliding_tests",
    "StickSlipMap": "stick_slip_tests",
    "TESTS": "battery",
    "characterize": "battery",
    "cycle_energy": "sliding_tests",
    "presliding_length": "bench",
    "presliding_loop": "bench",
}

__all__ = sorted(HOMES)  # noqa: PLE0605  # read off the table above

__getattr__, __dir__ = attach(__name__, HOMES)
