"""The registration."""

from __future__ import annotations

import time
from typing import Any, Callable, Optional

import numpy as np
from numpy.typing import ArrayLike, NDArray

from . import _core
from ._checks import numbers
from ._progress import Bar
from ._result import Result

Observer = Callable[[int, int, NDArray[np.float64]], Optional[bool]]


def align(
    *,
    source: Any,
    target: Any,
    init_T_target_source: ArrayLike | None = None,
    prior_mean: ArrayLike | None = None,
    prior_std: ArrayLike | None = None,
    prior_variance: ArrayLike | None = None,
    prior_frame: str | None = None,
    preset: str | None = None,
    seed: int | None = None,
    num_threads: int | None = None,
    options: _core.Options | None = None,
    progress: bool | Observer = False,
) -> Result:
    """Register a source cloud to a target cloud and sample the posterior of the pose.

    Parameters
    ----------
    source : array_like, (N, 3), or Target
        Points [m], any real dtype and strides, or an ``open3d.geometry.PointCloud``.
        Preset calibrated needs 30 or more. A `Target` is prepared once and used many
        times: in odometry a scan is the source first, and then the target.
    target : array_like, (M, 3), or Target
        The same.
    init_T_target_source : array_like, (4, 4), optional
        Initial guess, which maps source points into the target frame; the identity
        unless it is given. Where no `prior_mean` is given it is the mean of the prior.
    prior_mean : array_like, (4, 4) matrix or (6,) pose, optional
        Mean of the prior: T_target_source, or (x, y, z, roll, pitch, yaw) [m, rad].
    prior_std, prior_variance : array_like, (2,) or (6,), optional
        One of the two: standard deviations [m, rad] or variances [m^2, rad^2] of x, y, z,
        roll, pitch, yaw, or one for the translations and one for the angles. Each
        variance is 0.125 (0.35 m, 0.35 rad) unless it is given. Where the clouds say
        nothing, the posterior is the prior.
    prior_frame : {"automatic", "origin", "source-centroid"}, optional
        The point whose translation the prior describes: the sensor for scans
        ("origin"), the centroid for objects.
    preset : {"calibrated", "exact", "paper"}, optional
        Which posterior is sampled. Only "calibrated" has a calibrated covariance.
    seed : int, optional
        Seed of all random numbers, 1 unless it is given. The same seed gives the same
        draws, bit for bit, as in C++, on any number of threads.
    num_threads : int, optional
        0, the default: as many as OpenMP takes.
    options : Options, optional
        Everything else. The keywords above come before it; it is not changed.
    progress : bool or callable, optional
        True shows a bar on standard error. A callable gets ``(steps, total_steps,
        pose)`` some times a second, in the calling thread; if it returns False, the
        run is cancelled. While no draw is made, both numbers are 0 and the pose is
        NaN.

    Returns
    -------
    Result
        Look at its `status` and `flags` before you use the numbers. Without a posterior
        (status "too_few_correspondences") they are NaN.

    Raises
    ------
    TypeError
        If a cloud is no array of real numbers.
    ValueError
        If a shape, a point, the guess or an option is bad; the text has its name and
        value. If there are too few points.
    KeyboardInterrupt
        On Ctrl-C, which ends the run.

    Examples
    --------
    >>> import bayesian_icp
    >>> scans = bayesian_icp.simulate("mug")
    >>> result = bayesian_icp.align(
    ...     source=scans.source, target=scans.target, prior_std=(0.1, 0.2))
    >>> R, t = result.T_target_source[:3, :3], result.T_target_source[:3, 3]
    >>> moved_source = scans.source @ R.T + t
    >>> bool(abs(result.mean[0] - scans.T_target_source[0, 3]) < 0.003)
    True
    """
    if not isinstance(progress, bool) and not callable(progress):
        raise TypeError(f"progress is {progress!r}, but must be a bool or a function")
    if not isinstance(options, (_core.Options, type(None))):
        raise TypeError(f"options is {options!r}, but must be of bayesian_icp.Options")
    chosen = _core.Options() if options is None else _core.Options(options)
    guess = _pose("init_T_target_source", np.eye(4) if init_T_target_source is None else init_T_target_source)
    if preset is not None:
        chosen.preset = preset
    if seed is not None:
        chosen.chains.seed = seed
    if num_threads is not None:
        chosen.chains.num_threads = num_threads
    if prior_mean is not None:
        chosen.prior.mean = _pose("prior_mean", prior_mean)
    if prior_std is not None and prior_variance is not None:
        raise ValueError("prior_std and prior_variance are both given, but say the same")
    if prior_std is not None:
        chosen.prior.variance = _six("prior_std", prior_std, chosen.preset) ** 2
    if prior_variance is not None:
        chosen.prior.variance = _six("prior_variance", prior_variance, chosen.preset)
    if prior_frame is not None:
        chosen.prior.frame = prior_frame
    if not isinstance(source, _core.Target):
        source = _core.Target(source, "source")
    if not isinstance(target, _core.Target):
        target = _core.Target(target)
    bar = Bar() if progress is True else None
    observer: Observer | None = bar.update if bar else progress if callable(progress) else None
    start = time.monotonic()
    try:
        estimate = _core.estimate(source, target, guess, chosen, observer)
    finally:
        if bar:
            bar.close()
    return Result(estimate, chosen, guess, (len(source), len(target)), time.monotonic() - start)


def _six(name: str, value: ArrayLike, preset: str) -> NDArray[np.float64]:
    six = numbers(name, value, (6,), (2,))
    if six.shape == (2,):
        six = np.repeat(six, 3)
    if not np.all(six > 0):
        raise ValueError(f"{name} is {value!r}, but must be positive")
    if preset == "calibrated" and np.isinf(six).any():
        raise ValueError(f"{name} is {value!r}, but must be finite for preset calibrated")
    return six


def _pose(name: str, value: ArrayLike) -> NDArray[np.float64]:
    pose = numbers(name, value, (4, 4), *([(6,)] if name == "prior_mean" else []))
    if not np.isfinite(pose).all():
        raise ValueError(f"{name} is not finite: {pose.tolist()}")
    try:
        return pose if pose.shape == (6,) else _core.pose_from_matrix(pose)
    except ValueError as error:
        raise ValueError(f"{name}: {error}") from None
