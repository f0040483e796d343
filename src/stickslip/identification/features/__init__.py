"""Fits to features of stick-slip."""
