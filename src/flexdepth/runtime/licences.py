"""Licences of weights: which of them forbid commercial use."""

import re

from flexdepth.runtime.estimator import About

_FORBID = re.compile(
    r"(^|[^a-z])nc([^a-z]|$)|non-?commercial|research|apple-amlr|apple-ascl", re.IGNORECASE
)
"""`cc-by-nc-4.0` and its kin, and licences for research alone, as Apple's of Depth Pro is."""


def forbids_commerce(licence: str) -> bool:
    """Return whether a licence, by its identifier or name, is known to forbid commercial use."""
    return _FORBID.search(licence) is not None


def remark(about: About) -> str | None:
    """Return what a user must be told of a model's licence; None where there is nothing."""
    if not forbids_commerce(about.licence):
        return None
    return f"{about.name}: the licence {about.licence} of its weights forbids commercial use"
