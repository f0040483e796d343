"""Friction along the measured motion: measured directly, or by inverse dynamics."""
