"""The protocols that papers report. Each was read in the source it names."""

from dataclasses import replace

from flexdepth.evaluation.alignment import Alignment
from flexdepth.evaluation.protocols import (
    STANDARD,
    Averaging,
    Range,
    Resize,
    Scope,
    ScoringProtocol,
    WholeMetres,
)
from flexdepth.evaluation.region import EIGEN, EIGEN_NYU, GARG, WHOLE, Fixed, KittiCrop

_NYU = ("NyuLabelled", "NyuFolders")
_NYU_TEST = (("split", "test"), ("depth", "rawDepths"))
_NYU_FILLED = (("split", "test"), ("depth", "depths"))
_ANNOTATED = (("frames", "eigen_test_files_with_gt.txt"),)
_VELODYNE = (("frames", "test_files.txt"), ("depth", "monodepth2"))

_NYU_EIGEN = ScoringProtocol(
    name="nyu-eigen",
    version=1,
    summary="NYU Depth v2, Eigen's crop, 10 m: BTS, AdaBins and most since",
    source="cleinc/bts pytorch/bts_eval.py; shariqfarooq123/AdaBins evaluate.py",
    sets=_NYU,
    images=654,
    settings=_NYU_TEST,
    scored=Range(1e-3, 10.0),
    region=EIGEN_NYU,
    resize=Resize.CORNERS,
    clip=(1e-3, 10.0),
    sky=10.0,
    unknown=1e-3,
)
_NYU_AFFINE = replace(
    _NYU_EIGEN,
    name="nyu-affine",
    summary="NYU Depth v2 for affine-invariant depth: Eigen's crop, 10 m, least squares in depth",
    source="prs-eth/Marigold script/depth/eval.py, data_nyu_test.yaml",
    resize=Resize.BILINEAR,
    alignment=Alignment.LEAST_SQUARES,
    unknown=None,
)
_BTS = ScoringProtocol(
    name="kitti-eigen-garg-bts",
    version=1,
    summary="KITTI Eigen, Garg's crop of the whole image, 80 m, as BTS does it",
    source="cleinc/bts pytorch/bts_eval.py --do_kb_crop --garg_crop",
    sets=("Kitti",),
    images=652,
    settings=_ANNOTATED,
    region=GARG,
    view=KittiCrop(),
    resize=Resize.CORNERS,
    unknown=1e-3,
)
_MONODEPTH2 = ScoringProtocol(
    name="kitti-monodepth2-eigen",
    version=1,
    summary="KITTI Eigen against raw laser points, Garg's crop, 80 m, median: self-supervised",
    source="nianticlabs/monodepth2 evaluate_depth.py --eval_mono --eval_split eigen",
    sets=("KittiVelodyne",),
    images=697,
    settings=_VELODYNE,
    region=GARG,
    resize=Resize.DISPARITY,
    alignment=Alignment.MEDIAN,
)
_KITTI_AFFINE = ScoringProtocol(
    name="kitti-affine",
    version=1,
    summary="KITTI for affine-invariant depth: Eigen's crop of the benchmark crop, 80 m",
    source="prs-eth/Marigold script/depth/eval.py, data_kitti_eigen_test.yaml",
    sets=("Kitti",),
    images=652,
    settings=_ANNOTATED,
    scored=Range(1e-5, 80.0),
    region=KittiCrop(EIGEN),
    view=KittiCrop(),
    alignment=Alignment.LEAST_SQUARES,
    clip=(1e-5, 80.0),
)
_DEPTHCRAFTER = ScoringProtocol(
    name="sintel-depthcrafter",
    version=1,
    summary="Sintel (a): clean pass, 50 frames, one least-squares fit a video in disparity, 70 m",
    source="Tencent/DepthCrafter benchmark/eval/eval.py, dataset_extract_sintel.py",
    sets=("Sintel",),
    settings=(("rendering", "clean"),),
    scored=Range(1e-3, 70.0),
    alignment=Alignment.LEAST_SQUARES_DISPARITY,
    per=Scope.VIDEO,
    least_disparity=1e-3,
    clip=(1e-3, 70.0),
    sky=70.0,
    frames=50,
    averaging=Averaging.VIDEOS,
)
_DYNAMIC = (
    *("alley_2", "ambush_4", "ambush_5", "ambush_6", "cave_2", "cave_4", "market_2", "market_5"),
    *("market_6", "shaman_3", "sleeping_1", "sleeping_2", "temple_2", "temple_3"),
)
"""The sequences of Sintel that MonST3R and CUT3R score."""

_MONST3R = ScoringProtocol(
    name="sintel-monst3r",
    version=1,
    summary="Sintel (c): final pass, factor and offset a sequence by Adam, 70 m, by pixels",
    source="Junyi42/monst3r dust3r/depth_eval.py, align_with_lad2; CUT3R eval/video_depth",
    sets=("Sintel",),
    settings=(("rendering", "final"),),
    videos=_DYNAMIC,
    scored=Range(0.0, 70.0),
    resize=Resize.CUBIC,
    alignment=Alignment.DESCENT,
    per=Scope.VIDEO,
    clip=(1e-5, 70.0),
    sky=70.0,
    averaging=Averaging.VIDEOS_BY_PIXELS,
)
PUBLISHED = (
    _NYU_EIGEN,
    ScoringProtocol(
        name="nyu-vnl",
        version=1,
        summary="NYU Depth v2 as VNL tests it: filled depth, Eigen's crop, no cap, pooled",
        source="VNL (Yin et al., ICCV 2019), tools/test_nyu_metric.py",
        sets=("NyuLabelled",),
        images=654,
        settings=_NYU_FILLED,
        scored=Range(0.0, float("inf")),
        region=EIGEN_NYU,
        clip=None,
        sky=10.0,
        averaging=Averaging.PIXELS,
        metrics=(*STANDARD[:1], "sq_rel_squared", *STANDARD[2:]),
    ),
    _NYU_AFFINE,
    replace(
        _NYU_AFFINE,
        name="nyu-affine-disparity",
        summary="NYU Depth v2 for affine disparity: Eigen's crop, 10 m, least squares in 1/depth",
        alignment=Alignment.LEAST_SQUARES_DISPARITY,
    ),
    _BTS,
    replace(
        _BTS,
        name="kitti-eigen-garg-adabins",
        summary="KITTI Eigen, Garg's crop of the benchmark crop, 80 m, as AdaBins does it",
        source="shariqfarooq123/AdaBins evaluate.py; ZoeDepth, the Toolbox, UniDepth",
        region=KittiCrop(GARG),
    ),
    ScoringProtocol(
        name="kitti-improved",
        version=1,
        summary="KITTI Eigen's 652 with annotated depth, whole image, to 80 m: Depth Anything V2",
        source="DepthAnything/Depth-Anything-V2 metric_depth/train.py",
        sets=("Kitti",),
        images=652,
        settings=_ANNOTATED,
        scored=Range(1e-3, 80.0, closed=True),
        resize=Resize.CORNERS,
        clip=None,
        metrics=(*STANDARD[:5], "silog_half", *STANDARD[6:]),
    ),
    _MONODEPTH2,
    replace(
        _MONODEPTH2,
        name="kitti-monodepth2-benchmark",
        summary="KITTI Eigen's 652 with annotated depth, whole image, no cap on truth, median",
        source="nianticlabs/monodepth2 evaluate_depth.py --eval_mono --eval_split eigen_benchmark",
        sets=("Kitti",),
        images=652,
        settings=_ANNOTATED,
        scored=Range(0.0, float("inf")),
        region=WHOLE,
    ),
    ScoringProtocol(
        name="kitti-vnl",
        version=1,
        summary="KITTI Eigen as VNL tests it: whole image, no crop, no cap, pooled",
        source="VNL (Yin et al., ICCV 2019), tools/test_kitti_metric.py",
        sets=("Kitti",),
        settings=_ANNOTATED,
        scored=Range(0.0, float("inf")),
        clip=None,
        averaging=Averaging.PIXELS,
        metrics=(*STANDARD[:1], "sq_rel_squared", *STANDARD[2:]),
    ),
    _KITTI_AFFINE,
    replace(
        _KITTI_AFFINE,
        name="kitti-affine-disparity",
        summary="KITTI for affine disparity: Eigen's crop of the benchmark crop, 80 m, 1/depth",
        alignment=Alignment.LEAST_SQUARES_DISPARITY,
    ),
    ScoringProtocol(
        name="cityscapes-manydepth",
        version=1,
        summary="Cityscapes: the lower quarter cut off, the middle of the rest, 80 m, median",
        source="nianticlabs/manydepth evaluate_depth.py --eval_split cityscapes",
        sets=("Cityscapes",),
        images=1525,
        settings=(("split", "test"),),
        region=Fixed(256, 768, 192, 1856, 1024, 2048),
        view=Fixed(0, 768, 0, 2048, 1024, 2048),
        resize=Resize.DISPARITY,
        alignment=Alignment.MEDIAN,
    ),
    _DEPTHCRAFTER,
    replace(
        _DEPTHCRAFTER,
        name="sintel-vda",
        summary="Sintel (b): as (a) with 100 frames, and truth in whole metres by a hundred",
        source="DepthAnything/Video-Depth-Anything benchmark/dataset_extract, eval",
        recoded=WholeMetres(),
        frames=100,
    ),
    _MONST3R,
    replace(
        _MONST3R,
        name="sintel-monst3r-scale",
        summary="Sintel (c): as sintel-monst3r, with a factor alone, by Weiszfeld's rounds",
        source="Junyi42/monst3r dust3r/depth_eval.py, align_with_scale; CUT3R eval/video_depth",
        alignment=Alignment.SCALE_WEISZFELD,
    ),
)
"""In the order in which they are tried: the first that is made for a set is the set's own."""
