from pathlib import Path

import numpy as np
import pytest
from PIL import Image

from flexdepth.cli.main import main
from flexdepth.runtime.video import writing_video


@pytest.fixture
def here(tmp_path, monkeypatch):
    """The current folder, which is empty."""
    monkeypatch.chdir(tmp_path)
    return tmp_path


@pytest.fixture
def predict(make_bundle, here, capsys):
    """Run `flexdepth predict` with the tiny bundle; return exit code, stdout and stderr."""
    bundle = make_bundle().relative_to(here)

    def run(*arguments):
        code = main(["predict", *map(str, arguments), "--model", str(bundle)])
        return code, *capsys.readouterr()

    return run


@pytest.fixture
def photo():
    """Return a function that saves a gray photo."""

    def save(path, level=51, size=(40, 30), **options):
        path = Path(path)
        path.parent.mkdir(parents=True, exist_ok=True)
        Image.new("RGB", size, (level,) * 3).save(path, **options)
        return path

    return save


@pytest.fixture
def clip():
    """Return a function that saves a video of gray frames."""

    def save(path, levels, size=(64, 48)):
        with writing_video(Path(path), 10) as writer:
            for level in levels:
                writer.write(np.full((size[1], size[0], 3), level, np.uint8))
        return Path(path)

    return save


@pytest.fixture
def files():
    """Return a function that lists the files in a folder, by name below it."""

    def listed(folder="depth"):
        every = (path for path in Path(folder).rglob("*") if path.is_file())
        return sorted(path.relative_to(folder).as_posix() for path in every)

    return listed


@pytest.fixture
def stamps():
    """Return a function that says of each file in the output folder when it was written."""

    def written():
        every = (path for path in Path("depth").rglob("*") if path.is_file())
        return {path: path.stat().st_mtime_ns for path in every}

    return written
