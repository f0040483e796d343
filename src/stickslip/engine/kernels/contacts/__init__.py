"""Kernels of mechanisms with several contacts, whose equations are parts and modes a vector."""
