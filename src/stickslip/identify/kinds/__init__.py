"""Kinds of measurements as problems of the judge."""
