from types import SimpleNamespace

import pytest

from flexdepth.hub.families import FAMILIES


def depth_anything(hidden, layers, indices):
    encoder = SimpleNamespace(hidden_size=hidden, num_hidden_layers=layers, out_indices=indices)
    return SimpleNamespace(backbone_config=encoder, depth_estimation_type="relative")


@pytest.mark.parametrize(
    ("config", "licence"),
    [
        # The published settings: version 1 small, base, large; then version 2.
        (depth_anything(384, 12, [9, 10, 11, 12]), "apache-2.0"),
        (depth_anything(768, 12, [9, 10, 11, 12]), "apache-2.0"),
        (depth_anything(1024, 24, [21, 22, 23, 24]), "apache-2.0"),
        (depth_anything(384, 12, [3, 6, 9, 12]), "apache-2.0"),
        (depth_anything(768, 12, [3, 6, 9, 12]), "cc-by-nc-4.0"),
        (depth_anything(1024, 24, [5, 12, 18, 24]), "cc-by-nc-4.0"),
    ],
)
def test_of_depth_anything_only_the_large_ones_of_version_2_are_not_free(config, licence):
    assert FAMILIES["depth_anything"].licence(config) == licence
