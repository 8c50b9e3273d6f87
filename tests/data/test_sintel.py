import struct

import cv2
import numpy as np
import pytest

from flexdepth.data.sintel import Sintel, SintelFlow, SintelPass, flow_pair
from flexdepth.runtime.errors import InputError

WIDTH, HEIGHT = 1024, 436
INTRINSIC = [1120.0, 0, 511.5, 0, 1121.0, 217.5, 0, 0, 1]
EXTRINSIC = [1.0, 0, 0, -2, 0, 1, 0, 0, 0, 0, 1, 0]


@pytest.fixture
def write(picture, tmp_path):
    """Return a function that writes one frame, but for the parts that are to be missing."""

    def frame(number, scene="alley_1", depth=2.0, without=()):
        base, name = tmp_path / "training", f"{scene}/frame_{number:04d}"
        size = struct.pack("<2i", WIDTH, HEIGHT)
        values = np.full((HEIGHT, WIDTH), depth, "<f4")
        flow = np.zeros((HEIGHT, WIDTH, 2), "<f4")
        flow[0, 1] = (3, -4)
        content = {
            f"depth/{name}.dpt": b"PIEH" + size + values.tobytes(),
            f"camdata_left/{name}.cam": b"PIEH" + np.array([*INTRINSIC, *EXTRINSIC]).tobytes(),
            f"flow/{name}.flo": b"PIEH" + size + flow.tobytes(),
        }
        for path, stored in content.items():
            if not path.startswith(without):
                (base / path).parent.mkdir(parents=True, exist_ok=True)
                (base / path).write_bytes(stored)
        for folder, shade in (("clean", 50), ("final", 100), ("occlusions", number % 2 * 255)):
            if not folder.startswith(without):
                path = picture(base / folder / f"{name}.png", WIDTH, HEIGHT, shade)
                if folder == "occlusions":
                    cv2.imwrite(str(path), np.full((HEIGHT, WIDTH), shade, np.uint8))

    return frame


def test_depth_camera_and_pose_are_those_of_the_frame(tmp_path, write):
    write(1)
    write(2, depth=7.0)
    write(1, scene="bamboo_2")
    pairs = Sintel(tmp_path, SintelPass.FINAL).load()
    assert [pairs[n].name for n in range(3)] == [
        "alley_1_frame_0001",
        "alley_1_frame_0002",
        "bamboo_2_frame_0001",
    ]
    assert (pairs[1].image == 100).all()
    assert (pairs[1].truth.depth == 7).all()
    camera = pairs[1].truth.intrinsics
    assert (camera.focal_x, camera.focal_y) == (1120, 1121)
    assert (camera.centre_x, camera.centre_y) == (WIDTH / 2, HEIGHT / 2)
    # The file takes the world to the camera, which thus stands at x = 2.
    assert Sintel(tmp_path).poses()[0][:3, 3].tolist() == [2, 0, 0]
    assert len(Sintel(tmp_path, scene="bamboo_2").load()) == 1


@pytest.mark.parametrize("lost", ["clean", "depth", "camdata_left"])
def test_a_frame_without_image_depth_or_camera_is_named(tmp_path, write, lost):
    write(1)
    write(2, without=(lost,))
    with pytest.raises(InputError, match=r"frame_0002\.\w+: has no partner"):
        Sintel(tmp_path).load()


def test_a_scene_that_is_not_there_is_named(tmp_path, write):
    write(1)
    with pytest.raises(InputError, match=r"camdata_left: looked for cave_2/frame_NNNN\.cam"):
        Sintel(tmp_path, scene="cave_2").load()


def test_flow_leads_from_a_frame_to_the_next(tmp_path, write):
    write(1)
    write(2, without=("flow", "occlusions"))
    (pair,) = SintelFlow(tmp_path).load()
    assert pair.flow[0, 1].tolist() == [3, -4]
    assert pair.occluded.all()
    assert pair.key.shape == pair.target.shape == (HEIGHT, WIDTH, 3)


def test_flow_without_its_second_image_is_named(tmp_path, write):
    write(1)
    with pytest.raises(InputError, match=r"frame_0001\.flo: looked for clean/alley_1/frame_0002"):
        SintelFlow(tmp_path).load()


def test_flow_of_another_size_than_its_images_is_named(tmp_path, write, picture):
    write(1)
    write(2, without=("flow", "occlusions"))
    path = picture(tmp_path / "training/clean/alley_1/frame_0002.png", 8, 6)
    with pytest.raises(InputError, match=rf"{path.name}: is 8x6, its image .*0001\.png 1024x436"):
        SintelFlow(tmp_path).load()[0]


def test_real_flow_brings_the_second_image_onto_the_first(samples):
    real = samples / "flow_sintel_easy"
    if not real.is_dir():
        pytest.skip(f"no {real}")
    frames = [real / "clean" / "easy" / f"frame_000{n}.png" for n in (2, 3)]
    name = "frame_0002"
    pair = flow_pair(
        name, *frames, real / "gt" / f"{name}.flo", real / "gt" / "occlusions" / f"{name}.png"
    )
    column, row = np.meshgrid(
        np.arange(WIDTH, dtype=np.float32), np.arange(HEIGHT, dtype=np.float32)
    )
    moved = cv2.remap(
        pair.target, column + pair.flow[..., 0], row + pair.flow[..., 1], cv2.INTER_LINEAR
    )
    difference = [
        np.abs(image.astype(float) - pair.key)[~pair.occluded].mean()
        for image in (pair.target, moved)
    ]
    assert difference[1] < 0.3 * difference[0]
    assert 0.01 < pair.occluded.mean() < 0.04
