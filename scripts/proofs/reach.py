"""The reach test of the shipped worlds (`troupe check --reach`, docs/determinism.md): devices read only bodies within their
reach, and only the data that they declare to read."""

import json
import math
import subprocess

from .runs import ROOT, Fault, World

# The time of a tick grows with the square of the number of bodies: with this many, a tick takes about a second.
MOST_BODIES = 2000


def populations(world, most):
    """Returns NAME=N for each population of a parsed JSON world: the populations scaled down in proportion, to about `most`
    bodies in all. Empty if the world has at most `most` bodies."""
    counts = {population["name"]: population["count"] for population in world.get("populations", [])}
    total = sum(counts.values())
    if total <= most:
        return ()
    return tuple(f"{name}={math.ceil(count * most / total)}" for name, count in counts.items())


def worlds(names):
    """Yields a World for each of these file names. The populations of JSON worlds are scaled down to about MOST_BODIES bodies
    in all."""
    for name in names:
        is_json = name.endswith(".json")
        content = json.loads((ROOT / "worlds" / name).read_text(encoding="utf-8")) if is_json else {}
        yield World(name, populations=populations(content, MOST_BODIES))


def prove(program, world, ticks):
    """Makes the reach test of a world. Returns the state hash of the last tick, and a text with the error that the test found,
    which is empty if the test passes. Raises Fault if the test cannot be made."""
    command = [program, "check", *world.arguments, "--reach", "--threads", 1, "--tile-size", "auto", "--for",
               f"{ticks * world.tick_s:.9g}"]
    done = subprocess.run([str(word) for word in command], capture_output=True, text=True)
    if done.returncode not in (0, 1) or "hidden" not in done.stdout:
        raise Fault(f"{' '.join(map(str, command))}\nexit code {done.returncode}: {done.stderr.strip()}")
    lines = [line for line in done.stdout.splitlines() if "bodies beyond reach hidden" in line and not line.startswith(" ")]
    return lines[0].split()[-1], f"{world.name}, reach:\n{done.stdout}" if done.returncode else ""
