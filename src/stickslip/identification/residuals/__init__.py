"""Errors of the model that residuals show."""
