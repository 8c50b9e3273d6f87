"""Video frames in and out, one at a time, so that length costs no memory."""

import json
from collections.abc import Generator, Iterator, Mapping
from contextlib import contextmanager
from fractions import Fraction
from itertools import takewhile
from pathlib import Path
from typing import cast

import av
import numpy as np
from av.buffer import Buffer
from av.container import InputContainer, OutputContainer
from av.packet import Packet
from av.stream import Disposition, Stream
from av.video.frame import VideoFrame
from av.video.reformatter import ColorPrimaries, ColorRange, Colorspace, ColorTrc
from av.video.stream import VideoStream
from numpy.typing import NDArray

from flexdepth.runtime.atomic import replacing
from flexdepth.runtime.errors import InputError
from flexdepth.runtime.opening import open_input
from flexdepth.runtime.origin import Origin

_SUFFIXES = (
    *(".mp4", ".m4v", ".mov", ".mkv", ".webm", ".avi", ".mpg", ".mpeg", ".ts", ".mts", ".m2ts"),
    *(".3gp", ".wmv", ".flv", ".ogv"),
)
# Left to itself FFmpeg takes photos and even text for videos, and playlists that fetch others.
_CONTAINERS = "mov,matroska,avi,mpegts,mpeg,asf,flv,ogg,mpegvideo,h264,hevc,ivf,dv,mxf"


def is_video_name(path: Path) -> bool:
    """Return whether a file of this name is taken for a video."""
    return path.suffix.lower() in _SUFFIXES


def frame_rate(path: Path) -> Fraction:
    """Return the mean number of frames per second; 25 where the file says nothing sane.

    Raises:
        InputError: The file cannot be read or holds no video.
    """
    with _opened(path) as (_, stream):
        rates = (stream.average_rate, stream.guessed_rate)
        return next((rate for rate in rates if rate and 0 < rate <= 1000), Fraction(25))


def frame_count(path: Path) -> int | None:
    """Return about how many frames there are, for showing progress; None where unknown.

    Raises:
        InputError: The file cannot be read or holds no video.
    """
    with _opened(path) as (container, stream):
        if stream.frames:
            return stream.frames
        if not container.duration or not stream.average_rate:
            return None
        return round(container.duration * stream.average_rate / av.time_base)


def read_frames(path: Path) -> Iterator[NDArray[np.uint8]]:
    """Give the frames of a video as a person sees them: RGB, upright, with square pixels.

    Only a few frames are in memory at a time. A video that is damaged or cut off gives the
    frames before the break, and then the error.

    Args:
        path: The file; its content says what it is.

    Raises:
        InputError: The file cannot be read, holds no video, or is broken. Raised when the first
            frame is asked for, or after the last good one.
    """
    with _opened(path) as (container, stream):
        count, turn = 0, None
        frames = _good_frames(container, stream)
        try:
            while True:
                frame = next(frames)
                # Once: asking for side data ties a frame into a cycle, which outlives its use.
                turn = turn or _turn(frame)
                yield _as_seen(frame, stream.sample_aspect_ratio, turn)
                count += 1
        except StopIteration as end:
            reason = end.value
    if reason or not count:
        raise InputError(
            f"{path}: the video breaks off after {count} frames "
            f"({reason or 'it holds none'}); get a whole copy of it"
        )


@contextmanager
def writing_video(
    path: Path, frame_rate: Fraction | float, origin: Origin | None = None
) -> Iterator["VideoWriter"]:
    """Give a writer of an MP4 that appears at `path`, whole, when the block ends well.

    H.264, or MPEG-4 part 2 where FFmpeg was built without x264; 8 bits, 4:2:0, BT.709.

    Args:
        path: The file to make or to replace.
        frame_rate: Frames per second.
        origin: What the video is made from, to recognise it by later.

    Raises:
        InputError: The file cannot be written, or the block wrote no frame.
    """
    # MPEG-4 part 2 holds the time between frames as a fraction with 16 bits.
    rate = 1 / (1 / Fraction(frame_rate)).limit_denominator(65535)
    with replacing(path) as temporary:
        try:
            with av.open(str(temporary), "w", format="mp4") as container:
                if origin:
                    container.metadata["comment"] = json.dumps(dict(origin))
                writer = VideoWriter(container, rate)
                yield writer
                writer.finish()
        except av.FFmpegError as error:
            raise InputError(
                f"{path}: the video cannot be written: {error.strerror}; "
                "free some space or choose another folder"
            ) from error
        if not writer.shape:
            raise InputError(f"{path}: wanted at least one frame for a video, got none")


def video_origin(path: Path) -> Origin | None:
    """Return what a video that `writing_video` made is made from; None where it does not say.

    Raises:
        InputError: The file cannot be read or holds no video.
    """
    with _opened(path) as (container, _):
        try:
            said: object = json.loads(container.metadata.get("comment", ""))
        except (ValueError, RecursionError):
            return None
    return said if isinstance(said, dict) else None


class VideoWriter:
    """Frames into an MP4 that `writing_video` has opened."""

    def __init__(self, container: OutputContainer, frame_rate: Fraction) -> None:
        self._container = container
        self._frame_rate = frame_rate
        self._stream: VideoStream | None = None
        self.shape: tuple[int, ...] = ()

    def write(self, frame: NDArray[np.uint8]) -> None:
        """Append an RGB frame, height by width by 3.

        A last row or column is repeated where the height or the width is odd, as 4:2:0 needs.

        Raises:
            ValueError: The frame has another shape than the first one.
        """
        if self._stream is None:
            self.shape = frame.shape
            self._stream = _stream(self._container, self._frame_rate, frame.shape)
        if frame.shape != self.shape:
            raise ValueError(f"wanted frames of shape {self.shape}, got {frame.shape}")
        height, width, _ = frame.shape
        even = np.pad(frame, ((0, height % 2), (0, width % 2), (0, 0)), mode="edge")
        picture = av.VideoFrame.from_ndarray(even, format="rgb24").reformat(
            format="yuv420p", dst_colorspace=Colorspace.ITU709, dst_color_range=ColorRange.MPEG
        )
        self._container.mux(self._stream.encode(picture))

    def finish(self) -> None:
        """Write what the encoder still holds."""
        if self._stream is not None:
            self._container.mux(self._stream.encode())


def _stream(container: OutputContainer, rate: Fraction, shape: tuple[int, ...]) -> VideoStream:
    if "libx264" in av.codecs_available:
        stream = container.add_stream(
            "libx264", rate=rate, options={"crf": "18", "preset": "veryfast"}
        )
    else:
        # Constant quality 3 of 1 to 31; FFmpeg counts it in steps of 1/118.
        stream = container.add_stream(
            "mpeg4", rate=rate, options={"flags": "+qscale", "global_quality": str(3 * 118)}
        )
    height, width, _ = shape
    stream.height, stream.width = height + height % 2, width + width % 2
    stream.pix_fmt = "yuv420p"
    stream.codec_context.colorspace = Colorspace.ITU709
    stream.codec_context.color_range = ColorRange.MPEG
    stream.codec_context.color_primaries = ColorPrimaries.BT709
    stream.codec_context.color_trc = ColorTrc.BT709
    return stream


@contextmanager
def _opened(path: Path) -> Iterator[tuple[InputContainer, VideoStream]]:
    with open_input(path) as file:
        try:
            container = av.open(
                file,
                "r",
                metadata_errors="replace",
                container_options={"format_whitelist": _CONTAINERS},
            )
        except (av.FFmpegError, OSError) as error:
            raise InputError(
                f"{path}: is no video that can be read, or is damaged ({error.strerror}); "
                "convert it to MP4 or get a whole copy of it"
            ) from error
        with container:
            for stream in container.streams.video:
                if not stream.disposition & Disposition.attached_pic:
                    yield container, stream
                    return
        raise InputError(f"{path}: is no video, it holds no moving pictures; choose another file")


def _good_frames(
    container: InputContainer, stream: VideoStream
) -> Generator[VideoFrame, None, str]:
    """Give the frames up to the first damage and return what it was, "" for none."""
    end = Fraction(0)
    try:
        for packet in container.demux():
            end = max(end, _end(packet))
            if packet.stream_index != stream.index:
                continue
            if packet.is_corrupt:
                yield from _held_back(stream)
                return "its data is cut off"
            for frame in stream.decode(packet):
                if frame.is_corrupt:
                    return "the next frame is damaged"
                yield frame
    except (av.FFmpegError, OSError) as error:
        yield from _held_back(stream)
        return error.strerror or "it cannot be read on"
    return "the file ends too early" if _is_short(container, end) else ""


def _held_back(stream: VideoStream) -> Iterator[VideoFrame]:
    """Give the good frames that a decoder which met damage still holds."""
    try:
        yield from takewhile(lambda frame: not frame.is_corrupt, stream.decode(None))
    except av.FFmpegError:
        return


def _end(packet: "Packet[Stream]") -> Fraction:
    if packet.pts is None:
        return Fraction(0)
    return (packet.pts + (packet.duration or 0)) * packet.time_base


def _is_short(container: InputContainer, end: Fraction) -> bool:
    """Return whether Matroska, whose reader takes a cut for the end, lacks a second or more."""
    promised = Fraction(container.duration or 0, av.time_base)
    return container.format.name.startswith("matroska") and promised - end >= 1


def _turn(frame: VideoFrame) -> tuple[bool, int, int]:
    """Return how to show a stored frame: rows for columns first, then steps down and across.

    The display matrix takes (x, y) of the stored frame to (a x + c y, b x + d y) of the seen
    one. Only quarter turns and mirrorings occur in practice; the nearest one is used.
    """
    side_data = cast(Mapping[str, Buffer], frame.side_data)
    if "DISPLAYMATRIX" not in side_data:
        return False, 1, 1
    matrix = np.frombuffer(bytes(side_data["DISPLAYMATRIX"]), "=i4").reshape(3, 3)
    (a, b), (c, d) = matrix[:2, :2].tolist()
    swapped = abs(b) > abs(a)
    down, across = (b, c) if swapped else (d, a)
    return swapped, -1 if down < 0 else 1, -1 if across < 0 else 1


def _as_seen(
    frame: VideoFrame, aspect: Fraction | None, turn: tuple[bool, int, int]
) -> NDArray[np.uint8]:
    stretch = aspect if aspect and Fraction(1, 4) <= aspect <= 4 else 1
    pixels = frame.to_ndarray(format="rgb24", width=max(1, round(frame.width * stretch)))
    swapped, down, across = turn
    upright = pixels.swapaxes(0, 1) if swapped else pixels
    return np.ascontiguousarray(upright[::down, ::across], np.uint8)
