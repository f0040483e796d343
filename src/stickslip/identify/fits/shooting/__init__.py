"""Simulated segments, each from an initial state of its own."""
