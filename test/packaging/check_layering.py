"""Fails if the core includes PCL or does I/O: only the PCL shell and the tools may."""

import pathlib
import re
import sys

FORBIDDEN = re.compile(r'^\s*#\s*include\s*[<"](pcl/|iostream>|fstream>)', re.MULTILINE)
SHELL = ("include/pcl", "src/pcl")


def core_files(root):
    for top in ("include", "src"):
        for path in sorted((root / top).rglob("*")):
            inside_shell = path.relative_to(root).as_posix().startswith(SHELL)
            if path.suffix in (".h", ".hpp", ".cpp") and not inside_shell:
                yield path


def main():
    root = pathlib.Path(sys.argv[1])
    files = list(core_files(root))
    if not files:
        sys.exit(f"no core files in {root}")
    offences = [
        f"{path.relative_to(root)}: {found.group(0).strip()}"
        for path in files
        for found in FORBIDDEN.finditer(path.read_text())
    ]
    if offences:
        sys.exit("the core must not include these:\n" + "\n".join(offences))
    print(f"{len(files)} files of the core")


main()
