"""Correspondence between two frames without learning."""
