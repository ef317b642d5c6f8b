"""Fails unless a shared library exports the C++ symbols of a committed list, and no other.

A line is a demangled name. Constructors and the like that exist several times are one line,
and so is a member of a class template: POINT and SCALAR stand for the point types and
scalars of the list's first lines, for each of which it is exported.

Arguments: library, list; --write writes the list anew.
"""

import re
import subprocess

import committed_list

# The classes of registration: <source point, the same target point, scalar>.
ARGUMENTS = re.compile(r"<(pcl::\w+), \1, (float|double)>")


def exported_names(library):
    """Demangled names, without version and without duplicates."""
    run = subprocess.run(
        ["nm", "--dynamic", "--defined-only", "--demangle", library],
        check=True,
        capture_output=True,
        text=True,
    )
    return {line.split(" ", 2)[2] for line in run.stdout.splitlines()}


def collapse(names):
    """From each generic name to the (point, scalar) for which it is there; those of names
    that are no members of a class template are empty."""
    instances = {}
    for name in names:
        found = ARGUMENTS.search(name)
        if not found:
            instances[name] = set()
            continue
        point, scalar = found.groups()
        generic = re.sub(rf"{point}\b", "POINT", name)
        generic = generic.replace(f"<POINT, POINT, {scalar}>", "<POINT, POINT, SCALAR>")
        generic = generic.replace(f"Eigen::Matrix<{scalar}, 4, 4,", "Eigen::Matrix<SCALAR, 4, 4,")
        instances.setdefault(generic, set()).add((point, scalar))
    return instances


def list_of(names):
    """The lines of the list."""
    instances = collapse(names)
    everything = set().union(*instances.values())
    lines = [f"POINT, SCALAR: {point}, {scalar}" for point, scalar in sorted(everything)]
    for name in sorted(instances):
        missing = sorted(everything - instances[name]) if instances[name] else []
        lines.append(name + "".join(f" [not for {point}, {scalar}]" for point, scalar in missing))
    return lines


committed_list.check(
    lambda library: list_of(exported_names(library)),
    "A line with - is gone: programs that were linked before do not start any more, and\n"
    "the minor version has to be raised. A line with + is new: if it is meant for users,\n"
    "it is declared in a public header.",
)
