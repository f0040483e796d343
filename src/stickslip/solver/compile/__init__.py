"""Machine code of kernels (by Numba) and of equations (by LLVM), kept on disk."""
