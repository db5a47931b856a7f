"""Compilers that compile and launch kernels: Taichi, or Quadrants, its maintained fork.

All differences between the two are in this package.
"""
