"""Readers of the exported formats and their error coordinates, written from the formats'
own definitions with SciPy's rotations, without a look at the library: an outside witness.

Draws are an array with a pose x y z roll pitch yaw in each row."""

import numpy as np
from scipy.spatial.transform import Rotation


def read_g2o_edge(line):
    """(i, j, position, quaternion x y z w, 6x6 information)."""
    words = line.split()
    assert words[0] == "EDGE_SE3:QUAT" and len(words) == 3 + 7 + 21, line
    numbers = np.array(words[3:], dtype=float)
    upper = np.zeros((6, 6))
    upper[np.triu_indices(6)] = numbers[7:]
    return int(words[1]), int(words[2]), numbers[:3], numbers[3:7], upper + np.triu(upper, 1).T


def rotation_of(pose):
    """R = Rz(yaw) Ry(pitch) Rx(roll)."""
    return Rotation.from_euler("xyz", pose[..., 3:])


def right_twist(mean, draws):
    """(v, w) with draw = mean exp(v, w)."""
    inverse = rotation_of(mean).inv()
    t = inverse.apply(draws[:, :3] - mean[:3])
    w = (inverse * rotation_of(draws)).as_rotvec()
    # v = t - w x t / 2 + c w x (w x t)
    angle = np.linalg.norm(w, axis=1, keepdims=True)
    large = np.maximum(angle, 1e-2)
    c = 1 / large**2 - (1 + np.cos(large)) / (2 * large * np.sin(large))
    c = np.where(angle > 1e-2, c, 1 / 12)
    wt = np.cross(w, t)
    return t - wt / 2 + c * np.cross(w, wt), w


def ros_error(mean, draws):
    """Shift in the target frame, rotation about its fixed axes."""
    rotation = rotation_of(draws) * rotation_of(mean).inv()
    return np.hstack([draws[:, :3] - mean[:3], rotation.as_rotvec()])


def g2o_error(mean, draws):
    """To first order: the twist with half angles."""
    v, w = right_twist(mean, draws)
    return np.hstack([v, w / 2])


def gtsam_error(mean, draws):
    """Pose3::Logmap: rotation first."""
    v, w = right_twist(mean, draws)
    return np.hstack([w, v])


def parameter_error(mean, draws):
    errors = draws - mean
    angles = errors[:, 3:]
    return np.hstack([errors[:, :3], np.arctan2(np.sin(angles), np.cos(angles))])
