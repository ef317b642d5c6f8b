"""Poses of a camera that moves about a table, and the graphs that are made of its scans.

A pose is a 4x4 matrix."""

import functools
import json

import numpy as np
from numpy.linalg import inv
from scipy.spatial.transform import Rotation

from cli_tool import ToolTest, call
from faults import SIMULATE

# Where the camera of a short trajectory stands, world frame [m].
FOUR_EYES = ["0,-1.2,0.7", "0.06,-1.19,0.72", "0.12,-1.17,0.71", "0.18,-1.14,0.7"]

# 99.9 % and 0.1 % quantiles of chi-square, by degrees of freedom (R 4.2, qchisq).
CHI2_HIGH = {1: 10.828, 3: 16.266, 6: 22.458, 18: 42.312}
CHI2_LOW = {18: 4.905}
# The posterior of one registration is Student's t with 20 degrees of freedom, of the covariance
# that it states. 99.9 % of its squared errors of six: 6 18 / 20 qf(0.999, 6, 20).
STUDENT_HIGH = 32.500


def pose_of(position, quaternion):
    """Of a quaternion x y z w."""
    pose = np.eye(4)
    pose[:3, :3] = Rotation.from_quat(quaternion).as_matrix()
    pose[:3, 3] = position
    return pose


def chained(poses):
    return functools.reduce(np.matmul, poses, np.eye(4))


def g2o_error(measured, true):
    difference = inv(measured) @ true
    *vector, w = Rotation.from_matrix(difference[:3, :3]).as_quat()
    return np.hstack([difference[:3, 3], np.copysign(1.0, w) * np.array(vector)])


def quadratic(error, matrix):
    return error @ matrix @ error


def rows_of_file(path):
    """The numbers in each line."""
    return [list(map(float, line.split())) for line in path.read_text().splitlines()]


def read_g2o_edge(line):
    """(i, j, position, quaternion x y z w, 6x6 information)."""
    words = line.split()
    assert words[0] == "EDGE_SE3:QUAT" and len(words) == 3 + 7 + 21, line
    numbers = np.array(words[3:], dtype=float)
    upper = np.zeros((6, 6))
    upper[np.triu_indices(6)] = numbers[7:]
    return int(words[1]), int(words[2]), numbers[:3], numbers[3:7], upper + np.triu(upper, 1).T


def read_graph(path):
    """({id: pose}, {(i, j): (pose, information)})."""
    vertices, edges = {}, {}
    for line in path.read_text().splitlines():
        words = line.split()
        if words[0] == "VERTEX_SE3:QUAT":
            assert len(words) == 2 + 7, line
            numbers = list(map(float, words[2:]))
            vertices[int(words[1])] = pose_of(numbers[:3], numbers[3:])
        elif words[0] == "EDGE_SE3:QUAT":
            i, j, position, quaternion, information = read_g2o_edge(line)
            edges[i, j] = (pose_of(position, quaternion), information)
        else:
            assert words == ["FIX", "0"], line
    return vertices, edges


class TrajectoryTest(ToolTest):
    """Scans whose poses are known."""

    def trajectory(self, eyes):
        """Scans of the table from a moving camera; (folder, maps from the world)."""
        sensor = ["--scene", "table", "--width", 160, "--height", 120]
        return self.trajectory_of(sensor, [(eye, "0,0,0") for eye in eyes])

    def trajectory_in_a_plane(self, num_scans):
        """Scans of a room from a moving 2-D laser scanner; (folder, maps from the world)."""
        sensor = ["--scene", "room", "--sensor", "lidar", "--rings", 1, "--azimuth-step", 0.5]
        sensor += ["--min-elevation", 0, "--max-elevation", 0]
        views = []
        for k in range(num_scans):
            x, y, yaw = 0.05 * k, -0.5 + 0.04 * k, 0.3 + 0.05 * k
            views.append((f"{x},{y},1", f"{x + np.cos(yaw)},{y + np.sin(yaw)},1"))
        return self.trajectory_of(sensor, views)

    def trajectory_of(self, sensor, views):
        """Scans from (eye, point to look at); (folder, maps from the world)."""
        scans = self.folder / "scans"
        scans.mkdir()
        from_world = []
        for k, (eye, look_at) in enumerate(views):
            output = self.folder / f"view{k}"
            view = ["--source-eye", eye, "--source-look-at", look_at, "--seed", k + 1]
            view += ["--frame", "sensor", "--offset", "0,0,0,0,0,0"]
            result = call(SIMULATE, *sensor, *view, "-o", output)
            self.assertEqual(result.returncode, 0, result.stderr)
            (output / "source.pcd").rename(scans / f"scan_{k}.pcd")
            scene = json.loads((output / "scene.json").read_text())
            from_world.append(np.array(scene["T_source_world"]))
        return scans, from_world

    def assert_same_pose(self, found, expected):
        self.assertLess(max(map(abs, g2o_error(found, expected))), 1e-12)
