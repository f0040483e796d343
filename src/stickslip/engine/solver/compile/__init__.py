"""Machine code of kernels and of equations, made by LLVM and kept on disk."""
