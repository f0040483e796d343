"""Travels: distances to rest, or per cycle of a drive."""
