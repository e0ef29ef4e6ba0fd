#!/usr/bin/env python3
"""Two thousand robots disperse through a hospital, driven by the controller `expand_swarm`, rewritten in NumPy.

    python3 python/examples/disperse.py [WORLD [SECONDS]]

For comparison, a second simulation runs the same world with its controller in C++. The states of the two simulations
are bit-identical at every tick.
"""

import json
import sys
import time

import numpy as np
import troupe

# The robot drives only if the range of each of its twelve beams exceeds this threshold, m; -1: no threshold.
CLEARANCES = np.array([0.5, 0.5 / 1.5, 0.5 / 3, 0.5 / 5, -1, -1, -1, -1, -1, 0.5 / 5, 0.5 / 3, 0.5 / 1.5])


def disperse(swarm, directions):
    """Turns each robot towards the vector sum of its ranges, and drives it forward while the way ahead is clear."""
    sin, cos = directions
    ranges = swarm.ranges()
    x = troupe.math.ordered_sum(ranges * cos)
    y = troupe.math.ordered_sum(ranges * sin)
    turn = troupe.math.atan2(y, x)
    is_clear = (ranges > CLEARANCES).all(axis=1) & (np.abs(turn) < 0.5)
    swarm.set_speeds(np.where(is_clear, 0.3, 0.0), turn, where=(x != 0) & (y != 0))


def load(file, **options):
    """Loads a world file without the controllers of its robots."""
    with open(file) as text:
        world = json.load(text)
    for kind in world["types"].values():
        kind.pop("controller", None)
    return troupe.Simulation(world, name=file, **options)


def main(file="worlds/hospital.json", seconds="10"):
    ours = load(file)
    theirs = troupe.Simulation(file)
    swarm = ours.swarm()
    directions = troupe.math.sincos(swarm.bearings())
    seconds_of = {"NumPy": 0.0, "C++": 0.0}
    while ours.time_s < float(seconds):
        begin = time.process_time()
        ours.step()
        disperse(swarm, directions)
        between = time.process_time()
        theirs.step()
        seconds_of["NumPy"] += between - begin
        seconds_of["C++"] += time.process_time() - between
        if ours.state_hash() != theirs.state_hash():
            sys.exit(f"tick {ours.tick}: {ours.hashes()}\nand in C++: {theirs.hashes()}")
    print(f"{len(swarm)} robots, {ours.tick} ticks, state {ours.state_hash():016x} in both simulations")
    for name, taken in seconds_of.items():
        print(f"{name:5} {taken / ours.tick * 1e3:6.2f} ms of processor time per tick")
    print(f"ratio NumPy / C++ {seconds_of['NumPy'] / seconds_of['C++']:6.2f}")


if __name__ == "__main__":
    main(*sys.argv[1:])
