import pytest

from flexdepth.runtime.estimator import About
from flexdepth.runtime.licences import forbids_commerce, remark


@pytest.mark.parametrize(
    ("licence", "forbids"),
    [
        ("cc-by-nc-4.0", True),
        ("CC-BY-NC-SA-3.0", True),
        ("apple-amlr", True),
        ("Microsoft Research Data License (non-commercial)", True),
        ("fair-noncommercial-research-license", True),
        ("apache-2.0", False),
        ("MIT", False),
        ("cc-by-sa-4.0", False),
        ("ncsa", False),
        ("unknown", False),
    ],
)
def test_licences_that_forbid_commercial_use_are_known(licence, forbids):
    assert forbids_commerce(licence) is forbids


def test_only_such_a_licence_is_worth_a_remark():
    assert remark(About("m", "1", "MIT", "")) is None
    assert remark(About("m", "1", "cc-by-nc-4.0", "")).startswith("m: the licence cc-by-nc-4.0")
