import numpy as np

from flexdepth.evaluation.looks import LOOKS, blended
from flexdepth.runtime.model import load_model


def test_monodepths_ramp_takes_one_look_near_each_border_and_the_mean_between():
    seen, mirrored = np.full((1, 2, 41), 1, np.float32), np.full((1, 2, 41), 3, np.float32)
    found = blended(seen, mirrored)[0, 0]
    # Columns are 1/40 apart: up to 0.05 the mirrored look alone, at 0.075 half of it and half the
    # mean, from 0.1 the mean.
    np.testing.assert_allclose(found[:6], [3, 3, 3, 2.5, 2, 2], atol=1e-5)
    np.testing.assert_allclose(found[-6:], [2, 2, 1.5, 1, 1, 1], atol=1e-5)
    np.testing.assert_allclose(found[5:-5], 2, atol=1e-5)


def test_looking_once_or_twice_gives_depth_of_one_size(make_bundle):
    model = load_model(make_bundle())
    image = np.random.default_rng(0).uniform(0, 0.9, (1, 3, 32, 64)).astype(np.float32)
    depth = model.run(image).depth
    for look in LOOKS.values():
        answer = look(model, lambda _times: image)
        found, sky = answer.depth, answer.sky
        assert found.dtype == sky.dtype == np.float32
        # The tiny network sees each pixel alone, so a mirror changes nothing.
        np.testing.assert_allclose(found, depth, rtol=1e-5)
