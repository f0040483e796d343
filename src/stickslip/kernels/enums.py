"""Whole numbers that pass between generated modules, kernels and their readers."""

# Index of each guard in the vector of guards; switch j has index SWITCH + j. Limits, which end the
# run, follow the switches, and then the hard stops, here called walls.
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

# Modes of a coordinate where several contacts rub: held, slipping, without friction; pushed to its
# static level, in decisions, is PUSHED times the direction.
HELD_FAST = 0
FORWARD = 1
BACKWARD = -1
FREE = 2
PUSHED = 3
UNLOADED = 3
"""Mode of a contact that is open, in what a run records."""

# What happened, in the records of events. An impact of coordinate i gives HIT + i; limits
# follow them, and then switch j has two codes, the second where it ceases to hold. With several
# contacts coordinates that leave their stops come last.
STOPPED = 0
REVERSED = 1
BROKE_AWAY = 2
LEFT_GROUND = 3
LEFT_STOP = 4
HIT = 5
OPENED = 5  # with several contacts: impacts follow these two
CLOSED_AGAIN = 6

# How a mode is stepped: DOP853, Rodas5P, series.
SMOOTH = 0
STIFF = 1
EXACT = 2

# How a run ended; limit j gives LIMITED + j.
RUNNING = 0
END_TIME = 1
AT_REST = 2
LIFTED_OFF = 3
STEP_LIMIT = 4
STEP_TOO_SMALL = 5
ZENO = 6
FULL = 7  # not yet: the caller makes room for rows, and calls again
LIMITED = 8
