"""Numeric loops in the subset of Python that numba compiles; they know only arrays of numbers."""
