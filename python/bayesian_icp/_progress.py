"""A progress bar for terminals and notebooks."""

from __future__ import annotations

import sys
import time
from typing import Any

_WIDTH = 30


class Bar:
    """Shows on one line of standard error how far the chains are."""

    def __init__(self) -> None:
        self._start = time.monotonic()
        self._length = 0

    def update(self, steps: int, total_steps: int, pose: Any) -> None:
        seconds = time.monotonic() - self._start
        if total_steps:
            filled = _WIDTH * steps // total_steps
            self._show(f"[{'#' * filled:{_WIDTH}}] {100 * steps // total_steps:3d} %  {seconds:.1f} s")
        else:
            self._show(f"estimating ...  {seconds:.1f} s")

    def close(self) -> None:
        sys.stderr.write("\n" if self._length else "")
        sys.stderr.flush()

    def _show(self, text: str) -> None:
        sys.stderr.write("\r" + text.ljust(self._length))
        sys.stderr.flush()
        self._length = len(text)
