"""Numeric loops in a small part of Python that is compiled; they know only vectors of numbers."""
