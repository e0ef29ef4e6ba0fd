#!/usr/bin/env python3
"""Writes perception.json: a floor of 20 x 20 tiles of 0.1 m, of which 136 are black and 264 white, and 20 robots that
decide together which colour is more frequent. This is the easy case (66 % white) of Valentini, Brambilla, Hamann and
Dorigo, Collective perception of environmental features in a robot swarm, ANTS 2016.
"""

import json
import os
import random

SIDE = 20         # tiles
TILE = 0.1        # m
BLACK = 136
HALF = SIDE * TILE / 2
WALL = 0.05

TYPES = {
    "wall": {"size_m": [2 * HALF + 2 * WALL, WALL, 0.1], "color": "gray30"},
    "side": {"size_m": [2 * HALF - 0.01, WALL, 0.1], "color": "gray30"},
    "black": {"size_m": [TILE, TILE, 0.002], "color": "black", "obstacle": False, "ranger_return": -1},
    "robot": {
        "blocks": [{"points_m": [[0.035, 0.015], [0.015, 0.035], [-0.015, 0.035], [-0.035, 0.015],
                                 [-0.035, -0.015], [-0.015, -0.035], [0.015, -0.035], [0.035, -0.015]], "z_m": [0.01, 0.06]}],
        "color": "SteelBlue",
        "drive": {"kind": "diff"},
        "sensors": [
            {"name": "eye", "kind": "ground"},
            {"name": "radio", "kind": "radio", "pose": {"z_m": 0.05}, "range_m": 0.5, "payload": 1},
            {"name": "ir", "kind": "ranger", "pose": {"z_m": 0.04}, "transducers": [{"range_max_m": 0.3, "fov_deg": 180, "samples": 9}]},
        ],
        "devices": [{"name": "lamp", "kind": "led", "shows": [0.5, 0.5, 0.5]}],
        "controller": {"kind": "collective_perception"},
    },
}


def world():
    tiles = [(column, row) for column in range(SIDE) for row in range(SIDE)]
    black = sorted(random.Random(1).sample(tiles, BLACK))
    edge = HALF + WALL / 2
    models = [{"name": "north", "type": "wall", "pose": {"y_m": edge}}, {"name": "south", "type": "wall", "pose": {"y_m": -edge}},
              {"name": "east", "type": "side", "pose": {"x_m": edge, "heading_deg": 90}},
              {"name": "west", "type": "side", "pose": {"x_m": -edge, "heading_deg": 90}}]
    for k, (column, row) in enumerate(black):
        place = {"x_m": round((column + 0.5) * TILE - HALF, 3), "y_m": round((row + 0.5) * TILE - HALF, 3)}
        models.append({"name": f"tile{k}", "type": "black", "pose": place})
    return {
        "troupe": 1,
        "title": "Perception: 20 robots decide whether more of the floor is black or white",
        "quit_time_s": 400,
        "types": TYPES,
        "models": models,
        "populations": [{"name": "r", "type": "robot", "count": 20,
                         "place": {"rule": "uniform", "region_m": [[-0.9, -0.9], [0.9, 0.9]]}}],
    }


def text(world):
    lines = ["{"]
    for key, value in world.items():
        if isinstance(value, (list, dict)):
            opening, closing = ("[", "]") if isinstance(value, list) else ("{", "}")
            items = ([json.dumps(item) for item in value] if isinstance(value, list) else
                     [f"{json.dumps(name)}: {json.dumps(item)}" for name, item in value.items()])
            lines.append(f'  "{key}": {opening}')
            lines += [f"    {item}," for item in items[:-1]] + [f"    {items[-1]}"]
            lines.append(f"  {closing},")
        else:
            lines.append(f"  {json.dumps(key)}: {json.dumps(value)},")
    lines[-1] = lines[-1].rstrip(",")
    return "\n".join(lines + ["}", ""])


if __name__ == "__main__":
    with open(os.path.join(os.path.dirname(os.path.abspath(__file__)), "perception.json"), "w") as file:
        file.write(text(world()))
