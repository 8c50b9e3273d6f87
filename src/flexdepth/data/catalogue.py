"""Every data set by the name it has on the command line."""

from collections.abc import Mapping
from types import MappingProxyType
from typing import Any

from flexdepth.data.cityscapes import Cityscapes
from flexdepth.data.diode import Diode
from flexdepth.data.diw import Diw
from flexdepth.data.driving_stereo import DrivingStereo
from flexdepth.data.eth3d import Eth3d, Eth3dStereo
from flexdepth.data.folder import Folder
from flexdepth.data.hypersim import Hypersim
from flexdepth.data.icl_nuim import IclNuim, IclNuimAugmented, IclNuimPovRay
from flexdepth.data.kitti import Kitti
from flexdepth.data.kitti_2015 import Kitti2015Flow, Kitti2015Stereo
from flexdepth.data.kitti_odometry import KittiOdometry
from flexdepth.data.kitti_velodyne import KittiObject, KittiVelodyne
from flexdepth.data.make3d import Make3d
from flexdepth.data.megadepth import MegaDepth, MegaDepthOrdinal
from flexdepth.data.mid_air import MidAir
from flexdepth.data.middlebury import Middlebury, Middlebury2003, Middlebury2006
from flexdepth.data.nyu import NyuFolders, NyuLabelled
from flexdepth.data.scannet import ScanNet
from flexdepth.data.sevenscenes import SevenScenes
from flexdepth.data.sintel import Sintel, SintelFlow
from flexdepth.data.stated_folder import StatedFolder
from flexdepth.data.sunrgbd import SunRgbd
from flexdepth.data.tum import Tum
from flexdepth.data.virtual_kitti import VirtualKitti1, VirtualKitti2

DATASETS: Mapping[str, type[Any]] = MappingProxyType(
    {
        "folder": Folder,
        "stated-folder": StatedFolder,
        "nyu-labelled": NyuLabelled,
        "nyu-folders": NyuFolders,
        "kitti": Kitti,
        "kitti-velodyne": KittiVelodyne,
        "kitti-object": KittiObject,
        "kitti-odometry": KittiOdometry,
        "kitti-2015-stereo": Kitti2015Stereo,
        "kitti-2015-flow": Kitti2015Flow,
        "sintel": Sintel,
        "sintel-flow": SintelFlow,
        "7-scenes": SevenScenes,
        "tum": Tum,
        "scannet": ScanNet,
        "sun-rgbd": SunRgbd,
        "icl-nuim": IclNuim,
        "icl-nuim-pov-ray": IclNuimPovRay,
        "icl-nuim-augmented": IclNuimAugmented,
        "make3d": Make3d,
        "diode": Diode,
        "eth3d": Eth3d,
        "eth3d-stereo": Eth3dStereo,
        "virtual-kitti-1": VirtualKitti1,
        "virtual-kitti-2": VirtualKitti2,
        "cityscapes": Cityscapes,
        "middlebury": Middlebury,
        "middlebury-2006": Middlebury2006,
        "middlebury-2003": Middlebury2003,
        "diw": Diw,
        "megadepth": MegaDepth,
        "megadepth-ordinal": MegaDepthOrdinal,
        "mid-air": MidAir,
        "driving-stereo": DrivingStereo,
        "hypersim": Hypersim,
    }
)
"""Name to the class of the set's settings: all fields have defaults, and `load()` gives its content
by number: `Pair` for most, and what `views.py` holds for flow, ordinal pairs and posed images."""
