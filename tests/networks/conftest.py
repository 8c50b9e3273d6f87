import pytest
import torch


@pytest.fixture(autouse=True)
def own_randomness() -> None:
    """Let no test's numbers depend on which tests ran before it."""
    torch.manual_seed(0)
