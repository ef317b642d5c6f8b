"""Diagnostics of draws."""

from __future__ import annotations

import math
from typing import Callable

import numpy as np
from numpy.typing import ArrayLike, NDArray

from . import _core
from ._checks import numbers

Array = NDArray[np.float64]


def _each_quantity(function: Callable[[Array], float], draws: ArrayLike) -> Array:
    """Apply a diagnostic of (draws, chains) to each quantity of (chains, draws, ...)."""
    values = numbers("draws", draws, (...,))
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
