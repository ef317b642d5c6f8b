"""Fails unless CMake, package.xml and CHANGELOG.md name the same version."""

import pathlib
import re
import sys
import xml.etree.ElementTree as ElementTree


def changelog_version(path):
    """The version of the newest entry."""
    found = re.search(r"^## \[(\d+\.\d+\.\d+)\]", path.read_text(), re.MULTILINE)
    return found.group(1) if found else "none"


def main():
    root = pathlib.Path(sys.argv[1])
    versions = {
        "CMakeLists.txt": sys.argv[2],
        "package.xml": ElementTree.parse(root / "package.xml").findtext("version"),
        "CHANGELOG.md": changelog_version(root / "CHANGELOG.md"),
    }
    for file, version in versions.items():
        print(f"{file}: {version}")
    sys.exit(len(set(versions.values())) != 1)


main()
