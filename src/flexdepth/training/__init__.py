"""Training: what is minimised, on which batches, by which steps."""
