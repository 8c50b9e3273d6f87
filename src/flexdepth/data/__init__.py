"""Data sets: each file holds a frozen setting whose `load()` gives pairs by number."""

from flexdepth.data.folder import Folder
from flexdepth.data.kitti import Kitti
from flexdepth.data.nyu import NyuFolders, NyuLabelled

Data = Folder | NyuLabelled | NyuFolders | Kitti
"""The settings of any data set here: `load()` gives pairs of image and metric depth by number."""

__all__ = ["Data", "Folder", "Kitti", "NyuFolders", "NyuLabelled"]
