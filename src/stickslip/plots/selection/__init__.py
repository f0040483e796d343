"""Plots of fits and of their residuals."""
