"""Fits to records in time and to measured friction."""
