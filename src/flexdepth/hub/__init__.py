"""Other people's models: those that transformers calls models for depth estimation."""
