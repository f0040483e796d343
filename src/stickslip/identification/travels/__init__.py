"""Fits to travels."""
