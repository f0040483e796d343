"""Plots of measurements and rigs."""
