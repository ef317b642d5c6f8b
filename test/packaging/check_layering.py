"""Fails if a part of the project includes what is above it.

The core includes neither PCL nor I/O, each room of src/ only the rooms beneath it. The
folders of apps/ and of evaluation/ include each other in one direction, and nothing includes
the studies.
"""

import pathlib
import re
import sys

INCLUDED = re.compile(r'^\s*#\s*include\s*[<"]([^>"]+)[>"]', re.MULTILINE)
NOT_FOR_THE_CORE = re.compile(r"pcl/|iostream$|fstream$")
SHELL = ("include/pcl", "src/pcl")
BELOW_EVALUATION = ("include", "src", "apps", "benchmark")
# What a room of src/ may include. Files in src/ itself are above all rooms.
ROOMS = {
    "algebra": [],
    "options": [],
    "threads": [],
    "geometry": ["algebra", "options"],
    "search": ["threads"],
    "sampler": ["algebra", "threads"],
    "summary": ["options", "sampler"],
    "exports": ["algebra", "geometry"],
    "paper": ["sampler"],
    "exact": ["algebra", "sampler", "search", "summary"],
    "calibrated": ["algebra", "geometry", "sampler", "search", "summary", "threads"],
    "sgd_icp": ["options", "paper"],
    "pcl": [],
}


def files_in(root, folders):
    return [
        path
        for top in folders
        for path in sorted((root / top).rglob("*"))
        if path.suffix in (".h", ".hpp", ".cpp")
    ]


def includes_of(files):
    for path in files:
        for found in INCLUDED.finditer(path.read_text()):
            yield path, found.group(1)


def pcl_or_io(root, core):
    return [
        f"{path.relative_to(root)}: {included}"
        for path, included in includes_of(core)
        if NOT_FOR_THE_CORE.match(included)
    ]


def upward_between_rooms(root):
    """Includes of src/ against the table; a folder without a line there is an error."""
    top = root / "src"
    offences = [f"src/{path.name}: no room" for path in top.iterdir() if path.is_dir() and path.name not in ROOMS]
    for path, included in includes_of(files_in(root, ["src"])):
        parts = path.relative_to(top).parts
        if len(parts) == 1 or not (top / included).exists():
            continue
        room, other = parts[0], included.split("/")[0]
        if other != room and other not in ROOMS.get(room, []):
            offences.append(f"{path.relative_to(root)}: {included}")
    return offences


def circle_between_folders(top):
    """Folders of apps/ or evaluation/ that include each other, directly or not; empty if
    there are none. A main.cpp is above all folders."""
    beneath = {}
    for path, included in includes_of(files_in(top, ["."])):
        folder, other = path.relative_to(top).parts[0], included.split("/")[0]
        if path.name != "main.cpp" and other != folder and (top / included).exists():
            beneath.setdefault(folder, set()).add(other)
    while lowest := [folder for folder, others in beneath.items() if not others & beneath.keys()]:
        for folder in lowest:
            del beneath[folder]
    return sorted(beneath)


def uses_of_evaluation(root):
    """Lines outside the studies that name a header of theirs."""
    studies = {p.relative_to(root / "evaluation").as_posix() for p in files_in(root, ["evaluation"])}
    if not studies:
        sys.exit(f"no studies in {root}")
    return [
        f"{path.relative_to(root)}: {included}"
        for path, included in includes_of(files_in(root, BELOW_EVALUATION))
        if included in studies
        and not (path.parent / included).exists()
        and not (root / "src" / included).exists()
    ]


def main():
    root = pathlib.Path(sys.argv[1])
    core = [
        path
        for path in files_in(root, ("include", "src"))
        if not path.relative_to(root).as_posix().startswith(SHELL)
    ]
    if not core:
        sys.exit(f"no core files in {root}")
    if offences := pcl_or_io(root, core):
        sys.exit("the core must not include these:\n" + "\n".join(offences))
    if offences := upward_between_rooms(root):
        sys.exit("a room of src/ includes what is not beneath it:\n" + "\n".join(offences))
    for top in ("apps", "evaluation"):
        if circle := circle_between_folders(root / top):
            sys.exit(f"folders of {top}/ include each other: {', '.join(circle)}")
    if offences := uses_of_evaluation(root):
        sys.exit("only tests may use evaluation/:\n" + "\n".join(offences))
    print(f"{len(core)} files of the core in {len(ROOMS)} rooms")


main()
