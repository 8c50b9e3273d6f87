"""Motion and depth by geometry and least squares, without learning: numpy, float64.

A point X of the key camera is at R X + t in the target camera (x right, y down, z forward).
Pixels are counted from the top left corner, the first pixel's centre is 0.5.
"""
