"""Whole numbers that pass between generated modules, kernels and their readers."""

__all__ = [
    "AT_REST",
    "BREAK_BACKWARD",
    "BREAK_FORWARD",
    "END_TIME",
    "EXACT",
    "LIFTED_OFF",
    "LIFT_OFF",
    "RUNNING",
    "SMOOTH",
    "STEP_LIMIT",
    "STEP_TOO_SMALL",
    "STIFF",
    "STOP",
    "SWITCH",
    "ZENO",
]

# Index of each guard in the vector of guards; switch j has index SWITCH + j.
STOP = 0
BREAK_FORWARD = 1
BREAK_BACKWARD = 2
LIFT_OFF = 3
SWITCH = 4

# How a mode is stepped: DOP853, Rodas5P, series.
SMOOTH = 0
STIFF = 1
EXACT = 2

# How a run ended.
RUNNING = 0
END_TIME = 1
AT_REST = 2
LIFTED_OFF = 3
STEP_LIMIT = 4
STEP_TOO_SMALL = 5
ZENO = 6
