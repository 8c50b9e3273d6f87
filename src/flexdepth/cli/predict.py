"""`flexdepth predict INPUT...`: the depth of photos, folders and videos."""

import os
import sys
import time
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Annotated, Literal

import tyro

from flexdepth.cli.arguments import told_in_one_line
from flexdepth.cli.progress import with_progress
from flexdepth.cli.summary import Summary
from flexdepth.runtime.errors import InputError, one_line
from flexdepth.runtime.inputs import find_inputs
from flexdepth.runtime.job import Job, failure
from flexdepth.runtime.lens import FieldOfView, FocalLength, Lens
from flexdepth.runtime.licences import remark
from flexdepth.runtime.looks import at_three_sizes, mirrored_too, once
from flexdepth.runtime.named import BUNDLED, Wishes, named_estimator
from flexdepth.runtime.outputs import DEPTH, MESH, NORMALS, POINTS, PREVIEW, Output
from flexdepth.runtime.run import results, without_clashes
from flexdepth.runtime.session import Provider

_LOOKS = {1: once, 2: mirrored_too, 3: at_three_sizes}

_Flag = Annotated[bool, tyro.conf.FlagCreatePairsOff, tyro.conf.arg(help_behavior_hint="")]


@dataclass(frozen=True)
class Predict:
    """Write the depth of photos, of the photos and videos in folders, and of videos.

    NAME.jpg gives NAME.npz, whose array `depth` has the photo's size; CLIP.mp4 gives
    CLIP/000000.npz and so on. Depth is in metres where the focal length is known, from the photo
    itself, --focal or --fov; else it is right up to one factor. Sky is infinitely far.
    What has been made from the same input, model and settings is not made again.
    """

    inputs: Annotated[
        tuple[str, ...],
        tyro.conf.Positional,
        tyro.conf.arg(metavar="INPUT...", help_behavior_hint=""),
    ]
    """Photos, videos, folders (with the folders in them), and globs such as "trip/*.jpg"."""
    output_dir: Annotated[Path, tyro.conf.arg(aliases=("-o",), metavar="DIR")] = Path("depth")
    """Where the outputs go. The sub-folders of an input folder are mirrored in it."""
    format: Annotated[
        tuple[Literal["npz", "npy", "png16", "exr", "pfm"], ...],
        tyro.conf.UseAppendAction,
        tyro.conf.arg(help_behavior_hint="(npz; may be repeated)"),
    ] = ()
    """Format of the depth files. png16 is in millimetres, exact to half a step."""
    preview: _Flag = False
    """Also NAME.preview.png, the depth in colours; CLIP.preview.mp4 for a video."""
    points: Annotated[
        Literal["ply", "glb"] | None, tyro.conf.arg(metavar="{ply,glb}", help_behavior_hint="")
    ] = None
    """Also the coloured points, NAME.ply or NAME.glb."""
    mesh: _Flag = False
    """With --points: join the points to a surface, but not across steps in depth."""
    normals: _Flag = False
    """Also NAME.normals.png, the directions that surfaces face, in colours."""
    overwrite: _Flag = False
    """Replace what lies in the place of an output."""
    focal: Annotated[float | None, tyro.conf.arg(metavar="PIXELS", help_behavior_hint="")] = None
    """Focal length of all inputs, in pixels of each."""
    fov: Annotated[float | None, tyro.conf.arg(metavar="DEGREES", help_behavior_hint="")] = None
    """Field of view of all inputs, from the left edge to the right, instead of --focal."""
    long_side: Annotated[int | None, tyro.conf.arg(metavar="PIXELS", help_behavior_hint="")] = None
    """Longer side of what the network sees; larger is slower and sees more detail."""
    details: Annotated[int | None, tyro.conf.arg(metavar="N", help_behavior_hint="(2)")] = None
    """Show the network each picture once more, N times as wide and high but not larger than it is,
    and take what is fine from there: sharper edges. 1 leaves that out: faster, good for videos."""
    tiles: Annotated[int, tyro.conf.arg(metavar="N")] = 1
    """For the detail of large photos: look at N overlapping tiles along the longer side too, and
    at as many along the other as make them nearly square. The large shape stays that of the whole.
    4 means 13 looks at a photo instead of one. Small photos have fewer tiles, or none."""
    looks: Annotated[Literal[1, 2, 3] | None, tyro.conf.arg(help_behavior_hint="(3)")] = None
    """Looks at each whole picture, whose mean is taken: 1, 2, the other in a mirror, or 3, at three
    sizes: steadier and nearer to the truth, and a little slower."""
    model: Annotated[str, tyro.conf.arg(metavar="MODEL", help_behavior_hint="")] = BUNDLED[0]
    """Another model than the one that comes with flexdepth: an .onnx bundle, any .onnx network with
    a .yaml card beside it, or hub:NAME (docs/models.md)."""
    provider: Annotated[Provider, tyro.conf.EnumChoicesFromValues] = Provider.CPU
    """What the network runs on."""
    threads: Annotated[int | None, tyro.conf.arg(metavar="N", help_behavior_hint="")] = None
    """CPU threads of the network; without it, one for each physical core."""
    max_pixels: Annotated[int, tyro.conf.arg(metavar="N")] = 200_000_000
    """Larger photos are refused."""
    batch: Annotated[int, tyro.conf.arg(metavar="N")] = 1
    """How many pictures of one size share a run of the network; worth it on a GPU."""
    json: _Flag = False
    """Print one JSON document with every result, for scripts, instead of words."""


def run(arguments: Sequence[str]) -> int:
    """Predict what `arguments` name; one input that fails leaves the others alone."""
    with told_in_one_line("flexdepth predict"):
        settings = tyro.cli(Predict, args=arguments, prog="flexdepth predict")
    if not settings.inputs:
        raise InputError("name at least one photo, folder or video: flexdepth predict photo.jpg")
    begin = time.monotonic()
    job = job_of(settings)
    if (said := remark(job.predictor.about)) is not None:
        sys.stderr.write(f"flexdepth: {one_line(said)}\n")
    found, refusals = find_inputs(settings.inputs, settings.output_dir)
    inputs, done = without_clashes(job, found)
    done += [failure(each.path, InputError(each.reason)) for each in refusals]
    stopped = False
    try:
        for result in with_progress(inputs, lambda watch: results(job, inputs, watch)):
            done.append(result)
    except KeyboardInterrupt:
        stopped = True
    total = len(found) + len(refusals)
    summary = Summary(tuple(done), total, stopped, time.monotonic() - begin)
    if settings.json:
        sys.stdout.write(summary.json(job) + "\n")
    else:
        sys.stdout.write(summary.made())
        sys.stderr.write(summary.words())
    return summary.exit_code


def job_of(settings: Predict) -> Job:
    """Return the job that the settings describe, with its model loaded.

    Raises:
        InputError: A setting is out of range, or the model cannot be loaded.
    """
    for name, value in (("--batch", settings.batch), ("--max-pixels", settings.max_pixels)):
        if value < 1:
            raise InputError(f"{name}: wanted a whole number >= 1, got {value}")
    if os.path.isfile(settings.output_dir):  # Path.is_file raises below a forbidden folder
        raise InputError(f"--output-dir: {settings.output_dir} is a file, wanted a folder")
    return Job(
        named_estimator(settings.model, _wishes(settings)),
        settings.output_dir,
        _outputs(settings),
        settings.overwrite,
        settings.max_pixels,
        settings.batch,
    )


def _wishes(settings: Predict) -> Wishes:
    """Return how the model is to look at pictures."""
    return Wishes(
        _lens(settings),
        settings.long_side,
        None if settings.looks is None else _LOOKS[settings.looks],
        settings.details,
        settings.tiles,
        settings.provider,
        settings.threads,
    )


def _lens(settings: Predict) -> Lens | None:
    if settings.focal is not None and settings.fov is not None:
        raise InputError("--focal and --fov say the same thing: give one of them")
    if settings.focal is not None:
        return FocalLength(settings.focal)
    return None if settings.fov is None else FieldOfView(settings.fov)


def _outputs(settings: Predict) -> tuple[Output, ...]:
    """Return the depth files first, and the points, which a picture of sky has none of, last."""
    if settings.mesh and not settings.points:
        raise InputError("--mesh joins points: say --points ply or --points glb too")
    formats = dict.fromkeys(settings.format or ("npz",))
    shapes = MESH if settings.mesh else POINTS
    return (
        *(DEPTH[name] for name in formats),
        *((PREVIEW,) if settings.preview else ()),
        *((NORMALS,) if settings.normals else ()),
        *((shapes[settings.points],) if settings.points else ()),
    )
