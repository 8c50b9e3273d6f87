"""Check the environment that this runs in: flexdepth without torch, and small."""

import sys
from importlib.util import find_spec
from pathlib import Path
from sysconfig import get_paths

LARGEST = 500_000_000
FORBIDDEN = ("torch", "torchvision", "timm", "tensorflow", "jax")


def megabytes(count: int) -> str:
    """Return a number of bytes as a person says it."""
    return f"{count / 1e6:.0f} MB"


def main() -> str | None:
    """Print the size of site-packages and return what is wrong, if anything is."""
    present = [name for name in FORBIDDEN if find_spec(name)]
    if present:
        return f"the light install brings {', '.join(present)}"
    packages = Path(get_paths()["purelib"])
    size = sum(file.stat().st_size for file in packages.rglob("*") if file.is_file())
    print(f"no torch; site-packages holds {megabytes(size)} (at most {megabytes(LARGEST)})")
    return None if size < LARGEST else "the light install has grown too large"


if __name__ == "__main__":
    sys.exit(main())
