"""``python -m bayesian_icp``: the program pcl_bayesian_icp, with its options and exit codes."""

import os
import pathlib
import shutil
import sys

_PROGRAM = "pcl_bayesian_icp"


def main() -> None:
    bundled = pathlib.Path(__file__).parent / "bin" / _PROGRAM
    program = str(bundled) if bundled.exists() else shutil.which(_PROGRAM)
    if program is None:
        sys.exit(f"bayesian_icp: the program {_PROGRAM} is not in PATH (Debian package pcl-bayesian-icp-tools)")
    os.execv(program, [program, *sys.argv[1:]])


if __name__ == "__main__":
    main()
