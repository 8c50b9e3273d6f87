"""The depth file formats, one file each.

Each format is three functions: `write(path, depth_map, origin)`, which is atomic;
`numbers(path)`, the numbers as they are stored; and `meaning(path)`, what the file says of them,
or None where it says nothing. `runtime/files.py` chooses among them by suffix.
"""
