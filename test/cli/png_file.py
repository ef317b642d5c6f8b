"""PNG files of 8 bits a channel, read without a library."""

import struct
import zlib


def unfiltered(kind, line, above, bytes_per_pixel):
    """One line of a PNG with its filter undone (RFC 2083, section 6)."""
    line = bytearray(line)
    if kind == 2:
        return bytearray((a + b) & 0xFF for a, b in zip(line, above))
    for i, value in enumerate(line):
        left = line[i - bytes_per_pixel] if i >= bytes_per_pixel else 0
        up = above[i]
        corner = above[i - bytes_per_pixel] if i >= bytes_per_pixel else 0
        if kind == 1:
            guess = left
        elif kind == 3:
            guess = (left + up) // 2
        elif kind == 4:
            nearest = left + up - corner
            guess = min((left, up, corner), key=lambda c: abs(nearest - c))
        else:
            return line
        line[i] = (value + guess) & 0xFF
    return line


def read_png(content):
    """(width, height, rows): each row the bytes of its pixels, three a pixel."""
    if not content.startswith(b"\x89PNG\r\n\x1a\n") or content[-8:-4] != b"IEND":
        raise ValueError("no complete PNG")
    position, data = 8, b""
    while position < len(content):
        size, kind = struct.unpack(">I4s", content[position : position + 8])
        chunk = content[position + 8 : position + 8 + size]
        if kind == b"IHDR":
            width, height, depth, colours, _, _, interlace = struct.unpack(">IIBBBBB", chunk)
        elif kind == b"IDAT":
            data += chunk
        position += size + 12
    if depth != 8 or colours not in (2, 6) or interlace:
        raise ValueError("a PNG of another kind")
    bytes_per_pixel = 3 if colours == 2 else 4
    stride = width * bytes_per_pixel
    data = zlib.decompress(data)
    rows, above = [], bytearray(stride)
    for y in range(height):
        start = y * (stride + 1)
        above = unfiltered(data[start], data[start + 1 : start + 1 + stride], above, bytes_per_pixel)
        row = above
        if bytes_per_pixel == 4:
            row = bytearray(stride // 4 * 3)
            for c in range(3):
                row[c::3] = above[c::4]
        rows.append(bytes(row))
    return width, height, rows
