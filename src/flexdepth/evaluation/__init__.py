"""How good a depth map is: numbers against measured depth, and the fits that make it comparable."""
