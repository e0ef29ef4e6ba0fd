#!/usr/bin/env python3
"""Measures environment steps per second of 8 robots with 12 beams on one core, for batches of 1 to 4,096 copies, and the
ticks per second of the world without an environment. One step is one tick.

    PYTHONPATH=build/release/lib/python3/dist-packages taskset -c 1 python3 perf/learning.py [COPIES...]

The world without an environment is one Simulation whose robots get the same speeds. A batch is measured with BatchEnv.step(),
including actions, observations, rewards and ends; copies whose episodes have ended are reset within the step. Each figure is
the median of five repetitions. The repetitions of the world and of the batches alternate, so that other load affects all of
them equally.
"""

import statistics
import sys
import time

import numpy as np
import troupe

BEAMS, ROBOTS = 12, 8


def world():
    wall = {"size_m": [0.1, 7.8, 0.5]}
    ring = {"range_max_m": 3, "fov_deg": 330, "samples": BEAMS}
    robot = {
        "size_m": [0.3, 0.3, 0.2],
        "drive": {"kind": "diff", "velocity_max_x_mps": 0.5},
        "sensors": [{"name": "lidar", "kind": "ranger", "pose": {"z_m": 0.1}, "transducers": [ring]}],
    }
    goal = {"size_m": [0.2, 0.2, 0.01], "obstacle": False, "ranger_return": -1}
    place = {"rule": "uniform", "region_m": [[-3.5, -3.5], [3.5, 3.5]]}
    walls = (("w", -4, 0, 0), ("e", 4, 0, 0), ("s", 0, -4, 90), ("n", 0, 4, 90))
    return {
        "troupe": 1,
        "types": {"wall": wall, "robot": robot, "goal": goal},
        "models": [
            {"name": name, "type": "wall", "pose": {"x_m": x, "y_m": y, "heading_deg": turn}} for name, x, y, turn in walls
        ],
        "populations": [
            {"name": name, "type": kind, "count": ROBOTS, "place": place} for name, kind in (("r", "robot"), ("goal", "goal"))
        ],
    }


def spec(copies):
    goal = {"of": "target", "name": "goal"}
    team = {
        "name": "robots",
        "robots": "r",
        "arrays": [
            {"name": "observation", "parts": [{"field": "ranges", "scale": 1 / 3}, goal, {"of": "speed"}]},
            {"name": "goal", "parts": [goal]},
        ],
        "actions": [{"command": "forward", "low": 0, "high": 0.5}, {"command": "turn", "low": -1.5, "high": 1.5}],
        "rewards": [{"array": "goal", "column": 2, "weight": -1, "change": True}],
        "ends": [{"array": "goal", "column": 2, "below": 0.3, "reward": 5}],
    }
    return {"copies": copies, "threads": 1, "seconds": 60, "teams": [team]}


def main(*sizes):
    random = np.random.default_rng(1)
    table = random.uniform(-1, 1, (64, ROBOTS, 2))
    alone = troupe.Simulation(world(), threads=1)
    swarm = alone.swarm("r")
    batches = {size: troupe.BatchEnv(alone, spec(size)) for size in sizes}
    for batch in batches.values():
        batch.reset()

    def ticks():
        """Measures ticks per second. Calls from Python cost little time: speeds change only every 64 ticks."""
        made, began = 0, time.perf_counter()
        while time.perf_counter() - began < 0.5:
            if made % 640 == 0:
                alone.reset(made)
            actions = table[made // 64 % 64]
            swarm.set_speeds(0.25 + 0.25 * actions[:, 0], 1.5 * actions[:, 1])
            alone.step(64)
            made += 64
        return made / (time.perf_counter() - began)

    def steps(batch):
        made, began = 0, time.perf_counter()
        while time.perf_counter() - began < 0.5:
            if made % 64 == 0:
                batch.actions()[...] = table[made // 64 % 64]
            batch.step(batch.over())
            made += 1
        return made * batch.copies / (time.perf_counter() - began)

    of_world, of_batch = [], {size: [] for size in sizes}
    for _ in range(5):
        of_world.append(ticks())
        for size, batch in batches.items():
            of_batch[size].append(steps(batch))
    base = statistics.median(of_world)
    print(f"the world alone: {base:,.0f} ticks/s")
    for size, rates in of_batch.items():
        rate = statistics.median(rates)
        print(f"{size:5} copies: {rate:9,.0f} environment steps/s, {rate / base:.2f}")
    best = max(map(statistics.median, of_batch.values()))
    print(f"best batch: {best / base:.2f} environment steps per tick of the world alone")


if __name__ == "__main__":
    main(*(map(int, sys.argv[1:]) if sys.argv[1:] else (1, 4, 16, 64, 256, 1024, 4096)))
