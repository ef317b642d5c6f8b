"""Registration of point clouds with a calibrated pose covariance.

>>> import bayesian_icp
>>> scans = bayesian_icp.simulate("mug")
>>> result = bayesian_icp.align(source=scans.source, target=scans.target)
>>> result.status
'ok'
>>> result.T_target_source.shape, result.covariance().shape, result.samples.shape
((4, 4), (6, 6), (4, 500, 6))

Poses are (x, y, z, roll, pitch, yaw) [m, rad], R = Rz(yaw) Ry(pitch) Rx(roll), and map
source points into the target frame. Covariances have translation first.
"""

from __future__ import annotations

import importlib.util
from typing import TYPE_CHECKING, Any

from ._align import align
from ._core import (
    CalibratedOptions,
    ChainOptions,
    CoordinateSummary,
    DataReport,
    Direction,
    ExactOptions,
    LikelihoodScale,
    Options,
    PaperOptions,
    PriorOptions,
    ResidualOptions,
    SgldOptions,
    Target,
)
from ._core import __version__ as __version__
from ._draws import ess, mcse, rhat
from ._poses import (
    convert_covariance,
    covariance_about,
    exp_se3,
    g2o_covariance,
    gtsam_covariance,
    log_se3,
    matrix_from_pose,
    mean_pose,
    pose_error,
    pose_from_error,
    pose_from_matrix,
)
from ._result import COORDINATES, Measurement, Mode, Prior, Result

if TYPE_CHECKING:
    from ._scans import ScanPair, read_pcd, read_ply, scenes, simulate

__all__ = [
    "COORDINATES", "CalibratedOptions", "ChainOptions", "CoordinateSummary", "DataReport",
    "Direction", "ExactOptions", "LikelihoodScale", "Measurement", "Mode", "Options",
    "PaperOptions", "Prior", "PriorOptions", "ResidualOptions", "Result", "ScanPair", "SgldOptions",
    "Target", "align", "convert_covariance", "covariance_about", "ess", "exp_se3",
    "g2o_covariance", "gtsam_covariance", "log_se3", "matrix_from_pose", "mcse", "mean_pose",
    "pose_error", "pose_from_error", "pose_from_matrix", "read_pcd", "read_ply", "rhat",
    "scenes", "simulate",
]

# What needs PCL or Boost is loaded when it is first used.
_LATER = ("ScanPair", "read_pcd", "read_ply", "scenes", "simulate")
if importlib.util.find_spec("._tools", __name__) is None:  # a build without the programs
    __all__ = [name for name in __all__ if name not in _LATER]


def __getattr__(name: str) -> Any:
    if name not in _LATER:
        raise AttributeError(f"module 'bayesian_icp' has no attribute {name!r}")
    return getattr(importlib.import_module("._scans", __name__), name)


def __dir__() -> list[str]:
    return sorted(set(__all__) | set(globals()))
