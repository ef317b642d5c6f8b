"""Fails unless the public types are laid out as a committed list says.

The list has all of the library's classes that its headers define, with their size, the
offset of every member and base, and the place of every virtual function; and all
enumerators with their values. They are read from the debug information of an object file
that includes every header.

Arguments: object file, list; --write writes the list anew.
"""

import re
import subprocess
import sys

import committed_list

ENTRY = re.compile(r" <(\d+)><[0-9a-f]+>: Abbrev Number: \d+ \(DW_TAG_(\w+)\)")
ATTRIBUTE = re.compile(
    r"    <[0-9a-f]+>   DW_AT_(name|byte_size|data_member_location|data_bit_offset|const_value"
    r"|vtable_elem_location)\s*: (?:\(indirect (?:line )?string, offset: \w+\): )?(.*)"
)
OURS = re.compile(
    r"bayesian_icp::|pcl::bayesian_icp_detail::"
    r"|pcl::(BayesianIterativeClosestPoint|StochasticGradientDescentIterativeClosestPoint)<"
)
# One point type stands for all.
OTHER_POINTS = re.compile(r"pcl::Point(?!XYZ[,>])")
TYPES = ("structure_type", "class_type", "union_type", "enumeration_type")


class Entry:
    """One of the debug information: a namespace, a type, a member, ..."""

    def __init__(self, depth, tag, parent):
        self.depth = depth
        self.tag = tag
        self.parent = parent
        self.attributes = {}
        self.children = []

    def name(self):
        """Qualified; empty if it or what it is in has none."""
        own = self.attributes.get("name", "").strip()
        if self.parent is None or not own:
            return own
        outer = self.parent.name()
        return f"{outer}::{own}" if outer else ""

    def lines(self):
        """Those of a type."""
        name, number = self.name(), self.attributes["byte_size"]
        yield f"{name}: size {number}"
        for child in self.children:
            attributes = child.attributes
            own = attributes.get("name", "(unnamed)").strip()
            if child.tag == "enumerator":
                yield f"{name}::{own} {attributes['const_value']}"
            elif child.tag == "inheritance":
                yield f"{name}: base at {attributes['data_member_location']}"
            elif child.tag == "member" and "data_bit_offset" in attributes:
                yield f"{name}.{own} bit {attributes['data_bit_offset']}"
            elif child.tag == "member" and "data_member_location" in attributes:
                yield f"{name}.{own} {attributes['data_member_location']}"
            elif "vtable_elem_location" in attributes:
                place = re.search(r"DW_OP_constu: (\d+)", attributes["vtable_elem_location"])
                yield f"{name}: virtual {own} {place.group(1)}"


def types_in(object_file):
    """The types of ours that the debug information defines."""
    command = ["readelf", "--debug-dump=info", object_file]
    with subprocess.Popen(command, stdout=subprocess.PIPE, text=True) as readelf:
        current, types = None, []
        for line in readelf.stdout:
            if found := ENTRY.match(line):
                depth = int(found.group(1))
                while current and current.depth >= depth:
                    current = current.parent
                # The compilation unit, at depth 0, is no scope.
                current = Entry(depth, found.group(2), current if depth > 1 else None)
                if current.parent:
                    current.parent.children.append(current)
                if current.tag in TYPES:
                    types.append(current)
            elif current and (found := ATTRIBUTE.match(line)):
                current.attributes[found.group(1)] = found.group(2)
    if readelf.returncode != 0:
        sys.exit(f"{object_file} cannot be read")
    defined = [each for each in types if "byte_size" in each.attributes]
    return [
        each
        for each in defined
        if OURS.match(each.name()) and not OTHER_POINTS.search(each.name())
    ]


def lines_in(object_file):
    groups = sorted({tuple(each.lines()) for each in types_in(object_file)})
    return [line for lines in groups for line in lines]


committed_list.check(
    lines_in,
    "Programs that were compiled before do not work any more: the minor version has to be\n"
    "raised after a release.",
)
