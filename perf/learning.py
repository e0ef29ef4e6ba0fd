#!/usr/bin/env python3
"""Measures how many environment steps per second Troupe makes on one core, for batches of 1 to 4,096 copies of a world with
8 robots that have lidars of 12 beams. One environment step is one tick of one copy. Also measures the ticks per second of
the same world without an environment for reinforcement learning.

    PYTHONPATH=build/release/lib/python3/dist-packages taskset -c 1 python3 perf/learning.py [COPIES...]

The world without an environment is one Simulation, whose robots get the same speed commands as those of the batches. A batch
is measured with BatchEnv.step() and with VectorEnv.step(). Both include actions, observations, rewards and ends of episodes,
and reset the copies whose episodes have ended. VectorEnv needs Gymnasium (pip install gymnasium) and is not measured without
it. Each figure is the median of five repetitions. The repetitions of the world and of the batches alternate, so that other
load on the machine affects all of them equally.
"""

import argparse
import pathlib
import statistics
import sys
import time


def copies_of(default=()):
    """Returns the numbers of copies in the arguments of the script, or `default` if there are none."""
    def number(text):
        if not text.isdecimal() or int(text) < 1:
            raise argparse.ArgumentTypeError(f"expected a number of copies of at least 1, found {text}")
        return int(text)

    script = sys.modules["__main__"]  # this one or learning_vmas.py
    parser = argparse.ArgumentParser(description=script.__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("copies", nargs="*", type=number, metavar="COPIES")
    return parser.parse_args().copies or default


try:
    import numpy as np
    import troupe
except ImportError as error:
    copies_of()  # --help and wrong arguments need no libraries
    sys.exit(f"{pathlib.Path(sys.argv[0]).name}: error: {error}; scripts/build release troupe_python builds the package troupe, and "
             "PYTHONPATH=build/release/lib/python3/dist-packages lets Debian's /usr/bin/python3 find it")

BEAMS, ROBOTS = 12, 8
EPISODE_S = 60
ACTIONS_KEPT = 64  # steps after which the actions change
GOAL = {"of": "target", "name": "goal"}
OBSERVATION = [{"field": "ranges", "scale": 1 / 3}, GOAL, {"of": "speed"}]
ACTIONS = [{"command": "forward", "low": 0, "high": 0.5}, {"command": "turn", "low": -1.5, "high": 1.5}]
REWARDS = [{"array": "goal", "column": 2, "weight": -1, "change": True}]
ENDS = [{"array": "goal", "column": 2, "below": 0.3, "reward": 5}]


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
    team = {
        "name": "robots",
        "robots": "r",
        "arrays": [{"name": "observation", "parts": OBSERVATION}, {"name": "goal", "parts": [GOAL]}],
        "actions": ACTIONS,
        "rewards": REWARDS,
        "ends": ENDS,
    }
    return {"copies": copies, "threads": 1, "seconds": EPISODE_S, "teams": [team]}


def vector_env(copies):
    """Returns a VectorEnv of the same task, or None if Gymnasium is not installed."""
    try:
        import troupe.envs
    except ImportError:
        return None
    task = troupe.envs.Task()
    task.world = world()
    task.seconds = EPISODE_S
    task.teams = [
        troupe.envs.Team(robots="r", observation=OBSERVATION, arrays={"goal": [GOAL]}, actions=ACTIONS, rewards=REWARDS, ends=ENDS)
    ]
    return troupe.envs.VectorEnv(task, copies * ROBOTS, threads=1)


def random_actions():
    """Returns random actions from -1 to 1, an array of 64 x robots x 2. Each of the 64 sets of actions is used in
    ACTIONS_KEPT successive steps."""
    return np.random.default_rng(1).uniform(-1, 1, (64, ROBOTS, 2)).astype(np.float32)


def rate(step, least_s=0.5):
    """Calls step(0), step(1), ... for at least least_s seconds, and returns the number of calls per second."""
    made, began = 0, time.perf_counter()
    while (passed := time.perf_counter() - began) < least_s:
        step(made)
        made += 1
    return made / passed


class Batched:
    """A BatchEnv whose robots get random actions."""

    def __init__(self, alone, copies):
        self.copies = copies
        self.batch = troupe.BatchEnv(alone, spec(copies))
        self.batch.reset()
        self.table = random_actions()

    def step(self, made):
        if made % ACTIONS_KEPT == 0:
            self.batch.actions()[...] = self.table[made // ACTIONS_KEPT % len(self.table)]
        self.batch.step(self.batch.over())


class Vectorised:
    """A VectorEnv whose robots get random actions."""

    def __init__(self, copies):
        self.copies = copies
        self.env = vector_env(copies)
        self.env.reset()
        self.table = np.tile(random_actions(), (1, copies, 1))

    def step(self, made):
        self.env.step(self.table[made // ACTIONS_KEPT % len(self.table)])


def main(*sizes):
    table = random_actions()
    alone = troupe.Simulation(world(), threads=1)
    swarm = alone.swarm("r")
    batches = {"BatchEnv": [Batched(alone, size) for size in sizes]}
    if vector_env(1) is None:
        print("VectorEnv is not measured, because Gymnasium is not installed: pip install gymnasium")
    else:
        batches["VectorEnv"] = [Vectorised(size) for size in sizes]

    def ticks(made):
        """Computes ACTIONS_KEPT ticks in one call of step(), so that the calls from Python take little time."""
        if made % 10 == 0:
            alone.reset(made)
        actions = table[made % len(table)]
        swarm.set_speeds(0.25 + 0.25 * actions[:, 0], 1.5 * actions[:, 1])
        alone.step(ACTIONS_KEPT)

    of_world, rates = [], {name: [[] for _ in sizes] for name in batches}
    for _ in range(5):
        of_world.append(ACTIONS_KEPT * rate(ticks))
        for name, measured in batches.items():
            for batch, found in zip(measured, rates[name]):
                found.append(batch.copies * rate(batch.step))
    base = statistics.median(of_world)
    print(f"the world alone: {base:,.0f} ticks/s")
    print("environment steps/s, and as a fraction of the ticks/s of the world alone:")
    print("copies" + "".join(f"{name:>20}" for name in rates))
    for at, size in enumerate(sizes):
        medians = [statistics.median(found[at]) for found in rates.values()]
        print(f"{size:6}" + "".join(f"{median:14,.0f}, {median / base:.2f}" for median in medians))
    for name, found in rates.items():
        print(f"best batch of {name}: {max(map(statistics.median, found)) / base:.2f} environment steps per tick of the world alone")


if __name__ == "__main__":
    main(*copies_of((1, 4, 16, 64, 256, 1024, 4096)))
