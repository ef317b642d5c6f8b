"""Readers, report and simulator; use them by the package bayesian_icp."""

from typing import Any, Sequence

import numpy as np
from numpy.typing import ArrayLike, NDArray

from ._core import Estimate, Options

def read_points(path: str | bytes) -> NDArray[np.float32]: ...
def simulate(
    arguments: Sequence[str],
) -> tuple[NDArray[np.float32], NDArray[np.float32], NDArray[np.float64]]: ...
def scenes() -> list[list[str]]: ...
def write_report(
    estimate: Estimate,
    options: Options,
    guess: ArrayLike,
    seconds: float,
    path: str | bytes,
    source: Any,
    target: Any,
    num_points: tuple[int, int],
) -> None: ...
