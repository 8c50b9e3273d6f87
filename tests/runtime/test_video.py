import gc
from fractions import Fraction

import av
import numpy as np
import pytest
from av.stream import Disposition
from hypothesis import given
from hypothesis import strategies as st
from PIL import Image

from flexdepth.runtime.errors import InputError
from flexdepth.runtime.video import (
    frame_count,
    frame_rate,
    is_video_name,
    read_frames,
    writing_video,
)

RED, GREEN, BLUE, WHITE = (255, 0, 0), (0, 255, 0), (0, 0, 255), (255, 255, 255)
CORNERS = np.array([[RED, GREEN], [BLUE, WHITE]], np.uint8).repeat(16, 0).repeat(32, 1)


def noise(index, size=(48, 64)):
    return np.random.default_rng(index).integers(0, 256, (*size, 3), np.uint8)


def encode(path, frames, codec="libx264", *, rate=10, matrix=None, aspect=None, options=None):
    """Write a video without the code under test."""
    header_first = {"movflags": "faststart"} if path.suffix == ".mp4" else {}
    with av.open(str(path), "w", options=header_first) as container:
        stream = container.add_stream(codec, rate=rate, options=options or {})
        stream.height, stream.width, _ = frames[0].shape
        stream.pix_fmt = "yuv420p"
        stream.codec_context.sample_aspect_ratio = aspect or Fraction(1)
        if matrix:
            stream.set_display_matrix(matrix)
        for frame in frames:
            container.mux(stream.encode(av.VideoFrame.from_ndarray(frame, format="rgb24")))
        container.mux(stream.encode())
    return path


def read_to_the_break(path):
    """Return the frames, and the message that follows them, "" for none."""
    frames = []
    try:
        frames.extend(read_frames(path))
    except InputError as refused:
        message = str(refused)
    else:
        return frames, ""
    assert str(path) in message
    assert "\n" not in message
    return frames, message


def colours(frame):
    height, width, _ = frame.shape
    rows, columns = (height // 4, -height // 4), (width // 4, -width // 4)
    return np.array([[frame[row, column] for column in columns] for row in rows], int)


@pytest.mark.parametrize(
    ("name", "codec"),
    [("a.mp4", "libx264"), ("a.mkv", "libx264"), ("a.avi", "mpeg4"), ("a.ts", "libx264")],
)
def test_every_frame_is_read_in_order(tmp_path, name, codec):
    levels = [20 + 10 * index for index in range(20)]
    stills = [np.full((48, 64, 3), level, np.uint8) for level in levels]
    frames = list(read_frames(encode(tmp_path / name, stills, codec)))
    assert all(frame.shape == (48, 64, 3) and frame.dtype == np.uint8 for frame in frames)
    assert [frame.mean() for frame in frames] == pytest.approx(levels, abs=5)


# The matrix of a track, ISO/IEC 14496-12, 6.2.2: (x, y) is shown at (a x + c y, b x + d y).
@pytest.mark.parametrize(
    ("a", "b", "c", "d", "seen"),
    [
        (1, 0, 0, 1, [[RED, GREEN], [BLUE, WHITE]]),
        (0, 1, -1, 0, [[BLUE, RED], [WHITE, GREEN]]),
        (-1, 0, 0, -1, [[WHITE, BLUE], [GREEN, RED]]),
        (0, -1, 1, 0, [[GREEN, WHITE], [RED, BLUE]]),
        (-1, 0, 0, 1, [[GREEN, RED], [WHITE, BLUE]]),
        (0, 1, 1, 0, [[RED, BLUE], [GREEN, WHITE]]),
    ],
)
def test_a_turned_video_is_seen_upright(tmp_path, a, b, c, d, seen):
    one = 1 << 16
    matrix = [a * one, b * one, 0, c * one, d * one, 0, 0, 0, 1 << 30]
    frames = list(read_frames(encode(tmp_path / "a.mp4", [CORNERS] * 3, matrix=matrix)))
    assert frames[0].shape == ((64, 32, 3) if b else (32, 64, 3))
    assert all(np.abs(colours(frame) - seen).max() < 12 for frame in frames)
    assert all(frame.flags.c_contiguous for frame in frames)


def test_frames_before_the_first_key_frame_are_passed_over(tmp_path):
    stills = [np.full((48, 64, 3), 20 + 10 * index, np.uint8) for index in range(20)]
    options = {"g": "8", "bf": "0", "sc_threshold": "0"}
    path = encode(tmp_path / "a.ts", stills, options=options)
    whole = path.read_bytes()
    with av.open(str(path)) as container:
        places = [packet.pos for packet in container.demux(video=0) if packet.size]
    path.write_bytes(whole[places[1] :])
    frames, message = read_to_the_break(path)
    assert not message
    assert [frame.mean() for frame in frames] == pytest.approx(list(range(100, 220, 10)), abs=5)


def test_pixels_that_are_not_square_are_made_so(tmp_path):
    path = encode(tmp_path / "a.mp4", [CORNERS], aspect=Fraction(3, 2))
    assert next(read_frames(path)).shape == (32, 96, 3)


def test_rate_and_number_of_frames_are_known(tmp_path):
    for name in ("a.mp4", "a.mkv"):
        path = encode(tmp_path / name, [noise(0)] * 12, rate=Fraction(30000, 1001))
        assert frame_rate(path) == Fraction(30000, 1001)
        assert frame_count(path) == 12


def test_frames_are_let_go_of_without_the_garbage_collector(tmp_path):
    path = encode(tmp_path / "a.mp4", [noise(0)] * 30)
    gc.collect()
    gc.disable()
    try:
        assert sum(1 for _ in read_frames(path)) == 30
        assert sum(type(thing) is av.VideoFrame for thing in gc.get_objects()) < 4
    finally:
        gc.enable()


STEADY = {"libx264": {}, "mpeg4": {"b": "3000000"}}


@pytest.mark.parametrize(
    ("name", "codec"), [("a.mp4", "libx264"), ("a.mkv", "libx264"), ("a.avi", "mpeg4")]
)
def test_of_a_truncated_video_every_frame_before_the_break_is_given(tmp_path, name, codec):
    stills = [noise(index) for index in range(30)]
    path = encode(tmp_path / name, stills, codec, options=STEADY[codec])
    whole = list(read_frames(path))
    with av.open(str(path)) as container:
        ends = [p.pos + p.size for p in container.demux(video=0) if p.size]
    cut = ends[17] + 20
    path.write_bytes(path.read_bytes()[:cut])
    frames, message = read_to_the_break(path)
    assert len(frames) == 18
    assert all((frame == before).all() for frame, before in zip(frames, whole, strict=False))
    assert "after 18 frames" in message


# In a transport stream the packets that hold the end of frame 14 say that they are damaged.
@pytest.mark.parametrize(
    ("name", "codec", "least"),
    [("a.mp4", "libx264", 15), ("a.avi", "mpeg4", 15), ("a.ts", "libx264", 13)],
)
def test_of_a_damaged_video_the_frames_before_the_break_are_given(tmp_path, name, codec, least):
    stills = [noise(index) for index in range(30)]
    path = encode(tmp_path / name, stills, codec, options=STEADY[codec])
    whole = list(read_frames(path))
    with av.open(str(path)) as container:
        places = [packet.pos for packet in container.demux(video=0) if packet.size]
    content = bytearray(path.read_bytes())
    content[places[15] : places[20]] = bytes(places[20] - places[15])
    path.write_bytes(content)
    frames, message = read_to_the_break(path)
    assert least <= len(frames) <= 15
    assert all((frame == before).all() for frame, before in zip(frames, whole, strict=False))
    assert f"after {len(frames)} frames" in message


def test_a_video_without_frames_is_broken(tmp_path):
    with av.open(str(tmp_path / "a.avi"), "w") as container:
        stream = container.add_stream("mpeg4", rate=10)
        stream.height, stream.width = 32, 32
        container.start_encoding()
    assert "after 0 frames" in read_to_the_break(tmp_path / "a.avi")[1]


def music(path, picture_frames=0, disposition=Disposition.default):
    """Write two seconds of silence, and pictures beside it."""
    with av.open(str(path), "w") as container:
        stream = container.add_stream("aac", rate=8000, layout="mono")
        quiet = av.AudioFrame.from_ndarray(np.zeros((1, 16000), np.float32), "fltp", "mono")
        quiet.sample_rate = 8000
        packets = stream.encode(quiet) + stream.encode()
        if picture_frames:
            pictures = container.add_stream("mjpeg", rate=10)
            pictures.height, pictures.width, pictures.pix_fmt = 16, 16, "yuvj420p"
            pictures.disposition = disposition
            for _ in range(picture_frames):
                packets += pictures.encode(av.VideoFrame(16, 16, "yuvj420p"))
        container.mux(packets)


def test_sound_that_goes_on_adds_no_frames(tmp_path):
    music(tmp_path / "a.mp4", picture_frames=4)
    assert frame_count(tmp_path / "a.mp4") == 4
    assert len(list(read_frames(tmp_path / "a.mp4"))) == 4


@pytest.mark.parametrize(
    "name", ["text.mp4", "text.txt", "music.mp4", "album.mp4", "photo.jpg", "gone.mp4"]
)
def test_what_is_no_video_is_refused_in_one_line(tmp_path, name):
    path = tmp_path / name
    if name.startswith("text"):
        path.write_text("this is no video\n" * 200)
    elif name == "music.mp4":
        music(path)
    elif name == "album.mp4":
        music(path, picture_frames=1, disposition=Disposition.attached_pic)
    elif name == "photo.jpg":
        Image.fromarray(noise(0)).save(path)
    frames, message = read_to_the_break(path)
    assert not frames
    assert message
    for ask in (frame_rate, frame_count):
        with pytest.raises(InputError, match=name):
            ask(path)


def test_a_playlist_that_names_other_files_is_not_followed(tmp_path):
    encode(tmp_path / "a.ts", [noise(0)] * 3)
    path = tmp_path / "list.mp4"
    path.write_text("#EXTM3U\n#EXT-X-TARGETDURATION:1\n#EXTINF:1,\na.ts\n#EXT-X-ENDLIST\n")
    assert "is no video" in read_to_the_break(path)[1]


@pytest.mark.parametrize(
    ("name", "expected"), [("a.MOV", True), ("a.webm", True), ("a.gif", False), ("mp4", False)]
)
def test_videos_are_known_by_name(tmp_path, name, expected):
    assert is_video_name(tmp_path / name) is expected


@pytest.mark.parametrize("codecs", [{"libx264", "mpeg4"}, {"mpeg4"}])
def test_a_written_video_has_the_colours_it_was_given(tmp_path, monkeypatch, codecs):
    monkeypatch.setattr(av, "codecs_available", codecs)
    path = tmp_path / "a.mp4"
    with writing_video(path, 12.5) as video:
        for _ in range(4):
            video.write(CORNERS)
    frames = list(read_frames(path))
    assert len(frames) == 4
    assert all(np.abs(colours(frame) - colours(CORNERS)).max() < 4 for frame in frames)
    assert frame_rate(path) == Fraction(25, 2)
    with av.open(str(path)) as container:
        stream = container.streams.video[0]
        assert stream.codec.name in ("h264" if "libx264" in codecs else "mpeg4")
        assert stream.pix_fmt == "yuv420p"
    assert [entry.name for entry in tmp_path.iterdir()] == ["a.mp4"]


@pytest.mark.parametrize("size", [(1, 1), (5, 7), (6, 7)])
def test_odd_sizes_grow_to_even_ones_by_their_last_row_and_column(tmp_path, size):
    path = tmp_path / "a.mp4"
    with writing_video(path, 10) as video:
        video.write(np.full((*size, 3), 90, np.uint8))
    frame = next(read_frames(path))
    assert frame.shape == (size[0] + size[0] % 2, size[1] + size[1] % 2, 3)
    assert np.abs(frame.astype(int) - 90).max() <= 2


@pytest.mark.parametrize("rate", [1 / 3, 24, 29.97, Fraction(1234567, 41152)])
@pytest.mark.parametrize("codecs", [{"libx264"}, {"mpeg4"}])
def test_every_frame_rate_can_be_written(tmp_path, monkeypatch, rate, codecs):
    monkeypatch.setattr(av, "codecs_available", codecs)
    path = tmp_path / "a.mp4"
    with writing_video(path, rate) as video:
        for _ in range(5):
            video.write(CORNERS)
    assert float(frame_rate(path)) == pytest.approx(float(rate), rel=1e-3)


def write(path, frames):
    with writing_video(path, 10) as video:
        for frame in frames:
            video.write(frame)


def interrupted():
    yield from [CORNERS] * 90
    raise KeyboardInterrupt


def test_a_video_that_fails_leaves_what_was_there(tmp_path):
    path = tmp_path / "a.mp4"
    path.write_bytes(b"before")
    with pytest.raises(KeyboardInterrupt):
        write(path, interrupted())
    assert [entry.name for entry in tmp_path.iterdir()] == ["a.mp4"]
    assert path.read_bytes() == b"before"


def test_a_video_without_frames_is_refused(tmp_path):
    with pytest.raises(InputError, match="at least one frame"):
        write(tmp_path / "a.mp4", [])
    assert not list(tmp_path.iterdir())


def test_a_frame_of_another_shape_is_refused(tmp_path):
    with pytest.raises(ValueError, match="wanted frames of shape"):
        write(tmp_path / "a.mp4", [CORNERS, CORNERS[:10]])


def test_a_size_that_the_encoder_refuses_is_an_input_error(tmp_path):
    with pytest.raises(InputError, match=r"a\.mp4: the video cannot be written"):
        write(tmp_path / "a.mp4", [np.zeros((40_000, 16, 3), np.uint8)])


@pytest.fixture(scope="module")
def videos(tmp_path_factory):
    folder = tmp_path_factory.mktemp("videos")
    stills = [noise(index, (16, 16)) for index in range(4)]
    names = {"a.mp4": "libx264", "a.mkv": "libx264", "a.avi": "mpeg4", "a.ts": "libx264"}
    return [encode(folder / name, stills, codec).read_bytes() for name, codec in names.items()]


@given(
    which=st.integers(0, 3),
    keep=st.floats(0.2, 1),
    flips=st.lists(st.tuples(st.floats(0, 1, exclude_max=True), st.integers(1, 255)), max_size=4),
)
def test_damage_gives_frames_or_an_input_error_and_nothing_else(
    tmp_path_factory, videos, which, keep, flips
):
    content = bytearray(videos[which])
    for where, mask in flips:
        content[int(where * len(content))] ^= mask
    path = tmp_path_factory.getbasetemp() / "damaged.mp4"
    path.write_bytes(content[: round(keep * len(content))])
    frames, _ = read_to_the_break(path)
    assert all(frame.dtype == np.uint8 and frame.ndim == 3 for frame in frames)
