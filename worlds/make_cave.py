#!/usr/bin/env python3
"""Draws cave.png, a cave of 16 x 16 m: four chambers round a hall, joined by passages, all walls of rough rock.

The rock is what remains when discs are swept along lines and their radius swells and shrinks with smooth noise.
Only + - * / and whole numbers are used, so that the picture is the same on every machine.
"""

import os

from drawing import FLOOR, Bitmap

SIZE = 16
PIXELS_PER_M = 20

# Hollows: ends of a line and the radius swept along it, metres.
HOLLOWS = (
    ((3.6, 3.6), (4.6, 4.4), 3.3),     # the corner where robots start
    ((11.8, 3.5), (12.6, 4.2), 2.75),
    ((12.3, 11.6), (12.2, 12.4), 3.0),
    ((3.6, 11.8), (4.2, 12.4), 2.9),
    ((7.6, 8.0), (8.6, 8.2), 2.2),
    ((4.0, 2.9), (12.0, 3.2), 1.6),
    ((3.0, 4.0), (3.2, 12.0), 1.5),
    ((4.5, 4.5), (8.0, 8.0), 1.5),
    ((8.5, 7.8), (12.2, 4.2), 1.1),
    ((8.5, 8.4), (12.0, 12.0), 1.2),
    ((7.4, 8.6), (4.2, 12.0), 1.1),
    ((4.2, 12.8), (12.0, 13.1), 1.15),
    ((13.4, 4.0), (13.3, 12.0), 1.1),
)
# Rock left standing in them.
PILLARS = (
    ((11.9, 3.7), (12.4, 3.3), 0.5),
    ((12.4, 11.9), (13.0, 12.3), 0.5),
    ((3.6, 12.2), (4.0, 12.5), 0.45),
)


def lattice(i, j, salt):
    """A number from -1 to 1 for each point of a lattice."""
    h = (i * 0x9E3779B1 ^ j * 0x85EBCA77 ^ salt * 0xC2B2AE3D) & 0xFFFFFFFF
    for shift, factor in ((16, 0x7FEB352D), (15, 0x846CA68B)):
        h = ((h ^ (h >> shift)) * factor) & 0xFFFFFFFF
    h ^= h >> 16
    return h / 0x7FFFFFFF - 1.0


def noise(x, y, salt):
    """Smooth in between: the lattice blended with 3 t^2 - 2 t^3."""
    i, j = int(x), int(y)
    u, v = x - i, y - j
    u, v = u * u * (3 - 2 * u), v * v * (3 - 2 * v)
    low = lattice(i, j, salt) * (1 - u) + lattice(i + 1, j, salt) * u
    high = lattice(i, j + 1, salt) * (1 - u) + lattice(i + 1, j + 1, salt) * u
    return low * (1 - v) + high * v


def sweep(bitmap, line, rough, value_at):
    """Sets every pixel nearer to the line than its radius, as the noise changes it."""
    (ax, ay), (bx, by), radius = line
    dx, dy = bx - ax, by - ay
    reach, length2 = radius + 0.6, dx * dx + dy * dy
    for py in range(max(bitmap.px(min(ay, by) - reach), 0), min(bitmap.px(max(ay, by) + reach), bitmap.height)):
        y = (py + 0.5) / bitmap.scale
        for px in range(max(bitmap.px(min(ax, bx) - reach), 0), min(bitmap.px(max(ax, bx) + reach), bitmap.width)):
            x = (px + 0.5) / bitmap.scale
            t = ((x - ax) * dx + (y - ay) * dy) / length2
            t = 0.0 if t < 0 else 1.0 if t > 1 else t
            ex, ey = x - ax - t * dx, y - ay - t * dy
            r = radius + rough[py][px]
            if r > 0 and ex * ex + ey * ey < r * r:
                bitmap.span(py, px, px + 1, value_at(px, py))


def cave():
    bitmap = Bitmap(SIZE, SIZE, PIXELS_PER_M, 0)
    rough, grain = [], []
    for py in range(bitmap.height):
        y = (py + 0.5) / PIXELS_PER_M
        row = [(px + 0.5) / PIXELS_PER_M for px in range(bitmap.width)]
        rough.append([0.26 * noise(x * 0.9, y * 0.9, 1) + 0.12 * noise(x * 2.4, y * 2.4, 2) for x in row])
        grain.append([58 + int(34 * noise(x * 1.6, y * 1.6, 3)) for x in row])

    def rock(px, py):
        return grain[py][px]

    for py in range(bitmap.height):
        for px in range(bitmap.width):
            bitmap.span(py, px, px + 1, rock(px, py))
    for line in HOLLOWS:
        sweep(bitmap, line, rough, lambda px, py: FLOOR)
    for line in PILLARS:
        sweep(bitmap, line, rough, rock)
    # A rim of rock all round, however the noise fell.
    rim = bitmap.px(0.25)
    for py in range(bitmap.height):
        for px in range(bitmap.width):
            if min(px, py, bitmap.width - 1 - px, bitmap.height - 1 - py) < rim:
                bitmap.span(py, px, px + 1, rock(px, py))
    return bitmap


if __name__ == "__main__":
    here = os.path.dirname(os.path.abspath(__file__))
    cave().write_png(os.path.join(here, "cave.png"))
