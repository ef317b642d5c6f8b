"""Arguments that are refused with their name and value."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

CONVENTIONS = ("parameters", "r3xso3", "left_se3", "right_se3")


def numbers(name: str, value: ArrayLike, *shapes: tuple[Any, ...]) -> NDArray[np.float64]:
    """The real numbers of one of some shapes; a leading ``...`` stands for any axes."""
    if isinstance(value, np.ma.MaskedArray) and np.any(value.mask):
        raise ValueError(f"{name} is {value!r}, but none of its numbers may be masked")
    try:
        if np.asarray(value).dtype.kind not in "biuf":
            raise TypeError
        given = np.asarray(value, dtype=np.float64)
    except (TypeError, ValueError) as error:
        raise TypeError(f"{name} is {value!r}, but must be real numbers") from error
    if not any(given.shape == shape or (shape[0] is ... and given.shape[given.ndim + 1 - len(shape):] == shape[1:])
               for shape in shapes):
        allowed = " or ".join(map(str, shapes)).replace("Ellipsis", "...")
        raise ValueError(f"{name} has the shape {given.shape}, but must have {allowed}")
    return given


def convention(name: str, value: str) -> str:
    if value not in CONVENTIONS:
        raise ValueError(f"{name}: {value!r} is none of {list(CONVENTIONS)}")
    return value
