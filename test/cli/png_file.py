"""Reads PNG files of 8 bits a channel without transparency, with nothing but zlib."""

import struct
import zlib


def _unfiltered(kind, line, above, step):
    """One row of bytes, PNG specification section 9.2."""
    row = bytearray(line)
    for i, value in enumerate(row):
        left = row[i - step] if i >= step else 0
        up = above[i]
        corner = above[i - step] if i >= step else 0
        if kind == 0:
            predicted = 0
        elif kind == 1:
            predicted = left
        elif kind == 2:
            predicted = up
        elif kind == 3:
            predicted = (left + up) // 2
        else:
            estimate = left + up - corner
            distances = [abs(estimate - near) for near in (left, up, corner)]
            predicted = (left, up, corner)[distances.index(min(distances))]
        row[i] = (value + predicted) & 0xFF
    return row


def read_png(path):
    """(width, height, rows of (red, green, blue)); raises ValueError for other files."""
    data = path.read_bytes()
    if data[:8] != b"\x89PNG\r\n\x1a\n":
        raise ValueError(f"{path} is no PNG file")
    packed, position, kinds = b"", 8, []
    while position < len(data):
        length, kind = struct.unpack(">I4s", data[position : position + 8])
        content = data[position + 8 : position + 8 + length]
        (checksum,) = struct.unpack(">I", data[position + 8 + length : position + 12 + length])
        if checksum != zlib.crc32(kind + content):
            raise ValueError(f"{path}: broken {kind}")
        kinds.append(kind)
        if kind == b"IHDR":
            width, height, depth, color_type, _, _, interlace = struct.unpack(">IIBBBBB", content)
        if kind == b"IDAT":
            packed += content
        position += 12 + length
    if kinds[-1] != b"IEND" or (depth, color_type, interlace) != (8, 2, 0):
        raise ValueError(f"{path}: unexpected kind of PNG file")
    raw, size, rows, above = zlib.decompress(packed), 3 * width, [], bytes(3 * width)
    for y in range(height):
        start = y * (size + 1)
        above = _unfiltered(raw[start], raw[start + 1 : start + 1 + size], above, 3)
        rows.append([tuple(above[x : x + 3]) for x in range(0, size, 3)])
    return width, height, rows
