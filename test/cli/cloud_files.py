"""Point clouds in PCD and PLY files, written and read without PCL: an outside witness."""

import math
import random
import struct

# A field is (name, struct letter); "f" 32-bit float, "d" 64-bit float, "H" uint16, ...
XYZ = [("x", "f"), ("y", "f"), ("z", "f")]
PCD_TYPES = {"f": "F", "d": "F", "b": "I", "h": "I", "i": "I", "B": "U", "H": "U", "I": "U"}
PLY_TYPES = {"f": "float", "d": "double", "B": "uchar", "i": "int"}


def as_float32(number):
    return struct.unpack("<f", struct.pack("<f", number))[0]


def box_surface(num_points=300, seed=1):
    """Points on three sides of a 0.3 x 0.2 x 0.1 m box, exact in 32 bits."""
    generator = random.Random(seed)
    points = []
    for i in range(num_points):
        point = [generator.uniform(0, 0.3), generator.uniform(0, 0.2), generator.uniform(0, 0.1)]
        point[i % 3] = 0.0
        points.append(tuple(as_float32(number) for number in point))
    return points


def matrix_of(x, y, z, roll, pitch, yaw):
    """T_target_source with R = Rz(yaw) Ry(pitch) Rx(roll)."""
    cr, sr = math.cos(roll), math.sin(roll)
    cp, sp = math.cos(pitch), math.sin(pitch)
    cy, sy = math.cos(yaw), math.sin(yaw)
    return [
        [cy * cp, cy * sp * sr - sy * cr, cy * sp * cr + sy * sr, x],
        [sy * cp, sy * sp * sr + cy * cr, sy * sp * cr - cy * sr, y],
        [-sp, cp * sr, cp * cr, z],
        [0, 0, 0, 1],
    ]


def rotated(matrix, vector):
    return [sum(row[k] * vector[k] for k in range(3)) for row in matrix[:3]]


def moved(matrix, point):
    return [a + row[3] for a, row in zip(rotated(matrix, point), matrix)]


def inverse_moved(matrix, point):
    shifted = [point[k] - matrix[k][3] for k in range(3)]
    return [sum(matrix[i][k] * shifted[i] for i in range(3)) for k in range(3)]


def pcd_header(fields, num_points, encoding, height=1, viewpoint="0 0 0 1 0 0 0"):
    sizes = [struct.calcsize(letter) for _, letter in fields]
    return (
        "# .PCD v0.7 - Point Cloud Data file format\nVERSION 0.7\n"
        f"FIELDS {' '.join(name for name, _ in fields)}\n"
        f"SIZE {' '.join(map(str, sizes))}\n"
        f"TYPE {' '.join(PCD_TYPES[letter] for _, letter in fields)}\n"
        f"COUNT {' '.join('1' for _ in fields)}\n"
        f"WIDTH {num_points // height}\nHEIGHT {height}\nVIEWPOINT {viewpoint}\n"
        f"POINTS {num_points}\nDATA {encoding}\n"
    ).encode()


def pcd_bytes(points, fields=XYZ, encoding="binary", **header):
    """A PCD file; "binary_compressed" stores its bytes as LZF literals."""
    head = pcd_header(fields, len(points), encoding, **header)
    if encoding == "ascii":
        return head + b"".join(
            " ".join(repr(value) for value in point).encode() + b"\n" for point in points
        )
    layout = "<" + "".join(letter for _, letter in fields)
    if encoding == "binary":
        return head + b"".join(struct.pack(layout, *point) for point in points)
    body = b"".join(
        struct.pack(f"<{len(points)}{letter}", *(point[k] for point in points))
        for k, (_, letter) in enumerate(fields)
    )
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
        lines = [" ".join(repr(value) for value in point) for point in points]
        return (head + "\n".join(lines) + "\n3 0 1 2\n").encode()
    order = "<" if encoding == "binary_little_endian" else ">"
    layout = order + "".join(letter for _, letter in fields)
    body = b"".join(struct.pack(layout, *point) for point in points)
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


def numbers(row, *names):
    """Fields of a row of read_pcd() that are floats of 32 or 64 bits."""
    return [struct.unpack("<f" if len(row[name]) == 4 else "<d", row[name])[0] for name in names]


def read_pcd(path):
    """(header lines by key, list of {field: bytes} in the order of the points)."""
    with open(path, "rb") as file:
        content = file.read()
    header = {}
    at = 0
    while "DATA" not in header:
        end = content.index(b"\n", at)
        words = content[at:end].decode().split()
        header[words[0]] = words[1:]
        at = end + 1
    sizes = [int(s) * int(c) for s, c in zip(header["SIZE"], header["COUNT"])]
    fields = list(zip(header["FIELDS"], sizes))
    points = [{} for _ in range(int(header["POINTS"][0]))]
    body = content[at:]
    if header["DATA"] == ["binary"]:
        places = [(point, field) for point in points for field in fields]
    else:
        compressed_size, _ = struct.unpack_from("<II", body)
        body = lzf_decompressed(body[8 : 8 + compressed_size])
        places = [(point, field) for field in fields for point in points]
    at = 0
    for point, (name, size) in places:
        point[name] = body[at : at + size]
        at += size
    return header, points
