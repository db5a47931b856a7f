"""What compiles and launches kernels: Taichi, or Quadrants, its maintained fork; all that differs is here."""
