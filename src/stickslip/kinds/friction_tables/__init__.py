"""Friction at steady speeds: its laws, and a curve that is none."""
