"""Poses of a camera that moves about a table, and the graphs that are made of its scans."""

import json
import math

from cli_tool import ToolTest, call
from faults import SIMULATE
from robot_formats import conjugate, multiplied, read_g2o_edge, turned

# Where the camera of a short trajectory stands, world frame [m].
FOUR_EYES = ["0,-1.2,0.7", "0.06,-1.19,0.72", "0.12,-1.17,0.71", "0.18,-1.14,0.7"]

# 99.9 % and 0.1 % quantiles of chi-square, by degrees of freedom (R 4.2, qchisq).
CHI2_HIGH = {1: 10.828, 6: 22.458, 18: 42.312}
CHI2_LOW = {18: 4.905}
# The posterior of one registration is Student's t with 20 degrees of freedom, of the covariance
# that it states. 99.9 % of its squared errors of six: 6 18 / 20 qf(0.999, 6, 20).
STUDENT_HIGH = 32.500
IDENTITY = ((0.0, 0.0, 0.0), (0.0, 0.0, 0.0, 1.0))


# A pose is (position, quaternion x y z w).


def composed(a, b):
    position = [x + y for x, y in zip(a[0], turned(a[1], b[0]))]
    return position, multiplied(a[1], b[1])


def inverted(a):
    back = conjugate(a[1])
    return [-x for x in turned(back, a[0])], back


def chained(poses):
    result = IDENTITY
    for pose in poses:
        result = composed(result, pose)
    return result


def g2o_error(measured, true):
    position, q = composed(inverted(measured), true)
    sign = math.copysign(1.0, q[3])
    return [*position, *(sign * c for c in q[:3])]


def small_pose(error):
    vector = error[3:]
    return error[:3], (*vector, math.sqrt(1.0 - sum(c * c for c in vector)))


def pose_of_matrix(m):
    # Each row is the quaternion, multiplied by four times one of its numbers.
    trace = m[0][0] + m[1][1] + m[2][2]
    x, y, z = m[2][1] - m[1][2], m[0][2] - m[2][0], m[1][0] - m[0][1]
    rows = [[m[i][k] + m[k][i] for k in range(3)] + [(x, y, z)[i]] for i in range(3)]
    for i in range(3):
        rows[i][i] += 1 - trace
    rows.append([x, y, z, 1 + trace])
    row = max(rows, key=lambda row: math.hypot(*row))
    length = math.copysign(math.hypot(*row), row[3])
    return [m[k][3] for k in range(3)], tuple(c / length for c in row)


def solved(matrix, columns):
    """X with matrix X = columns, by Gauss-Jordan with pivots."""
    size = len(matrix)
    rows = [[*matrix[i], *columns[i]] for i in range(size)]
    for k in range(size):
        pivot = max(range(k, size), key=lambda i: abs(rows[i][k]))
        rows[k], rows[pivot] = rows[pivot], rows[k]
        rows[k] = [x / rows[k][k] for x in rows[k]]
        for i in range(size):
            if i != k:
                rows[i] = [x - rows[i][k] * y for x, y in zip(rows[i], rows[k])]
    return [row[size:] for row in rows]


def inverse(matrix):
    return solved(matrix, [[float(i == k) for k in range(6)] for i in range(6)])


def quadratic(error, matrix):
    return sum(error[i] * matrix[i][k] * error[k] for i in range(6) for k in range(6))


def rows_of_file(path):
    """The numbers in each line."""
    return [list(map(float, line.split())) for line in path.read_text().splitlines()]


def read_graph(path):
    """({id: pose}, {(i, j): (pose, information)})."""
    vertices, edges = {}, {}
    for line in path.read_text().splitlines():
        words = line.split()
        if words[0] == "VERTEX_SE3:QUAT":
            numbers = list(map(float, words[2:]))
            assert len(numbers) == 7
            vertices[int(words[1])] = (numbers[:3], tuple(numbers[3:]))
        elif words[0] == "EDGE_SE3:QUAT":
            i, j, position, quaternion, information = read_g2o_edge(line)
            edges[i, j] = ((position, tuple(quaternion)), information)
        else:
            assert words == ["FIX", "0"], line
    return vertices, edges


class TrajectoryTest(ToolTest):
    """Scans whose poses are known."""

    def trajectory(self, eyes):
        """Scans of the table from a moving camera; (folder, maps from the world)."""
        scans = self.folder / "scans"
        scans.mkdir()
        from_world = []
        for k, eye in enumerate(eyes):
            output = self.folder / f"view{k}"
            view = ["--source-eye", eye, "--source-look-at", "0,0,0", "--seed", k + 1]
            view += ["--frame", "sensor", "--offset", "0,0,0,0,0,0"]
            size = ["--width", 160, "--height", 120]
            result = call(SIMULATE, "--scene", "table", *view, *size, "-o", output)
            self.assertEqual(result.returncode, 0, result.stderr)
            (output / "source.pcd").rename(scans / f"scan_{k}.pcd")
            scene = json.loads((output / "scene.json").read_text())
            from_world.append(pose_of_matrix(scene["T_source_world"]))
        return scans, from_world

    def assert_same_pose(self, found, expected):
        self.assertLess(max(map(abs, g2o_error(found, expected))), 1e-12)
