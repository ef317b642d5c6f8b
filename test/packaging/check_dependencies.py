"""Fails unless package.xml names everything that scripts/bootstrap installs."""

import pathlib
import re
import sys
import xml.etree.ElementTree as ElementTree

# Debian's packages whose key in rosdep is another name; None: comes with every ROS, or the
# scripts do without it.
KEYS = {
    "chromium": "chromium-browser",
    "colcon": "python3-colcon-common-extensions",
    "g++": None,
    "gnuplot-nox": "gnuplot",
    "libdiagnostic-msgs-dev": "diagnostic_msgs",
    "libeigen3-dev": "eigen",
    "libgeometry-msgs-dev": "geometry_msgs",
    "libgtest-dev": "gtest",
    "libgtsam-dev": "gtsam",
    "libnav-msgs-dev": "nav_msgs",
    "libopenmpi-dev": "mpi",
    "lld": None,
    "libpcl-conversions-dev": "pcl_conversions",
    "libpcl-dev": "libpcl-all-dev",
    "libroscpp-dev": "roscpp",
    "libsensor-msgs-dev": "sensor_msgs",
    "nlohmann-json3-dev": "nlohmann-json-dev",
    "mypy": "python3-mypy",
    "openmpi-bin": "mpi",
    "python3-ament-index": "ament_index_python",
    "python3-colcon-cmake": "python3-colcon-common-extensions",
    "python3-colcon-recursive-crawl": "python3-colcon-common-extensions",
    "python3-colcon-ros": "python3-colcon-common-extensions",
    "python3-diagnostic-msgs": "diagnostic_msgs",
    "python3-roslaunch": "roslaunch",
    "python3-rospy": "rospy",
    "python3-sensor-msgs": "sensor_msgs",
    "rosidl-generator-c-cpp": "rosidl_generator_cpp",
    "rosidl-tools": "rosidl_cli",
}


def installed_packages(script):
    """The first words of the lines of the tables in scripts/bootstrap."""
    tables = re.findall(r"^\w+_packages='\n(.*?)^'", script, re.MULTILINE | re.DOTALL)
    return [line.split()[0] for table in tables for line in table.splitlines()]


def main():
    root = pathlib.Path(sys.argv[1])
    packages = installed_packages((root / "scripts/bootstrap").read_text())
    if not packages:
        sys.exit("no packages found in scripts/bootstrap")
    named = {
        element.text
        for element in ElementTree.parse(root / "package.xml").getroot()
        if element.tag.endswith("depend")
    }
    keys = {package: KEYS.get(package, package) for package in packages}
    missing = [f"{p} (key {k})" for p, k in keys.items() if k and k not in named]
    if missing:
        sys.exit("package.xml does not name what scripts/bootstrap installs: " + ", ".join(missing))
    print(f"{len(packages)} packages, all in package.xml")


main()
