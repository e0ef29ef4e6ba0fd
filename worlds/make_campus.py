#!/usr/bin/env python3
"""Writes campus.json: a million minibots of 0.1 m in a campus of sixteen hospitals. Each hospital is that of
hospital-10cm.json, and its robots are placed in the same way. `troupe run --robots a=N --robots b=N ...` runs the
world with other numbers of robots; each hospital has one population, a to p.
"""

import os

from make_crowd import lay_out

COLUMNS, ROWS = 4, 4
LENGTH, DEPTH = 140, 60   # of a hospital, m
GAP = 10                  # between hospitals, m
ROBOTS = 1000000


def minibot():
    beams = [{"pose": {"heading_deg": 30 * i}, "range_max_m": 2, "fov_deg": 30, "samples": 1} for i in range(12)]
    return {"size_m": [0.1, 0.1, 0.1],
            "drive": {"kind": "diff", "velocity_min_x_mps": -1, "velocity_max_x_mps": 1,
                      "turn_min_degps": -90, "turn_max_degps": 90},
            "sensors": [{"name": "ir", "kind": "ranger", "pose": {"z_m": 0.06}, "transducers": beams}],
            "controller": {"kind": "expand_swarm"}}


def houses():
    """Yields the name and the centre (x, y, m) of each hospital."""
    for i in range(COLUMNS * ROWS):
        x = (LENGTH + GAP) * (i % COLUMNS - (COLUMNS - 1) / 2)
        y = (DEPTH + GAP) * (i // COLUMNS - (ROWS - 1) / 2)
        yield chr(ord("a") + i), x, y


def box(x, y, x0, y0, x1, y1):
    return [[round(x + x0, 6), round(y + y0, 6)], [round(x + x1, 6), round(y + y1, 6)]]


def campus():
    count = ROBOTS // (COLUMNS * ROWS)
    return {
        "troupe": 1,
        "title": "A million minibots disperse through sixteen hospitals",
        "quit_time_s": 60,
        "floorplans": [{"name": f"hospital_{name}", "bitmap": "hospital.png", "size_m": [LENGTH, DEPTH, 0.5],
                        "pose": {"x_m": x, "y_m": y}, "color": "gray30", "obstacle": True, "ranger_return": 0.5}
                       for name, x, y in houses()],
        "types": {"minibot": minibot()},
        "populations": [{"name": name, "type": "minibot", "count": count, "color": "random",
                         "place": {"rule": "grid", "region_m": box(x, y, -68, -22, 69, -18.35), "pitch_m": 0.2,
                                   "spill_m": box(x, y, -69.5, -29.5, 69.5, 29.5), "heading_deg": 0}}
                        for name, x, y in houses()],
    }


if __name__ == "__main__":
    path = os.path.join(os.path.dirname(os.path.abspath(__file__)), "campus.json")
    with open(path, "w", newline="\n") as file:
        file.write(lay_out(campus()) + "\n")
