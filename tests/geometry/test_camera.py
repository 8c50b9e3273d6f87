import torch
from hypothesis import given
from hypothesis import strategies as st
from torch.testing import assert_close

from flexdepth.geometry.camera import Camera

lengths = st.floats(50, 2000)
places = st.floats(-500, 1500)
factors = st.floats(0.1, 8)
steps = st.integers(-500, 1500)
focals, points = st.tuples(lengths, lengths), st.tuples(places, places)


def camera_of(focal: tuple[float, float], centre: tuple[float, float]) -> Camera:
    return Camera(*(torch.tensor(x, dtype=torch.float64) for x in (focal, centre)))


def ray(camera: Camera, pixel: tuple[float, float]) -> torch.Tensor:
    return (camera.focal.new_tensor(pixel) - camera.centre) / camera.focal


@given(focals, points, points, factors, factors)
def test_a_resized_camera_sees_each_thing_in_its_old_direction(focal, centre, pixel, across, down):
    camera = camera_of(focal, centre)
    moved = (pixel[0] * across, pixel[1] * down)
    assert_close(ray(camera.resized(across, down), moved), ray(camera, pixel), atol=1e-9, rtol=0)


@given(focals, points, points, steps, steps)
def test_a_cropped_camera_sees_each_thing_in_its_old_direction(focal, centre, pixel, left, top):
    camera = camera_of(focal, centre)
    moved = (pixel[0] - left, pixel[1] - top)
    assert_close(ray(camera.cropped(left, top), moved), ray(camera, pixel), atol=1e-9, rtol=0)


def test_a_focal_length_of_480_on_a_diagonal_of_800_is_six_tenths():
    cameras = Camera(torch.tensor([[480.0, 480.0], [240.0, 960.0]]), torch.zeros(2, 2))
    assert_close(cameras.focal_in_diagonals(640, 480), torch.tensor([0.6, 0.6]))


def test_by_area_a_wide_image_counts_as_the_4_to_3_image_of_as_many_pixels():
    camera = camera_of((480, 480), (320, 240))
    assert_close(camera.focal_by_area(640, 480), torch.tensor(0.6, dtype=torch.float64))
    assert_close(camera.focal_by_area(1280, 240), torch.tensor(0.6, dtype=torch.float64))
    assert_close(camera.focal_by_area(480, 640), torch.tensor(0.6, dtype=torch.float64))


def test_the_focal_length_in_diagonals_does_not_know_the_size_of_the_image():
    camera = camera_of((480, 480), (320, 240))
    assert_close(
        camera.resized(0.25, 0.25).focal_in_diagonals(160, 120), camera.focal_in_diagonals(640, 480)
    )
