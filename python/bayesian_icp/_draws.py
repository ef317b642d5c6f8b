"""Diagnostics of draws, and covariances from one convention to another."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, Callable

import numpy as np

from . import _core

if TYPE_CHECKING:
    from numpy.typing import ArrayLike, NDArray

    Array = NDArray[np.float64]


def _each_quantity(function: Callable[[Array], float], draws: ArrayLike) -> Array:
    """Apply a diagnostic of (draws, chains) to each quantity of (chains, draws, ...)."""
    values = np.asarray(draws, dtype=np.float64)
    if values.ndim < 2:
        raise ValueError(f"draws has the shape {values.shape}, but must have (chains, draws, ...)")
    columns = values.reshape(*values.shape[:2], math.prod(values.shape[2:]))
    results = [function(columns[:, :, k].T) for k in range(columns.shape[2])]
    return np.array(results).reshape(values.shape[2:])


def rhat(draws: ArrayLike) -> Array:
    """Rank-normalised split R-hat of Vehtari et al. 2021; 1 is perfect, up to 1.01 good.

    Parameters
    ----------
    draws : array_like, (chains, draws, ...)
        One or more quantities; for angles, errors about their mean.

    Returns
    -------
    ndarray, (...)
        NaN where it is undefined: fewer than four draws in a chain, constant draws.
    """
    return _each_quantity(_core.rhat, draws)


def ess(draws: ArrayLike, kind: str = "bulk") -> Array:
    """Effective sample size of Vehtari et al. 2021; 400 or more is good.

    Parameters
    ----------
    draws : array_like, (chains, draws, ...)
    kind : {"bulk", "tail"}

    Returns
    -------
    ndarray, (...)
        NaN where it is undefined: fewer than six draws in a chain, constant draws.
    """
    functions = {"bulk": _core.bulk_ess, "tail": _core.tail_ess}
    if kind not in functions:
        raise ValueError(f"kind is {kind!r}, but must be 'bulk' or 'tail'")
    return _each_quantity(functions[kind], draws)


def mcse(draws: ArrayLike) -> Array:
    """Monte Carlo standard error of the mean of (chains, draws, ...), in their unit."""
    return _each_quantity(_core.mcse_mean, draws)


def convert_covariance(covariance: ArrayLike, mean: ArrayLike, source: str, target: str) -> Array:
    """Convert a 6x6 covariance from one convention to another, to first order.

    `Result.covariance` needs no conversion: it is made of the draws in each convention.

    Parameters
    ----------
    covariance : array_like, (6, 6)
        In the convention `source` [m, rad].
    mean : array_like, (6,)
        Pose that it is about: x, y, z, roll, pitch, yaw [m, rad].
    source, target : {"parameters", "r3xso3", "left_se3", "right_se3"}

    Returns
    -------
    ndarray, (6, 6)

    Examples
    --------
    >>> import numpy as np
    >>> turned = [0, 0, 0, 0, 0, np.pi / 2]
    >>> body = np.diag([4.0, 1, 1, 1, 1, 1])
    >>> bool(np.isclose(convert_covariance(body, turned, "right_se3", "left_se3")[1, 1], 4))
    True
    """
    given = np.asarray(covariance, dtype=np.float64)
    if given.shape != (6, 6):
        raise ValueError(f"covariance has the shape {given.shape}, but must have (6, 6)")
    return _core.convert_covariance(given, mean, source, target)
