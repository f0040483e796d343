"""Plots of simulated runs."""
