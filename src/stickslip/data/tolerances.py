"""Tolerances that the modules of the room share, and limits of what readers take."""

from typing import Final

INTERVAL: Final = 1.96
"""Half-width of an interval of 95 % over its standard deviation, as tables are divided by it."""
NEARLY_ALL: Final = 0.9
"""Share, or correlation, from which a part stands for the rest."""
MOSTLY: Final = 0.8
"""Share from which some exceptions are noise."""
HALF: Final = 0.5
"""Share from which more speaks for it than against it."""
SMALL: Final = 0.1
"""Share below which a part is small beside the rest."""
SLIGHT: Final = 0.05
"""Share that a fit would just notice."""
NEGLIGIBLE: Final = 0.01
"""Share of the largest that counts as nothing."""
ROUNDED: Final = 0.02
"""Share by which numbers differ that were given with two digits."""
PER_MILLE: Final = 0.001
"""Share that clocks and counts leave."""
SIX_DIGITS: Final = 1e-6
"""Share by which numbers with six digits differ."""
ROUNDING: Final = 1e-9
"""Share that sums of floating-point numbers leave."""
DECADE: Final = 10.0
"""Factor that no error of a reading makes."""
GAP: Final = 3.0
"""Usual steps from which a step stands out: one of time is a gap, across which nothing is
filtered."""
FEWEST: Final = 3
"""Values with which an order, or a repetition, is none by chance."""
FEWEST_SAMPLES: Final = 10
"""Samples without which nothing is told of a signal."""
FEW_SAMPLES: Final = 30
"""Samples without which nothing is filtered, and no scatter is known."""
LISTED: Final = 6
"""Trials, times or columns that a sentence of a check names."""
MOST_LISTED: Final = 12
"""Columns or topics that a message of a reader names."""
LONGEST_HEAD: Final = 20_000
"""Characters at the top of a text in which its format shows."""
LONGEST_LINE: Final = 100_000
"""Characters of a line, or of a cell that is no number, that are looked at."""
LARGEST_TEXT: Final = 10_000_000
"""Bytes of a text that is read as one, such as a rig file or the metadata of a log."""
MOST_CELLS: Final = 20_000_000
"""Cells of a sheet, or numbers of a matrix, that are read."""
MOST_SIGNALS: Final = 64
"""Columns of a matrix, or elements of an array in a message, up to which each is a signal."""
MOST_ENTRIES: Final = 1_000
"""Structs of an array, characters of a text and pieces between gaps that are looked at."""
DEEPEST: Final = 100
"""Most tables or structs within each other."""
LONGEST_NAME: Final = 500
"""Characters of the name of a column: what is sought in names takes the square of them."""
