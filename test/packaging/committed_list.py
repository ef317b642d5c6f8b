"""Compares what was found in a build with the lines of a committed file."""

import difflib
import pathlib
import sys


def check(find, reason):
    """Ends the program unless find(first argument) gives the lines of the file that the second
    argument names; --write writes these anew. The reason says what a difference means."""
    build, path = sys.argv[1], pathlib.Path(sys.argv[2])
    found = find(build)
    if "--write" in sys.argv[3:]:
        path.write_text("\n".join(found) + "\n")
        return
    expected = path.read_text().splitlines()
    difference = list(difflib.unified_diff(expected, found, "expected", "found", n=0, lineterm=""))
    if not difference:
        print(f"{build}: {len(found)} lines, as expected")
        return
    print("\n".join(difference))
    sys.exit(
        f"\n{build} is not as {path} says.\n{reason} If all of it is on purpose:\n"
        f"  python3 {sys.argv[0]} {build} {path} --write"
    )
