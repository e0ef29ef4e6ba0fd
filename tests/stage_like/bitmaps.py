#!/usr/bin/env python3
"""Draws the floor plans of the worlds in this folder, and computes the outlines of bitmaps with other algorithms than the
program.

  bitmaps.py FILE...   a line for each PNG or PGM: width and height in pixels, number of outlines, number of their
                       corners, and the bounding box of the solid pixels: left, right, top, bottom

bitmaps.txt holds these lines; readings.py writes it.
"""

import pathlib
import struct
import sys
import zlib


# The two floor plans. A pixel is solid (True) or free; row 0 is the uppermost.

def quarry():
    """Rock with caves: 100 x 70 pixels, with a free margin of 4, 3, 2 and 1 pixels (left, top, right, bottom)."""
    free = [(30, 24, 15), (47, 26, 9), (60, 20, 11), (72, 36, 14), (38, 46, 13), (22, 40, 10), (55, 48, 10), (84, 22, 7)]
    pillars = [(29, 24, 2), (63, 22, 2), (40, 49, 3), (77, 40, 2)]
    rows = []
    for y in range(70):
        row = []
        for x in range(100):
            cave = any((x - cx) ** 2 + (y - cy) ** 2 < r * r for cx, cy, r in free)
            pillar = any((x - cx) ** 2 + (y - cy) ** 2 < r * r for cx, cy, r in pillars)
            margin = x < 4 or y < 3 or x >= 98 or y >= 69
            row.append(not margin and (pillar or not cave))
        rows.append(row)
    for x, y in [(52, 22), (53, 23), (54, 22), (70, 30), (71, 31), (72, 32)]:  # pixels that touch only at corners
        rows[y][x] = True
    return rows


def yard():
    """A walled yard with sheds: 60 x 40 pixels without a margin."""
    rows = [[x in (0, 59) or y in (0, 39) for x in range(60)] for y in range(40)]
    for left, top, right, bottom in [(8, 6, 16, 12), (40, 5, 52, 9), (46, 26, 49, 34), (12, 28, 15, 31), (28, 17, 30, 19)]:
        for y in range(top, bottom):
            for x in range(left, right):
                rows[y][x] = True
    rows[34][49] = rows[25][45] = True  # pixels that touch a shed only at a corner
    return rows


def write_png(rows):
    """Returns the bytes of a greyscale PNG, 8 bits per pixel. Solid pixels have the greys 0 to 127, free pixels the others."""
    def chunk(kind, data):
        return struct.pack(">I", len(data)) + kind + data + struct.pack(">I", zlib.crc32(kind + data))

    lines = b"".join(
        b"\0" + bytes((0, 60, 127)[(x + y) % 3] if solid else (128, 200, 255)[(x + y) % 3] for x, solid in enumerate(row))
        for y, row in enumerate(rows))
    header = struct.pack(">IIBBBBB", len(rows[0]), len(rows), 8, 0, 0, 0, 0)
    return (b"\x89PNG\r\n\x1a\n" + chunk(b"IHDR", header) + chunk(b"IDAT", zlib.compress(lines, 9)) + chunk(b"IEND", b""))


def contours(rows):
    """Returns the outlines of the solid pixels as lists of pixel corners (x, y); y points down. An outline starts at its leftmost
    corner (of several, the uppermost), and has the solid pixels on its right. Where it could continue in two directions, it
    continues to the smaller (x, y). Corners in the middle of a straight line are omitted, except the first three."""
    def solid(x, y):
        return 0 <= y < len(rows) and 0 <= x < len(rows[0]) and rows[y][x]

    ways = {}  # from a corner to the corners that follow it
    for y, row in enumerate(rows):
        for x, here in enumerate(row):
            if not here:
                continue
            for neighbour, start, end in [((x, y - 1), (x, y), (x + 1, y)), ((x + 1, y), (x + 1, y), (x + 1, y + 1)),
                                          ((x, y + 1), (x + 1, y + 1), (x, y + 1)), ((x - 1, y), (x, y + 1), (x, y))]:
                if not solid(*neighbour):
                    ways.setdefault(start, []).append(end)
    outlines = []
    while ways:
        start = at = min(ways)
        outline = [start]
        while True:
            to = min(ways[at])
            ways[at].remove(to)
            if not ways[at]:
                del ways[at]
            if to == start:
                break
            if len(outline) >= 3:
                (ax, ay), (bx, by) = outline[-2:]
                if (bx - ax) * (to[1] - by) == (by - ay) * (to[0] - bx):
                    outline.pop()
            outline.append(to)
            at = to
        outlines.append(outline)
    return outlines


def read_png(data):
    """Returns the rows of a PNG (8 bits per channel, not interlaced) as lists: True for solid pixels, by the first channel."""
    at, header, packed = 8, None, b""
    while at < len(data):
        size, kind = struct.unpack_from(">I4s", data, at)
        body = data[at + 8:at + 8 + size]
        at += 12 + size
        if kind == b"IHDR":
            header = struct.unpack(">IIBBBBB", body)
        elif kind == b"IDAT":
            packed += body
    width, height, bits, color, _, _, interlaced = header
    if bits != 8 or interlaced or color == 3:
        raise ValueError(f"not a PNG that this reads: {bits} bits, colour type {color}")
    channels = {0: 1, 2: 3, 4: 2, 6: 4}[color]
    unpacked = zlib.decompress(packed)
    stride = width * channels
    before = bytearray(stride)
    rows = []
    for y in range(height):
        kind = unpacked[y * (stride + 1)]
        line = bytearray(unpacked[y * (stride + 1) + 1:(y + 1) * (stride + 1)])
        for i in range(stride):
            left = line[i - channels] if i >= channels else 0
            corner = before[i - channels] if i >= channels else 0
            guess = left + before[i] - corner
            paeth = min((left, before[i], corner), key=lambda near: abs(guess - near))
            line[i] = (line[i] + (0, left, before[i], (left + before[i]) // 2, paeth)[kind]) % 256
        rows.append([value <= 127 for value in line[::channels]])
        before = line
    return rows


def read_pgm(data):
    """Returns the rows of a PGM (P5, 8 bits, without comments) as lists: True for solid pixels."""
    kind, width, height, most, pixels = data.split(maxsplit=4) if data[:2] == b"P5" else [b""] * 5
    if kind != b"P5" or most != b"255" or len(pixels) != int(width) * int(height):
        raise ValueError("not a PGM that this reads")
    width = int(width)
    return [[value <= 127 for value in pixels[at:at + width]] for at in range(0, len(pixels), width)]


def counted(file):
    data = file.read_bytes()
    rows = read_png(data) if data[:4] == b"\x89PNG" else read_pgm(data)
    outlines = contours(rows)
    xs = [x for outline in outlines for x, _ in outline]
    ys = [y for outline in outlines for _, y in outline]
    return " ".join(map(str, (len(rows[0]), len(rows), len(outlines), len(xs), min(xs), max(xs), min(ys), max(ys))))


if __name__ == "__main__":
    for name in sys.argv[1:]:
        print(counted(pathlib.Path(name)))
