"""Cameras and depth as differentiable functions of tensors with free batch dimensions."""
