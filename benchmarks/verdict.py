"""What stands beside a bar that is met, and beside one that is missed."""

PASS, MISS = "pass", "MISS"


def verdict(met: bool) -> str:
    """Return how a bar is marked."""
    return PASS if met else MISS
