"""Everything that rests on Numba: compiling, caching, vector instructions, random streams in kernels."""
