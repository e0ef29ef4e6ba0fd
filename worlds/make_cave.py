#!/usr/bin/env python3
"""Draws cave.png, a cave of 16 x 16 m: four chambers around a hall, joined by passages, with walls of rough rock.
Also writes the four worlds with Pioneer robots in this cave: cave-simple, cave-complex, and both with -laser.

Discs are swept along lines, and their radius varies with smooth noise; the rock is all that the discs do not cover,
and some pillars.
Only + - * / and whole numbers are used, so that the picture is the same on every machine.
"""

import json
import os

from drawing import FLOOR, Bitmap

SIZE = 16
PIXELS_PER_M = 20

# Hollows: the two ends of a line, and the radius of the disc that is swept along the line, m.
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
# Rock inside the hollows, in the same form.
PILLARS = (
    ((11.9, 3.7), (12.4, 3.3), 0.5),
    ((12.4, 11.9), (13.0, 12.3), 0.5),
    ((3.6, 12.2), (4.0, 12.5), 0.45),
)


def lattice(i, j, salt):
    """Returns a pseudo-random number from -1 to 1 for a point of a lattice. salt: selects one of several lattices."""
    h = (i * 0x9E3779B1 ^ j * 0x85EBCA77 ^ salt * 0xC2B2AE3D) & 0xFFFFFFFF
    for shift, factor in ((16, 0x7FEB352D), (15, 0x846CA68B)):
        h = ((h ^ (h >> shift)) * factor) & 0xFFFFFFFF
    h ^= h >> 16
    return h / 0x7FFFFFFF - 1.0


def noise(x, y, salt):
    """Returns smooth noise from -1 to 1: the values of the lattice, interpolated with 3 t^2 - 2 t^3."""
    i, j = int(x), int(y)
    u, v = x - i, y - j
    u, v = u * u * (3 - 2 * u), v * v * (3 - 2 * v)
    low = lattice(i, j, salt) * (1 - u) + lattice(i + 1, j, salt) * u
    high = lattice(i, j + 1, salt) * (1 - u) + lattice(i + 1, j + 1, salt) * u
    return low * (1 - v) + high * v


def sweep(bitmap, line, rough, value_at):
    """Sets every pixel whose distance from the line is less than the radius plus the noise `rough` (m) at the pixel."""
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
    # A rim of rock on all four sides, so that the cave is closed for any noise.
    rim = bitmap.px(0.25)
    for py in range(bitmap.height):
        for px in range(bitmap.width):
            if min(px, py, bitmap.width - 1 - px, bitmap.height - 1 - py) < rim:
                bitmap.span(py, px, px + 1, rock(px, py))
    return bitmap


# --- the Pioneer, 0.44 x 0.38 x 0.22 m: the centre of its body is 0.04 m behind the point about which it turns ---

LENGTH, WIDTH, HEIGHT, SHIFT = 0.44, 0.38, 0.22, -0.04
SONAR_Z, SONAR_RANGE = 0.195, 5
# x, y (m) and heading (degrees) of the sixteen sonars, in the frame of the robot.
SONARS = (
    (0.075, 0.130, 90), (0.115, 0.115, 50), (0.150, 0.080, 30), (0.170, 0.025, 10),
    (0.170, -0.025, -10), (0.150, -0.080, -30), (0.115, -0.115, -50), (0.075, -0.130, -90),
    (-0.155, -0.130, -90), (-0.195, -0.115, -130), (-0.230, -0.080, -150), (-0.250, -0.025, -170),
    (-0.250, 0.025, 170), (-0.230, 0.080, 150), (-0.195, 0.115, 130), (-0.155, 0.130, 90),
)
# The laser is mounted on top of the robot; its rays pass over the bodies of other robots and meet their lasers.
LASER_Z, LASER_RANGE = 0.33, 8
LASER_SIZE = (0.156, 0.155, 0.19)


def mirrored(half):
    """Completes a symmetric outline from its half with y >= 0, given from front to back."""
    return half + [(x, -y) for x, y in reversed(half) if y > 0]


def box(x0, x1, y0, y1):
    return [(x0, y0), (x1, y0), (x1, y1), (x0, y1)]


def simple_pioneer():
    half = [(1, 0.47), (0.6, 1), (-0.6, 1), (-1, 0.47)]
    return [([(x * LENGTH / 2 + SHIFT, y * WIDTH / 2) for x, y in mirrored(half)], (0, HEIGHT))]


def complex_pioneer():
    """Hull, two sonar cases, two wheels, castor and lid, drawn relative to the axle and scaled to LENGTH and HEIGHT."""
    lid = [(1, 0.16), (0.96, 0.44), (0.86, 0.68), (0.7, 0.86), (0.46, 0.97), (0, 1)]
    lid += [(-x, y) for x, y in reversed(lid[:-1])]
    prisms = [
        (mirrored([(0.110, 0.105), (0.080, 0.135), (-0.185, 0.135), (-0.215, 0.105)]), (0.059, 0.234)),
        (mirrored([(-0.135, 0.136), (-0.185, 0.130), (-0.225, 0.100), (-0.250, 0.052), (-0.258, 0)]), (0.184, 0.234)),
        (mirrored([(0.168, 0), (0.160, 0.052), (0.136, 0.100), (0.096, 0.130), (0.046, 0.136)]), (0.184, 0.234)),
        (box(-0.083, 0.083, 0.140, 0.177), (0, 0.165)),
        (box(-0.083, 0.083, -0.177, -0.140), (0, 0.165)),
        (box(-0.2475, -0.1825, -0.012, 0.012), (0, 0.065)),
        (mirrored([(x * 0.219 - 0.045, y * 0.190) for x, y in lid]), (0.234, 0.240)),
    ]
    stretch, lift = LENGTH / 0.438, HEIGHT / 0.240
    return [([((x + 0.045) * stretch + SHIFT, y) for x, y in points], (low * lift, high * lift))
            for points, (low, high) in prisms]


def laser_body(boxes):
    x, y, top = LASER_SIZE[0] / 2, LASER_SIZE[1] / 2, HEIGHT + LASER_SIZE[2]
    if boxes == 1:
        return [(box(-x, x, -y, y), (HEIGHT, top))]
    return [(box(-x, x, -y, y), (HEIGHT, 0.25)),          # base
            (box(-x, -0.02, -y, y), (0.25, 0.37)),        # back
            (box(-0.02, 0.055, -0.055, 0.055), (0.25, 0.37)),  # head
            (box(-x, x, -y, y), (0.37, top))]             # top


def write_world(path, title, blocks, laser):
    def number(x):
        return int(x) if x == int(x) else round(x, 5)

    def line(indent, value):
        return " " * indent + json.dumps(value)

    bodies = ",\n".join(line(8, {"points_m": [[number(x), number(y)] for x, y in points],
                                 "z_m": [number(z) for z in heights]}) for points, heights in blocks)
    sonars = ",\n".join(line(10, {"pose": {"x_m": x, "y_m": y, "heading_deg": heading}, "range_max_m": SONAR_RANGE})
                        for x, y, heading in SONARS)
    sensors = f"""\
        {{"name": "sonar", "kind": "ranger", "pose": {{"z_m": {SONAR_Z}}}, "transducers": [
{sonars}
        ]}}"""
    if laser:
        sensors += f""",
        {{"name": "laser", "kind": "ranger", "pose": {{"z_m": {LASER_Z}}}, "transducers": [
          {{"range_max_m": {LASER_RANGE}, "fov_deg": 180, "samples": 180}}
        ]}}"""
    with open(path, "w", newline="\n") as file:
        file.write(f"""\
{{
  "troupe": 1,
  "title": "{title}",
  "quit_time_s": 60,
  "floorplans": [
    {{"name": "cave", "bitmap": "cave.png", "size_m": [{SIZE}, {SIZE}, 0.6], "color": "gray30",
     "obstacle": true, "ranger_return": 0.5}}
  ],
  "types": {{
    "pioneer": {{
      "blocks": [
{bodies}
      ],
      "drive": {{"kind": "diff", "velocity_min_x_mps": -0.5, "velocity_max_x_mps": 0.5,
                "turn_min_degps": -90, "turn_max_degps": 90}},
      "sensors": [
{sensors}
      ],
      "controller": {{"kind": "expand_pioneer"}}
    }}
  }},
  "populations": [
    {{"name": "p", "type": "pioneer", "count": 100, "color": "random",
     "place": {{"rule": "grid", "region_m": [[-7.2, -7.2], [7.4, -0.4]], "pitch_m": 0.66, "heading_deg": 0}}}}
  ]
}}
""")


if __name__ == "__main__":
    here = os.path.dirname(os.path.abspath(__file__))
    cave().write_png(os.path.join(here, "cave.png"))
    for name, body, boxes in (("simple", simple_pioneer(), 1), ("complex", complex_pioneer(), 4)):
        title = f"Pioneer robots of {'one prism' if name == 'simple' else 'seven prisms'} spread through a cave"
        write_world(os.path.join(here, f"cave-{name}.json"), title, body, False)
        write_world(os.path.join(here, f"cave-{name}-laser.json"), title + ", each with a laser",
                    body + laser_body(boxes), True)
