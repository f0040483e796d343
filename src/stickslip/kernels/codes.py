"""Whole numbers that pass between generated modules, kernels and their readers."""

__all__ = [
    "AT",
    "AT_REST",
    "BREAK_BACKWARD",
    "BREAK_FORWARD",
    "BROKE_AWAY",
    "END_TIME",
    "EVENT_COUNT",
    "EVENT_TIME",
    "EXACT",
    "FINAL",
    "GRADIENT",
    "GREATEST",
    "LEFT_GROUND",
    "LIFTED_OFF",
    "LIFT_OFF",
    "MEAN",
    "REVERSED",
    "RUNNING",
    "SMALLEST",
    "SMOOTH",
    "STEP_LIMIT",
    "STEP_TOO_SMALL",
    "STIFF",
    "STOP",
    "STOPPED",
    "SWITCH",
    "SWITCHED",
    "ZENO",
]

# Index of each guard in the vector of guards; switch j has index SWITCH + j.
STOP = 0
BREAK_FORWARD = 1
BREAK_BACKWARD = 2
LIFT_OFF = 3
SWITCH = 4

# What is kept of a run in an ensemble.
FINAL = 0
AT = 1
GREATEST = 2
SMALLEST = 3
MEAN = 4
EVENT_TIME = 5
EVENT_COUNT = 6
GRADIENT = 7

# What happened, in the records of events; switch j gives SWITCHED + 2 j, one more where it ceases.
STOPPED = 0
REVERSED = 1
BROKE_AWAY = 2
LEFT_GROUND = 3
SWITCHED = 4

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
