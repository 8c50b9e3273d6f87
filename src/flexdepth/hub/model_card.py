"""The licence in a model's card, which is the README.md beside its weights."""

import re
from pathlib import Path

import yaml

_FRONT = re.compile(r"\A---\s*\n(.*?)\n---\s*(\n|\Z)", re.DOTALL)
_LONGEST = 1 << 20
"""No card is longer, in bytes."""


def stated_licence(card: Path) -> str | None:
    """Return the licence that a model card states; None where it states none.

    Of `license: other`, what counts is the name beside it.
    """
    with card.open("rb") as file:
        text = file.read(_LONGEST).decode("utf-8", errors="replace")
    front = _FRONT.search(text.replace("\r\n", "\n"))
    if front is None:
        return None
    try:
        said = yaml.safe_load(front[1])
    except yaml.YAMLError:
        return None
    if not isinstance(said, dict):
        return None
    licence = said.get("license")
    if licence == "other":
        licence = said.get("license_name") or licence
    return licence if isinstance(licence, str) and licence.isprintable() else None
