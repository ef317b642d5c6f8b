"""Point clouds in PCD and PLY files, written and read without PCL: an outside witness."""

import math
import pathlib
import random
import struct

import numpy as np

# A field is (name, letter of NumPy's): "f" 32-bit float, "d" 64-bit float, "H" uint16, ...
XYZ = [("x", "f"), ("y", "f"), ("z", "f")]
PLY_TYPES = {"f": "float", "d": "double", "B": "uchar", "i": "int"}


def box_surface(num_points=300, seed=1):
    """Points on three sides of a 0.3 x 0.2 x 0.1 m box, exact in 32 bits."""
    generator = random.Random(seed)
    points = []
    for i in range(num_points):
        point = [generator.uniform(0, 0.3), generator.uniform(0, 0.2), generator.uniform(0, 0.1)]
        point[i % 3] = 0.0
        points.append(tuple(np.float32(point).tolist()))
    return points


def far_box(distance=50, seed=3):
    """One that has nothing to do with the others."""
    return [(x + distance, y, z) for x, y, z in box_surface(seed=seed)]


def matrix_of(x, y, z, roll, pitch, yaw):
    """T_target_source with R = Rz(yaw) Ry(pitch) Rx(roll)."""
    cr, sr = math.cos(roll), math.sin(roll)
    cp, sp = math.cos(pitch), math.sin(pitch)
    cy, sy = math.cos(yaw), math.sin(yaw)
    return np.array(
        [
            [cy * cp, cy * sp * sr - sy * cr, cy * sp * cr + sy * sr, x],
            [sy * cp, sy * sp * sr + cy * cr, sy * sp * cr - cy * sr, y],
            [-sp, cp * sr, cp * cr, z],
            [0, 0, 0, 1],
        ]
    )


def moved(matrix, points):
    """A point, or an array with a point in each row."""
    matrix = np.asarray(matrix)
    return points @ matrix[:3, :3].T + matrix[:3, 3]


def bytes_of(points, fields, order="<"):
    """An array of the points as they are in a binary file."""
    layout = ",".join(order + letter for _, letter in fields)
    return np.array([tuple(point) for point in points], layout)


def lines_of(points):
    return b"".join(" ".join(map(repr, point)).encode() + b"\n" for point in points)


def pcd_header(fields, num_points, encoding, height=1, viewpoint="0 0 0 1 0 0 0"):
    types = [np.dtype(letter) for _, letter in fields]
    return (
        "# .PCD v0.7 - Point Cloud Data file format\nVERSION 0.7\n"
        f"FIELDS {' '.join(name for name, _ in fields)}\n"
        f"SIZE {' '.join(str(each.itemsize) for each in types)}\n"
        f"TYPE {' '.join(each.kind.upper() for each in types)}\n"
        f"COUNT {' '.join('1' for _ in fields)}\n"
        f"WIDTH {num_points // height}\nHEIGHT {height}\nVIEWPOINT {viewpoint}\n"
        f"POINTS {num_points}\nDATA {encoding}\n"
    ).encode()


def pcd_bytes(points, fields=XYZ, encoding="binary", **header):
    """A PCD file; "binary_compressed" stores its bytes as LZF literals."""
    head = pcd_header(fields, len(points), encoding, **header)
    if encoding == "ascii":
        return head + lines_of(points)
    table = bytes_of(points, fields)
    if encoding == "binary":
        return head + table.tobytes()
    body = b"".join(table[name].tobytes() for name in table.dtype.names)
    literals = b"".join(
        bytes([len(body[i : i + 32]) - 1]) + body[i : i + 32] for i in range(0, len(body), 32)
    )
    return head + struct.pack("<II", len(literals), len(body)) + literals


def ply_bytes(points, fields=XYZ, encoding="ascii"):
    """A PLY file with one face after the points."""
    head = f"ply\nformat {encoding} 1.0\ncomment made by a test\nelement vertex {len(points)}\n"
    head += "".join(f"property {PLY_TYPES[letter]} {name}\n" for name, letter in fields)
    head += "element face 1\nproperty list uchar int vertex_indices\nend_header\n"
    if encoding == "ascii":
        return head.encode() + lines_of(points) + b"3 0 1 2\n"
    order = "<" if encoding == "binary_little_endian" else ">"
    body = bytes_of(points, fields, order).tobytes()
    return head.encode() + body + struct.pack(order + "B3i", 3, 0, 1, 2)


def lzf_decompressed(data):
    """LZF as in liblzf: literals, and copies of what is already there."""
    out = bytearray()
    at = 0
    while at < len(data):
        control = data[at]
        at += 1
        if control < 32:
            out += data[at : at + control + 1]
            at += control + 1
            continue
        length = control >> 5
        if length == 7:
            length += data[at]
            at += 1
        start = len(out) - ((control & 31) << 8) - data[at] - 1
        at += 1
        for i in range(length + 2):
            out.append(out[start + i])
    return bytes(out)


def read_pcd(path):
    """(header lines by key, array of the points by their fields)."""
    head, _, rest = pathlib.Path(path).read_bytes().partition(b"\nDATA ")
    encoding, _, body = rest.partition(b"\n")
    header = {words[0]: words[1:] for words in map(str.split, head.decode().splitlines())}
    header["DATA"] = [encoding.decode()]
    types = [f"<{kind.lower()}{size}" for kind, size in zip(header["TYPE"], header["SIZE"])]
    points = np.zeros(int(header["POINTS"][0]), list(zip(header["FIELDS"], types)))
    if header["DATA"] == ["binary"]:
        return header, np.frombuffer(body, points.dtype)
    compressed_size, _ = struct.unpack_from("<II", body)
    body = lzf_decompressed(body[8 : 8 + compressed_size])
    at = 0
    for name in points.dtype.names:
        column = points[name]
        column[:] = np.frombuffer(body, column.dtype, len(points), at)
        at += column.nbytes
    return header, points


def columns(points, *names):
    """Fields of read_pcd(), a point in each row."""
    return np.column_stack([points[name] for name in names]).astype(float)


def read_xyz(path):
    return columns(read_pcd(path)[1], *"xyz")
