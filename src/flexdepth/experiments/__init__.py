"""Named experiments: a network, what it is trained on and how, as one frozen record."""
