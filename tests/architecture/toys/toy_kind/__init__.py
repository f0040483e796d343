"""A kind as a contributor would write it: the steady speed of a slider under a steady force."""
