"""Usage: python3 evaluation/report FOLDER

Makes report.md, report.html and the figures (SVG and PNG) of all studies whose CSV files
are in the folder. What a CSV file of a study holds is known by its columns, not its name.
"""

import os
import pathlib
import sys

# The folder of this file is run as a program; it is also a package.
sys.path.insert(0, str(pathlib.Path(__file__).resolve().parent.parent))

from report import coverage, cycles, frames, page, paper, samplers, sbc, trajectories  # noqa: E402


def sections_of(output):
    """Of every study that the folder has files of, in a fixed order."""
    files = frames.read_folder(output.folder)
    sections = paper.sections_of(output, files)
    for study in (coverage, sbc, samplers, cycles, trajectories):
        for name, rows in files.items():
            if set(study.COLUMNS) <= set(rows.columns) and len(rows):
                sections.append(study.section_of(output, name, rows))
    return sections


def main():
    if len(sys.argv) != 2:
        sys.exit(__doc__)
    output = page.Output(pathlib.Path(sys.argv[1]))
    try:
        sections = sections_of(output)
        if not sections:
            sys.exit("has no rows of a study, so there is no report")
        page.write(output, sections)
    except (OSError, ValueError, KeyError) as error:
        sys.exit(f"no report: {error}")
    # Names of files are bytes, whatever the locale.
    sys.stdout.buffer.write(os.fsencode(output.folder / "report.html") + b"\n")


if __name__ == "__main__":
    main()
