#!/usr/bin/env python3
"""Writes crowd.json: a dense crowd of different robots in a walled yard with pillars. It tests that conflicts between
motions are resolved in the same way with any number of threads. There are small boxes and long planks, bodies of
several blocks, canopies under which flat crawlers pass, robots of 2 m/s, and every kind of drive. All robots drive up
close to obstacles, so that many motions are blocked.
"""

import json
import os

HALF = 7.5      # inner half width of the yard, m
WALL = 0.3
PILLARS = ((-4.5, -4.5), (4.5, -4.5), (-4.5, 4.5), (4.5, 4.5), (0, 0), (-4.5, 0.6), (4.5, -0.6), (0.6, 4.5),
           (-0.6, -4.5))
OCTAGON = ((0.35, 0.145), (0.145, 0.35), (-0.145, 0.35), (-0.35, 0.145),
           (-0.35, -0.145), (-0.145, -0.35), (0.145, -0.35), (0.35, -0.145))
DODECAGON = ((0.2, 0), (0.173, 0.1), (0.1, 0.173), (0, 0.2), (-0.1, 0.173), (-0.173, 0.1),
             (-0.2, 0), (-0.173, -0.1), (-0.1, -0.173), (0, -0.2), (0.1, -0.173), (0.173, -0.1))


def block(points, low, high):
    return {"points_m": [list(p) for p in points], "z_m": [low, high]}


def box(x0, y0, x1, y1, low, high):
    return block(((x0, y0), (x1, y0), (x1, y1), (x0, y1)), low, high)


def ring(z, beams=8, reach=1.5):
    return [{"name": "ring", "kind": "ranger", "pose": {"z_m": z}, "transducers":
             [{"pose": {"heading_deg": i * 360 // beams}, "range_max_m": reach} for i in range(beams)]}]


def scanner(z, samples, fov, reach):
    return [{"name": "scanner", "kind": "ranger", "pose": {"z_m": z}, "transducers":
             [{"range_max_m": reach, "fov_deg": fov, "samples": samples}]}]


def drive(kind, speed, turn, **more):
    return {"kind": kind, "velocity_min_x_mps": -speed, "velocity_max_x_mps": speed,
            "turn_min_degps": -turn, "turn_max_degps": turn, **more}


def expand(speed, clearance, cone=60):
    return {"kind": "expand", "speed_mps": speed, "clearance_m": clearance, "cone_deg": cone}


def wander(cruise, min_front=0.5):
    return {"kind": "wander", "cruise_speed_mps": cruise, "avoid_speed_mps": 0.2, "avoid_turn_radps": 1.5,
            "min_front_m": min_front, "stop_m": 0.3}


TYPES = {
    "long_wall": {"size_m": [2 * HALF + 2 * WALL, WALL, 0.5], "color": "gray30"},
    "side_wall": {"size_m": [WALL, 2 * HALF, 0.5], "color": "gray30"},
    "pillar": {"blocks": [block(OCTAGON, 0, 0.5)], "color": "gray30"},
    "crumb": {"size_m": [0.12, 0.12, 0.15], "color": "gold", "drive": drive("diff", 2, 180),
              "sensors": ring(0.1), "controller": expand(2, 0.25)},
    "brick": {"size_m": [0.3, 0.2, 0.2], "color": "red", "drive": drive("diff", 1, 120),
              "sensors": ring(0.1), "controller": expand(0.6, 0.35, 40)},
    "plank": {"size_m": [0.75, 0.1, 0.25], "color": "wheat", "drive": drive("diff", 1, 180),
              "sensors": ring(0.2, 12), "controller": expand(0.8, 0.7, 45)},
    "ell": {"blocks": [box(-0.2, -0.2, 0.2, -0.05, 0, 0.2), box(-0.2, -0.05, -0.05, 0.25, 0, 0.3)], "color": "orange",
            "drive": drive("diff", 1, 90), "sensors": ring(0.1), "controller": expand(0.7, 0.5, 40)},
    "plus": {"blocks": [box(-0.25, -0.07, 0.25, 0.07, 0, 0.2), box(-0.07, -0.25, 0.07, 0.25, 0, 0.2)], "color": "green",
             "drive": drive("omni", 1.5, 120), "sensors": scanner(0.15, 12, 270, 2), "controller": wander(1.2)},
    "disc": {"blocks": [block(DODECAGON, 0, 0.2)], "color": "cyan", "drive": drive("omni", 1, 90),
             "sensors": ring(0.1), "controller": expand(0.9, 0.4)},
    "cart": {"size_m": [0.45, 0.25, 0.25], "color": "violet", "drive": drive("car", 2, 120, wheelbase_m=0.3),
             "sensors": scanner(0.2, 24, 180, 2.5), "controller": wander(2, 0.7)},
    "crawler": {"size_m": [0.25, 0.18, 0.08], "color": "blue", "drive": drive("diff", 1.5, 180),
                "sensors": ring(0.05), "controller": expand(1.5, 0.35)},
    "canopy": {"blocks": [block([(2.5 * x, 2.5 * y) for x, y in DODECAGON[::2]], 0.32, 0.4),
                          box(-0.06, -0.06, 0.06, 0.06, 0, 0.32)],
               "color": "magenta", "drive": drive("diff", 0.5, 60), "sensors": ring(0.36, 8, 2),
               "controller": expand(0.4, 0.6)},
}
COUNTS = (("canopy", 12), ("plank", 35), ("cart", 35), ("plus", 40), ("ell", 35), ("disc", 45), ("brick", 60),
          ("crawler", 50), ("crumb", 88))


def models():
    out = []
    edge = HALF + WALL / 2
    for name, kind, x, y in (("south", "long_wall", 0, -edge), ("north", "long_wall", 0, edge),
                             ("west", "side_wall", -edge, 0), ("east", "side_wall", edge, 0)):
        out.append({"name": name, "type": kind, "pose": {"x_m": x, "y_m": y}})
    for i, (x, y) in enumerate(PILLARS):
        out.append({"name": f"pillar{i}", "type": "pillar", "pose": {"x_m": x, "y_m": y, "heading_deg": 7 * i}})
    return out


def populations():
    reach = HALF - 0.1
    return [{"name": name, "type": name, "count": count,
             "place": {"rule": "uniform", "region_m": [[-reach, -reach], [reach, reach]], "heading": "random"}}
            for name, count in COUNTS]


def lay_out(value, indent=0, width=112):
    """Returns JSON text. A list or object is on one line if it fits into `width` columns, else it has one line per
    member. Lists of lists (points) are always on one line."""
    flat = json.dumps(value)
    numbers = isinstance(value, list) and all(isinstance(v, list) for v in value)
    if indent + len(flat) <= width or numbers or not isinstance(value, (list, dict)):
        return flat
    pad = " " * (indent + 2)
    if isinstance(value, dict):
        parts = [f"{pad}{json.dumps(k)}: {lay_out(v, indent + 2, width)}" for k, v in value.items()]
        return "{\n" + ",\n".join(parts) + "\n" + " " * indent + "}"
    return "[\n" + ",\n".join(pad + lay_out(v, indent + 2, width) for v in value) + "\n" + " " * indent + "]"


if __name__ == "__main__":
    world = {"troupe": 1, "title": "A crowd of robots of different types", "quit_time_s": 30, "types": TYPES,
             "models": models(), "populations": populations()}
    with open(os.path.join(os.path.dirname(os.path.abspath(__file__)), "crowd.json"), "w", newline="\n") as file:
        file.write(lay_out(world) + "\n")
