"""Checks of random worlds: ways to run a world that must not change its results. They are plain data, so that a failing check can
be run again.

A check is a dict {"check": name, ...}. The runner (random_proof.py) runs the world as the check says, and compares the hash log
of this run, one line per tick, with that of the plain run: one thread, automatic tile size, one tick per call. The checks
`program`, `ranks` and those in OPTIONS are calls of `troupe check`, which itself compares several runs.
"""

import random

THREADS = (1, 2, 3, 8)
TILES = (0, 0.6, 0.9, 2.3, 17.3)  # m; 0: automatic
# Checks that `troupe check` makes with one option, on one thread and with one tile size.
OPTIONS = {"controllers": "--controllers", "amnesia": "--amnesia", "reach": "--reach"}
# The probability that a world is also computed by several ranks, that a session is recorded in the world and repeated, that
# the controllers of the world are checked (with --controllers, those of all worlds are), and that tables are compared.
RANKS = 0.5
SESSIONS = 0.35
CONTROLLERS = 0.1
TABLES = 0.25


def options_of(check):
    """Returns the options that `troupe check` needs for this check, in addition to those for threads and tile sizes."""
    options = [OPTIONS[check["check"]]] if check["check"] in OPTIONS else []
    if check["check"] == "ranks":
        options += ["--ranks", ",".join(map(str, check["ranks"])), "--rank-seed", str(check["seed"])]
        options += ["--distribute"] if check.get("distribute") else []
    return options


def plan(seed, index, ticks, program_only=False, controllers=False):
    """Returns the checks of the random world with this seed and index, a list of dicts. ticks: length of the run.
    program_only: only checks that need no Python module. controllers: include the check of controllers in any case; otherwise
    one world in ten has it."""
    draws = random.Random(f"checks {seed} {index}")
    chain = {"at": sorted(draws.sample(range(ticks), min(ticks, draws.choice((1, 2, 2, 3, 5))))),
             "threads": [draws.choice(THREADS) for _ in range(6)], "tiles": [draws.choice(TILES) for _ in range(6)]}
    program = {"check": "program", "threads": sorted(draws.sample(THREADS, 2)), "tiles": [0, draws.choice(TILES[1:])]}
    if program_only:
        checks = [{**program, "threads": list(THREADS)}, {"check": "program_checkpoints", **{**chain, "at": chain["at"][:2]}}]
    else:
        checks = [{"check": "threads", "threads": n, "tile": draws.choice(TILES)} for n in draws.sample(THREADS, 2)]
        checks.append({"check": "checkpoints", **chain})
        checks.append({"check": "reset", "at": draws.randint(1, ticks), "threads": draws.choice(THREADS)})
        checks.append({"check": "steps", "of": draws.randint(2, 9), "threads": draws.choice(THREADS)})
        checks.append({"check": "observed", "threads": draws.choice(THREADS), "picture": draws.random() < 0.03})
        if draws.random() < 0.3:
            checks.append({"check": "converted", "to": draws.choice(("json", "json", "world"))})
        if draws.random() < 0.1:
            checks.append(program)
    if draws.random() < RANKS:
        checks.append({"check": "ranks", "ranks": [1, *sorted(draws.sample((2, 3, 4, 7), 2))], "threads": [draws.choice((1, 2))],
                       "seed": draws.randrange(1 << 32)})
    checks.append({"check": "amnesia"})
    checks.append({"check": "reach"})
    if draws.random() < SESSIONS and not program_only:
        checks.append({"check": "session", "seed": draws.randrange(1 << 32)})
    if controllers or draws.random() < CONTROLLERS:
        checks.append({"check": "controllers"})
    if draws.random() < TABLES and not program_only:
        checks.append({"check": "tables", "threads": draws.choice(THREADS), "tile": draws.choice(TILES),
                       "ranks": draws.choice((1, 1, 2, 3))})
    return checks


def plan_of_ranks(seed, index, *_):
    """Returns the checks of a random world, as plan() does, for `scripts/prove --ranks`. There are five checks, each with
    several numbers of ranks (groups of threads that compute a world together), several numbers of threads, and another seed of
    the random delays of messages. In three checks each rank has all robots, in two checks only its own robots and those near
    them (`--distribute`)."""
    draws = random.Random(f"ranks {seed} {index}")
    return [{"check": "ranks", "ranks": [1, 2, 3, 4, 7], "threads": [1, 2], "seed": draws.randrange(1 << 32),
             "distribute": distribute} for distribute in (False, False, False, True, True)]


def difference(expected, got, whole=True):
    """Returns the first difference between two hash logs, (tick, text), or None if there is none. The logs are lists of lines
    "TICK STATE group=... group=..."; `got` may begin at a later tick. whole: whether a different number of lines also is a
    difference."""
    start = 0
    if got and expected:
        first = int(got[0].split()[0])
        start = next((i for i, line in enumerate(expected) if int(line.split()[0]) == first), 0)
    for a, b in zip(expected[start:], got):
        if a == b:
            continue
        tick = int(a.split()[0])
        groups = [x.split("=")[0] for x, y in zip(a.split()[2:], b.split()[2:]) if x != y]
        return tick, (f"differs from tick {tick} on, in {', '.join(groups) or 'the format of the line'}: expected {a}; "
                      f"got {b}")
    if whole and len(expected) - start != len(got):
        tick = int((expected[start:] or expected)[min(len(got), len(expected) - start - 1)].split()[0])
        return tick, (f"the hash log has {len(got)} lines from tick {start} on, that of the run on one thread has "
                      f"{len(expected) - start}")
    return None
