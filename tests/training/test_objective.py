import pytest
import torch

from flexdepth.data.transforms import as_sample
from flexdepth.losses import Silog
from flexdepth.runtime.errors import InputError
from flexdepth.sample import Prediction
from flexdepth.tensors import stacked
from flexdepth.training.objective import Term, check_finite, objective


def test_the_objective_is_the_weighted_sum_of_its_terms(pairs):
    sample = stacked([as_sample(pair) for pair in pairs[:2]])
    prediction = Prediction(torch.full((2, 48, 64), 2.0), 0.8)
    terms = {"a": Term(Silog(0.5), 2.0), "b": Term(Silog(0.0), 3.0)}
    total, parts = objective(terms, prediction, sample)
    assert float(total) == pytest.approx(2 * float(parts["a"]) + 3 * float(parts["b"]))


@pytest.mark.parametrize("wrong", [torch.nan, torch.inf, -torch.inf])
def test_an_objective_that_is_not_finite_names_its_terms(wrong):
    parts = {"total": torch.tensor(wrong), "silog": torch.tensor(wrong), "sky": torch.tensor(0.25)}
    with pytest.raises(InputError) as stopped:
        check_finite(parts, 12)
    said = str(stopped.value)
    assert said.startswith("the objective is not finite after 12 iterations: total")
    assert f"silog {wrong:g}, sky 0.25; lower the optimiser's rate" in said
    check_finite({"total": torch.tensor(3e38)}, 12)
