"""Fails if a layer includes what is above it: the core PCL or I/O, anything the studies."""

import pathlib
import re
import sys

FORBIDDEN = re.compile(r'^\s*#\s*include\s*[<"](pcl/|iostream>|fstream>)', re.MULTILINE)
INCLUDED = re.compile(r'^\s*#\s*include\s*[<"]([^>"]+)[>"]', re.MULTILINE)
SHELL = ("include/pcl", "src/pcl")
BELOW_EVALUATION = ("include", "src", "apps", "benchmark")


def files_in(root, folders):
    return [
        path
        for top in folders
        for path in sorted((root / top).rglob("*"))
        if path.suffix in (".h", ".hpp", ".cpp")
    ]


def core_files(root):
    return [
        path
        for path in files_in(root, ("include", "src"))
        if not path.relative_to(root).as_posix().startswith(SHELL)
    ]


def uses_of_evaluation(root):
    """Lines outside the studies that name a header of theirs."""
    studies = {p.relative_to(root / "evaluation").as_posix() for p in files_in(root, ["evaluation"])}
    if not studies:
        sys.exit(f"no studies in {root}")
    return [
        f"{path.relative_to(root)}: {found.group(0).strip()}"
        for path in files_in(root, BELOW_EVALUATION)
        for found in INCLUDED.finditer(path.read_text())
        if found.group(1) in studies and not (path.parent / found.group(1)).exists()
    ]


def main():
    root = pathlib.Path(sys.argv[1])
    files = core_files(root)
    if not files:
        sys.exit(f"no core files in {root}")
    offences = [
        f"{path.relative_to(root)}: {found.group(0).strip()}"
        for path in files
        for found in FORBIDDEN.finditer(path.read_text())
    ]
    if offences:
        sys.exit("the core must not include these:\n" + "\n".join(offences))
    if uses := uses_of_evaluation(root):
        sys.exit("only tests may use evaluation/:\n" + "\n".join(uses))
    print(f"{len(files)} files of the core")


main()
