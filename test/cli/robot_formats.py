"""Readers of the exported formats and their error coordinates, written from the formats'
own definitions with quaternions, without a look at the library: an outside witness."""

import math
import re

# What YAML 1.1 resolves to a number; anything else unquoted is a word.
YAML_FLOAT = re.compile(r"[-+]?[0-9]+\.[0-9]*([eE][-+][0-9]+)?$")
YAML_INT = re.compile(r"[-+]?(0|[1-9][0-9]*)$")


def yaml_scalar(text):
    if text.startswith('"'):
        return text[1:-1]
    if YAML_FLOAT.match(text):
        return float(text)
    return int(text) if YAML_INT.match(text) else text


def read_yaml(text):
    """Nested block mappings of scalars and flow lists."""
    text = re.sub(r",\n\s*", ", ", text)
    root = {}
    stack = [(-1, root)]
    for line in text.splitlines():
        indent = len(line) - len(line.lstrip())
        key, _, value = line.strip().partition(":")
        value = value.strip()
        while stack[-1][0] >= indent:
            stack.pop()
        if not value:
            stack[-1][1][key] = {}
            stack.append((indent, stack[-1][1][key]))
        elif value.startswith("["):
            stack[-1][1][key] = [yaml_scalar(item.strip()) for item in value[1:-1].split(",")]
        else:
            stack[-1][1][key] = yaml_scalar(value)
    return root


def read_g2o_edge(line):
    """(i, j, position, quaternion x y z w, 6x6 information)."""
    words = line.split()
    assert words[0] == "EDGE_SE3:QUAT" and len(words) == 3 + 7 + 21, line
    numbers = list(map(float, words[3:]))
    information = [[0.0] * 6 for _ in range(6)]
    upper = iter(numbers[7:])
    for i in range(6):
        for k in range(i, 6):
            information[i][k] = information[k][i] = next(upper)
    return int(words[1]), int(words[2]), numbers[:3], numbers[3:7], information


def multiplied(p, q):
    """Hamilton product of x y z w."""
    x1, y1, z1, w1 = p
    x2, y2, z2, w2 = q
    return (
        w1 * x2 + x1 * w2 + y1 * z2 - z1 * y2,
        w1 * y2 - x1 * z2 + y1 * w2 + z1 * x2,
        w1 * z2 + x1 * y2 - y1 * x2 + z1 * w2,
        w1 * w2 - x1 * x2 - y1 * y2 - z1 * z2,
    )


def conjugate(q):
    return (-q[0], -q[1], -q[2], q[3])


def turned(q, v):
    return multiplied(multiplied(q, (*v, 0.0)), conjugate(q))[:3]


def quaternion_of(roll, pitch, yaw):
    about_x = (math.sin(roll / 2), 0, 0, math.cos(roll / 2))
    about_y = (0, math.sin(pitch / 2), 0, math.cos(pitch / 2))
    about_z = (0, 0, math.sin(yaw / 2), math.cos(yaw / 2))
    return multiplied(about_z, multiplied(about_y, about_x))


def rotation_vector(q):
    if q[3] < 0:
        q = tuple(-c for c in q)
    sine = math.sqrt(q[0] ** 2 + q[1] ** 2 + q[2] ** 2)
    factor = 2.0 if sine == 0 else 2 * math.atan2(sine, q[3]) / sine
    return [factor * c for c in q[:3]]


def cross(a, b):
    return [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]


def right_twist(mean, draw):
    """(v, w) with draw = mean exp(v, w); poses are x y z roll pitch yaw."""
    inverse = conjugate(quaternion_of(*mean[3:]))
    t = turned(inverse, [b - a for a, b in zip(mean[:3], draw[:3])])
    w = rotation_vector(multiplied(inverse, quaternion_of(*draw[3:])))
    angle = math.sqrt(sum(c * c for c in w))
    # v = t - w x t / 2 + c w x (w x t)
    c = 1 / 12
    if angle > 1e-2:
        c = 1 / angle**2 - (1 + math.cos(angle)) / (2 * angle * math.sin(angle))
    wt = cross(w, t)
    return [a - b / 2 + c * d for a, b, d in zip(t, wt, cross(w, wt))], w


def ros_error(mean, draw):
    """Shift in the target frame, rotation about its fixed axes."""
    rotation = multiplied(quaternion_of(*draw[3:]), conjugate(quaternion_of(*mean[3:])))
    return [b - a for a, b in zip(mean[:3], draw[:3])] + rotation_vector(rotation)


def g2o_error(mean, draw):
    """To first order: the twist with half angles."""
    v, w = right_twist(mean, draw)
    return [*v, *(c / 2 for c in w)]


def gtsam_error(mean, draw):
    """Pose3::Logmap: rotation first."""
    v, w = right_twist(mean, draw)
    return [*w, *v]


def parameter_error(mean, draw):
    errors = [b - a for a, b in zip(mean, draw)]
    return errors[:3] + [math.remainder(e, 2 * math.pi) for e in errors[3:]]


def second_moment(error, mean, draws):
    errors = [error(mean, draw) for draw in draws]
    return [
        [math.fsum(e[i] * e[k] for e in errors) / (len(errors) - 1) for k in range(6)]
        for i in range(6)
    ]


def product(a, b):
    return [[math.fsum(a[i][j] * b[j][k] for j in range(6)) for k in range(6)] for i in range(6)]
