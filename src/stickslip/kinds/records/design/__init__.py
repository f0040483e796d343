"""Experiments that tell laws apart."""
