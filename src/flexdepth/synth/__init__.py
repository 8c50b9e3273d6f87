"""Procedural scenes, ray-cast with Embree: colour, exact depth, camera and sky.

The world's axes are right-handed with y up, in metres; a camera's are x right, y down, z forward.
Every scene is a pure function of a random generator, and every rendered image of (seed, index).
"""
