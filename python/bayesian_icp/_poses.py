"""Poses (x, y, z, roll, pitch, yaw) [m, rad], their errors and covariances."""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike, NDArray

from . import _core
from ._checks import convention as _convention
from ._checks import numbers

Array = NDArray[np.float64]


def matrix_from_pose(pose: ArrayLike) -> Array:
    """(4, 4) T_target_source of a (6,) pose (x, y, z, roll, pitch, yaw) [m, rad]."""
    return _core.matrix_from_pose(numbers("pose", pose, (6,)))


def pose_from_matrix(T_target_source: ArrayLike) -> Array:
    """(6,) pose (x, y, z, roll, pitch, yaw) [m, rad] of a (4, 4) matrix [m].

    The matrix is taken to the accuracy of 32 bits: its rotation is made the nearest one.
    ValueError if it is mirrored, scaled, sheared, transposed or not finite.
    """
    return _core.pose_from_matrix(numbers("T_target_source", T_target_source, (4, 4)))


def pose_error(pose: ArrayLike, mean: ArrayLike, convention: str = "parameters") -> Array:
    """(6,) error of a (6,) pose relative to a (6,) mean [m, rad].

    The covariance of a convention is the second moment of this.
    """
    return _core.pose_error(numbers("pose", pose, (6,)), numbers("mean", mean, (6,)),
                            _convention("convention", convention))


def pose_from_error(error: ArrayLike, mean: ArrayLike, convention: str = "parameters") -> Array:
    """The (6,) pose that has a (6,) error relative to a mean: the inverse of `pose_error`.

    With "parameters" its pitch may be beyond pi/2.
    """
    return _core.pose_from_error(numbers("error", error, (6,)), numbers("mean", mean, (6,)),
                                 _convention("convention", convention))


def mean_pose(draws: ArrayLike) -> Array:
    """(6,) bi-invariant mean on SE(3) of (..., 6) draws [m, rad], as `Result.samples`."""
    return _core.mean_pose(numbers("draws", draws, (..., 6)).reshape(-1, 6))


def covariance_about(mean: ArrayLike, draws: ArrayLike, convention: str = "parameters") -> Array:
    """(6, 6) second moment of the errors of (..., 6) draws about a (6,) mean [m, rad]."""
    return _core.covariance_about(numbers("mean", mean, (6,)), numbers("draws", draws, (..., 6)).reshape(-1, 6),
                                  _convention("convention", convention))


def convert_covariance(covariance: ArrayLike, mean: ArrayLike, source: str, target: str) -> Array:
    """Convert a 6x6 covariance from one convention to another, to first order.

    `Result.covariance` needs no conversion: it is made of the draws in each convention.

    Parameters
    ----------
    covariance : array_like, (6, 6)
        In the convention `source` [m, rad]: finite, symmetric, no negative eigenvalue.
    mean : array_like, (6,)
        Pose that it is about: x, y, z, roll, pitch, yaw [m, rad].
    source, target : {"parameters", "r3xso3", "left_se3", "right_se3"}

    Returns
    -------
    ndarray, (6, 6)

    Raises
    ------
    ValueError
        If an argument is none of these.

    Examples
    --------
    >>> import numpy as np
    >>> turned = [0, 0, 0, 0, 0, np.pi / 2]
    >>> body = np.diag([4.0, 1, 1, 1, 1, 1])
    >>> bool(np.isclose(convert_covariance(body, turned, "right_se3", "left_se3")[1, 1], 4))
    True
    """
    given = numbers("covariance", covariance, (6, 6))
    pose = numbers("mean", mean, (6,))
    if not np.isfinite(pose).all():
        raise ValueError(f"mean is {pose.tolist()}, but must be finite")
    std = np.sqrt(np.abs(np.diag(given)))
    correlation = given / np.where(std > 0, std, 1) / np.where(std > 0, std, 1)[:, None]
    if not (np.isfinite(given).all() and np.all(np.diag(given) >= 0)
            and np.all(np.abs(given - given.T) <= 1e-9 * np.outer(std, std))
            and np.linalg.eigvalsh(correlation).min() >= -1e-9):
        raise ValueError(f"covariance is {given.tolist()}, but must be finite and symmetric, "
                         "without negative variances in any direction")
    return _core.convert_covariance(given, pose, _convention("source", source), _convention("target", target))


def exp_se3(twist: ArrayLike) -> Array:
    """(4, 4) matrix of a (6,) twist (v, w) [m, rad]."""
    return _core.exp_se3(numbers("twist", twist, (6,)))


def log_se3(transform: ArrayLike) -> Array:
    """(6,) twist (v, w) [m, rad] of a (4, 4) matrix; ValueError as in `pose_from_matrix`."""
    return _core.log_se3(numbers("transform", transform, (4, 4)))


def gtsam_covariance(right_se3: ArrayLike) -> Array:
    """(6, 6) covariance of convention right_se3 in GTSAM's order, rotation first."""
    return _core.gtsam_covariance(numbers("right_se3", right_se3, (6, 6)))


def g2o_covariance(right_se3: ArrayLike) -> Array:
    """(6, 6) covariance of convention right_se3 in g2o's coordinates: translation, then
    the vector part of the quaternion."""
    return _core.g2o_covariance(numbers("right_se3", right_se3, (6, 6)))
