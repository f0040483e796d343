"""Generated modules, compiled by Numba and kept on disk."""
