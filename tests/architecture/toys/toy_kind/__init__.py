"""A kind as a contributor would write it: how far a block slides down an incline in a time."""
