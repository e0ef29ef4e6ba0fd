#!/usr/bin/env python3
"""Checks the floor plans and the worlds that the make_*.py scripts write: that the scripts still write the files in this
folder, that the numbers of contour edges of the plans are in the intended ranges, that their outer walls are closed,
and that robots can reach the whole floor. Exit code 1 if a check fails.
"""

import os
import shutil
import subprocess
import sys
import tempfile
import zlib

import make_cave
import make_hospital

HERE = os.path.dirname(os.path.abspath(__file__))
SCRIPTS = sorted(name for name in os.listdir(HERE) if name.startswith("make_") and name.endswith(".py"))
DARK = bytes(ord("1" if value <= 127 else "0") for value in range(256))


def solid_rows(bitmap):
    """Returns each row, from the top, as a whole number with one bit per pixel; 1: solid."""
    return [int(row.translate(DARK), 2) for row in bitmap.rows]


def count_edges(rows):
    """Returns the number of edges of the contours, with collinear edges merged. It equals the number of corners: a
    point between four pixels is one corner if one or three of the pixels are solid, and two corners if exactly two
    diagonally opposite pixels are solid."""
    corners = 0
    rows = [0] + [row << 1 for row in rows] + [0]
    for above, below in zip(rows, rows[1:]):
        left_above, left_below = above >> 1, below >> 1
        corners += (above ^ below ^ left_above ^ left_below).bit_count()
        corners += 2 * ((above ^ left_above) & (below ^ left_below) & (above ^ below)).bit_count()
    return corners


def standing_room(rows, width, pixels):
    """Returns the pixels at which the upper left corner of a square robot can be while the robot overlaps no solid
    pixel: a whole number per row from the top, with one bit per pixel. pixels: side of the robot, pixels."""
    whole = (1 << width) - 1

    def shrink(free, reach):
        for _ in range(reach - 1):
            free &= free << 1
        return free & whole

    free = [shrink(whole & ~row, pixels) for row in rows]
    room = []
    for top in range(len(rows) - pixels + 1):
        row = whole
        for other in free[top:top + pixels]:
            row &= other
        room.append(row)
    return room


def along(row, seed):
    """Returns the runs of 1 bits of a row that contain a bit of the seed. The span doubles in each step, so that a run
    of thousands of pixels takes a dozen steps."""
    left = right = row
    span = 1
    while span < row.bit_length():
        seed |= (seed << span & left) | (seed >> span & right)
        left &= left << span
        right &= right >> span
        span *= 2
    return seed


def unreached(room):
    """Returns, for each row of the room, the bits that cannot be reached from a pixel of the row with the most bits."""
    start = max(range(len(room)), key=lambda i: room[i].bit_count())
    reached = [0] * len(room)
    lowest = room[start] & -room[start]
    reached[start] = along(room[start], lowest)
    changed = True
    while changed:
        changed = False
        for order in (range(1, len(room)), range(len(room) - 2, -1, -1)):
            for i in order:
                seed = reached[i] | (reached[i - 1 if order.step > 0 else i + 1] & room[i])
                if seed != reached[i]:
                    reached[i] = along(room[i], seed)
                    changed = True
    return [room[i] & ~reached[i] for i in range(len(room))]


def check(name, bitmap, edges, robot_m, pockets_m2):
    """Returns the faults of a plan. edges: least and greatest number of contour edges; robot_m: side of a square
    robot, m; pockets_m2: greatest allowed area that this robot cannot reach, m2."""
    rows = solid_rows(bitmap)
    whole = (1 << bitmap.width) - 1
    sides = 1 | 1 << (bitmap.width - 1)
    faults = []
    if rows[0] != whole or rows[-1] != whole or any(row & sides != sides for row in rows):
        faults.append("the outer wall is open")
    count = count_edges(rows)
    if not edges[0] <= count <= edges[1]:
        faults.append(f"{count} contour edges, not {edges[0]} to {edges[1]}")
    room = standing_room(rows, bitmap.width, bitmap.px(robot_m))
    lost = sum(row.bit_count() for row in unreached(room)) / bitmap.scale ** 2
    if lost > pockets_m2:
        faults.append(f"{lost:.2f} m2 are out of reach for a robot of {robot_m} m")
    floor = sum(bitmap.width - row.bit_count() for row in rows) / bitmap.scale ** 2
    print(f"{name}: {count} contour edges, {floor:.0f} m2 of floor, {lost:.2f} m2 out of reach")
    return [f"{name}: {fault}" for fault in faults]


def content(data):
    """Returns the content to compare: of a PNG, its header and uncompressed pixels, because versions of zlib compress
    differently; of other files, all bytes."""
    if not data.startswith(b"\x89PNG"):
        return data
    at, packed = 8, b""
    while at < len(data):
        size = int.from_bytes(data[at:at + 4], "big")
        if data[at + 4:at + 8] == b"IDAT":
            packed += data[at + 8:at + 8 + size]
        at += 12 + size
    return data[16:29] + zlib.decompress(packed)


def redrawn():
    """Runs the scripts in a temporary folder, and yields the faults of files that differ from those in this folder."""
    with tempfile.TemporaryDirectory() as folder:
        for script in (*SCRIPTS, "drawing.py"):
            shutil.copy(os.path.join(HERE, script), folder)
        for script in SCRIPTS:
            subprocess.run([sys.executable, script], cwd=folder, check=True)
        for name in sorted(name for name in os.listdir(folder) if name.endswith((".png", ".json"))):
            if not os.path.exists(os.path.join(HERE, name)):
                yield f"{name}: the file is missing; a make_*.py script writes it"
                continue
            with open(os.path.join(HERE, name), "rb") as ours, open(os.path.join(folder, name), "rb") as new:
                if content(ours.read()) != content(new.read()):
                    yield f"{name}: the file differs from what its make_*.py script writes: run the script again"


if __name__ == "__main__":
    # Small areas behind rows of chairs may be out of reach.
    found = [*check("hospital", make_hospital.hospital(), (14000, 18000), 0.25, 2.5),
             *check("cave", make_cave.cave(), (700, 1500), 0.5, 0.0), *redrawn()]
    for fault in found:
        print(fault, file=sys.stderr)
    sys.exit(1 if found else 0)
