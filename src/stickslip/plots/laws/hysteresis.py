"""Friction against displacement: measured loops, and those of laws along the same motion."""
