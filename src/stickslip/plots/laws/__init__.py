"""Plots of friction laws."""
