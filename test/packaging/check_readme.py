"""Fails unless the README's first C++ block is the quick start program's marked part, and
the README is at most 60 lines long."""

import difflib
import pathlib
import re
import sys
import textwrap

MAX_LINES = 60


def between(text, start, end, file):
    """Lines between the first line `start` and the next line `end`, without indentation."""
    found = re.search(
        rf"^[ ]*{re.escape(start)}\n(.*?)^[ ]*{re.escape(end)}$",
        text,
        re.MULTILINE | re.DOTALL,
    )
    if not found or not found.group(1).strip():
        sys.exit(f"{file}: nothing between {start} and {end}")
    return textwrap.dedent(found.group(1)).splitlines()


def main():
    readme, program = (pathlib.Path(name) for name in sys.argv[1:3])
    num_lines = len(readme.read_text().splitlines())
    if num_lines > MAX_LINES:
        sys.exit(f"{readme} has {num_lines} lines, at most {MAX_LINES} are allowed")
    shown = between(readme.read_text(), "```cpp", "```", readme)
    real = between(program.read_text(), "// [quick start]", "// [/quick start]", program)
    difference = list(
        difflib.unified_diff(real, shown, str(program), str(readme), lineterm="")
    )
    if difference:
        sys.exit("\n".join(difference))


main()
