"""What `flexdepth predict` needs on a machine without torch."""
