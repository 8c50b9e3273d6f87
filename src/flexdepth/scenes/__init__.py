"""What joins flow, solver and single-image depth: from two frames to one result in files."""
