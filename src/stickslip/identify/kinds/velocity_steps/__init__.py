"""Velocity steps of a load point, fitted by rate-and-state friction."""
