"""Characteristics of friction laws: what experiments on the contact would record."""

from stickslip.lazy import attach

HOMES = {
    "Bench": "bench",
    "BreakAway": "break_away",
    "Characteristic": "base",
    "Characterization": "battery",
    "Cost": "cost",
    "Creep": "drift",
    "Drift": "drift",
    "Hunting": "hunting",
    "Lag": "lag",
    "Passivity": "passivity",
    "Presliding": "hysteresis",
    "PreslidingLoop": "presliding",
    "SteadyCurve": "steady",
    "StickSlipMap": "stick_slip",
    "TESTS": "battery",
    "characterize": "battery",
    "cycle_energy": "passivity",
    "presliding_length": "presliding",
    "presliding_loop": "presliding",
}

__all__ = sorted(HOMES)  # noqa: PLE0605  # read off the table above

__getattr__, __dir__ = attach(__name__, HOMES)
