"""Data sets: each file holds a frozen setting whose `load()` gives samples by number."""
