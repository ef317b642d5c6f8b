"""Point clouds from files."""

from __future__ import annotations

import os

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
