"""Point clouds from files, and pairs of scans with a known pose."""

from __future__ import annotations

import os
import re
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from . import _tools


def read_pcd(path: str | os.PathLike[str]) -> NDArray[np.float32]:
    """Read the finite points of a PCD or PLY file; its name says which of them it is.

    Parameters
    ----------
    path : path_like
        Ends in ``.pcd`` (ASCII, binary or compressed) or ``.ply``.

    Returns
    -------
    ndarray, (N, 3), float32
        x, y, z [m] in the order of the file, without points that are not finite. Far from
        the origin 32 bits keep few digits: from 10 km on, a warning says how many.

    Raises
    ------
    OSError
        If the file cannot be read, is damaged, or has fewer than three finite points;
        the text has the file and the reason.
    """
    return _tools.read_points(os.fsencode(path))


read_ply = read_pcd


class ScanPair(NamedTuple):
    """Two scans of a scene."""

    source: NDArray[np.float32]
    """(N, 3) points [m]."""
    target: NDArray[np.float32]
    """(M, 3) points [m]."""
    T_target_source: NDArray[np.float64]
    """(4, 4) the true pose."""


def simulate(scene: str, *, seed: int = 1, same_view: bool = False, **options: Any) -> ScanPair:
    """Scan a simulated scene twice, as the program pcl_bayesian_icp_simulate does.

    Parameters
    ----------
    scene : str
        One of `scenes`.
    seed : int
        Of the noise. The same arguments give the same points.
    same_view : bool
        Scan the source from the target's view.
    **options
        The options of the program with underscores: ``noise=2``, ``sensor="lidar64"``,
        ``width=160, height=120``, ``source_eye=(1, 0, 0.5)``. Its ``--help`` explains them.

    Raises
    ------
    TypeError
        If there is no such option.
    ValueError
        If there is no such scene, or a value is out of range.

    Examples
    --------
    >>> scans = simulate("mug", width=160, height=120)
    >>> scans.source.shape[1], scans.T_target_source.shape
    (3, (4, 4))
    """
    arguments = [f"--scene={scene}", f"--seed={seed}", "--output=none"]
    arguments += ["--same-view"] if same_view else []
    for name, value in options.items():
        option = "--" + name.replace("_", "-")
        if np.ndim(value):
            value = ",".join(repr(float(number)) for number in value)
        arguments.append(f"{option}={value}")
    try:
        return ScanPair(*_tools.simulate(arguments))
    except ValueError as error:
        text = str(error)
    unknown = re.match("(?:unrecognised )?option '--([^'=]*)", text)
    if unknown:
        raise TypeError(f"simulate() has no option {unknown[1].replace('-', '_')}")
    raise ValueError(text.replace("--list-scenes shows all", "scenes() lists all"))


def scenes() -> dict[str, str]:
    """The scenes of `simulate`: name, and what they are and leave unobservable."""
    return {name: f"{what}; unobservable: {unseen}" for name, what, unseen in _tools.scenes()}
