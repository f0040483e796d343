"""Identification and selection of laws: one judge for all kinds of measurements."""
