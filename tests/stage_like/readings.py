#!/usr/bin/env python3
"""Computes the expected readings of the rangers in quarry.world and yard.world, and the expected motions of the robots in
swarm.world, with other algorithms than the program.

  readings.py           writes quarry.png, yard.png, bitmaps.txt, swarm.jsonl, and NAME.exact.jsonl and NAME.grid.jsonl for
                        quarry and yard
  readings.py --check   compares the results with the files in this folder; exit code 1: they differ

The script reads no world file: the bodies of the worlds are listed below, in metres and degrees, as lists of corners. For
each beam, all edges of the world are tried:

- exact: the nearest crossing of the beam and an edge, in double precision;
- grid: as in docs/sensing.md, "The grid engine": the line from the middle of the first cell of an edge to the middle of its
  last cell crosses borders between cells; the edge is drawn into the cells that this line passes. The order of the crossings
  is computed with fractions. A ray passes cells by the same rule where anything is drawn, and jumps over empty squares.

A reading is null if rounding may decide it: if it changes by more than a fifth of a millimetre when the beam is moved by two
micrometres and turned by two microradians (exact; the beam grazes an edge or a corner), or if it changes by more than a
micrometre when the origin is moved by a nanometre or the beam is turned by a nanoradian (grid).

Each line of a .jsonl file is a record in the form of Stage's readings: t (s), model, pose of the robot (m, rad) at t, and the
ranges of each transducer (m) at the pose of the previous tick.
"""

import fractions
import json
import math
import pathlib
import sys

from bitmaps import contours, counted, quarry, write_png, yard

HERE = pathlib.Path(__file__).resolve().parent
ROOT = HERE.parent.parent
# The bitmaps in bitmaps.txt, in addition to the two plans.
BITMAPS = ["tests/troupe/stage_styles/plan.pgm", "tests/troupe/stage_styles/bug.pgm", "worlds/cave.png"]
TICK = 0.1
EVERY = 4  # ticks between records


# Bodies.

class Edges:
    """The edges of one body: each ((ax, ay), (bx, by), z_min, z_max)."""

    def __init__(self):
        self.edges = []

    def ring(self, points, z):
        self.edges += [(a, b, *z) for a, b in zip(points, points[1:] + points[:1])]


def box(width, depth, x=0.0, y=0.0):
    return [(x - width / 2, y - depth / 2), (x + width / 2, y - depth / 2), (x + width / 2, y + depth / 2),
            (x - width / 2, y + depth / 2)]


def placed(points, pose):
    x, y, heading = pose
    c, s = math.cos(heading), math.sin(heading)
    return [(x + c * px - s * py, y + s * px + c * py) for px, py in points]


def joined(pose, child):
    (x, y), = placed([child[:2]], pose)
    return (x, y, pose[2] + child[2])


def stretched(outlines, width, depth):
    """Scales outlines so that their common bounding box has the given size and its centre at 0; y points up in the result."""
    xs = [x for outline in outlines for x, _ in outline]
    ys = [y for outline in outlines for _, y in outline]
    left, right, top, bottom = min(xs), max(xs), min(ys), max(ys)
    return [[((x - (left + right) / 2) * width / (right - left), -(y - (top + bottom) / 2) * depth / (bottom - top))
             for x, y in outline] for outline in outlines]


def fixed_of_quarry():
    fixed = Edges()
    plan = (0.0037, -0.0041, 0.0)
    for outline in stretched(contours(quarry()), 12, 8):
        fixed.ring(placed(outline, plan), (0, 0.6))
    for wall in (box(12, 0.01, 0, 3.995), box(12, 0.01, 0, -3.995), box(0.01, 8, 5.995, 0), box(0.01, 8, -5.995, 0)):
        fixed.ring(placed(wall, plan), (0, 0.6))
    fixed.ring(placed(box(0.5, 0.3), (-1.5, 1.2, math.radians(20))), (0, 0.1))
    fixed.ring(placed(box(0.4, 0.25), (-2.431, -1.357, math.radians(27))), (0, 0.8))
    return fixed


def fixed_of_yard():
    fixed = Edges()
    for outline in stretched(contours(yard()), 9, 6):
        fixed.ring(placed(outline, (0.123, -0.047, 0.37)), (0, 0.8))
    return fixed


# A ranger: its name and its transducers. A transducer: pose in the frame of the robot (m, rad), height, range_max, beam angles.

def fan(fov, samples):
    return [-fov / 2 + i * fov / (samples - 1) for i in range(samples)] if samples > 1 else [0.0]


SONARS = [(0.15, 0.09, 60), (0.19, 0.05, 25), (0.2, 0, 0), (0.19, -0.05, -25), (0.15, -0.09, -60), (-0.15, -0.09, -120),
          (-0.19, -0.05, -155), (-0.2, 0, 180), (-0.19, 0.05, 155), (-0.15, 0.09, 120)]
MOWER = {
    "outlines": [([(-0.28, -0.2), (0.095, -0.2), (0.22, -0.1), (0.22, 0.1), (0.095, 0.2), (-0.28, 0.2)], (0, 0.25)),
                 (box(0.12, 0.1, 0.05, 0), (0.25, 0.4))],
    "rangers": [
        ("ranger:0", [((x, y, math.radians(a)), 0.25 - 0.05 + 0.01, 4.0, [0.0]) for x, y, a in SONARS]),
        ("ranger:1", [((0.05, 0, 0), 0.25 + 0.08 + 0.01, 7.0, fan(math.radians(200), 41))])],
}
RING = [(0, 0, a) for a in (0, 0.52359878, 1.04719755, 1.57079633, 2.0943951, 2.61799388, 3.14159265, -2.61799388, -2.0943951,
                            -1.57079633, -1.04719755, -0.52359878)]
CART = {"outlines": [(box(0.2, 0.16), (0, 0.12))],
        "rangers": [("ranger:0", [(pose, 0.12 - 0.06 + 0.01, 2.5, [0.0]) for pose in RING])]}
CART_WITH_MAST = {
    "outlines": CART["outlines"] + [(placed(box(0.04, 0.04), (-0.05, 0, 0.5)), (0.12, 0.42))],
    "rangers": CART["rangers"] + [("model:0.ranger:0", [((-0.05, 0, 0.5), 0.42 + 0.02, 5.0, fan(3.0, 31))])]}


def wave(n):
    return 0.2 + 0.1 * (n // 7 % 3), 0.4 * (n // 11 % 5 - 2)


def line(_):
    return 0.5, 0.0


WORLDS = {
    "quarry": {"plan": quarry, "fixed": fixed_of_quarry, "law": wave, "ticks": 60, "cell": 0.02,
               "robots": [("a", MOWER, (-3.713, 1.291, math.radians(10.5))), ("b", MOWER, (-1.113, -0.829, math.radians(-64.25))),
                          ("c", MOWER, (2.371, 0.433, math.radians(158))), ("stuck", MOWER, (5.371, 3.533, math.radians(33)))]},
    "yard": {"plan": yard, "fixed": fixed_of_yard, "law": line, "ticks": 40, "cell": 0.05,
             "robots": [("a", CART, (-2.113, -0.571, 0.3)), ("b", CART, (0.917, -0.139, 2.6)),
                        ("c", CART_WITH_MAST, (0.431, 1.289, -1.2))]},
}


def paths(robots, law, ticks):
    """Returns the poses of each robot at ticks 0 to `ticks`. A command of tick n moves the robot in tick n + 1."""
    of_all = []
    for _, _, (x, y, heading) in robots:
        poses = [(x, y, heading), (x, y, heading)]
        for n in range(1, ticks):
            v, turn = law(n)
            x, y = x + v * TICK * math.cos(heading), y + v * TICK * math.sin(heading)
            heading = math.remainder(heading + turn * TICK, 2 * math.pi)
            poses.append((x, y, heading))
        of_all.append(poses)
    return of_all


# Exact geometry.

def exact_range(edges, origin, heading, z, range_max):
    c, s = math.cos(heading), math.sin(heading)
    ox, oy = origin
    best = range_max
    for (ax, ay), (bx, by), z_min, z_max in edges:
        if not z_min <= z <= z_max:
            continue
        # Coordinates in the frame of the beam, in which the beam runs along the first axis.
        across_a, across_b = c * (ay - oy) - s * (ax - ox), c * (by - oy) - s * (bx - ox)
        if (across_a < 0) == (across_b < 0):
            continue
        t = across_a / (across_a - across_b)
        along = c * (ax + t * (bx - ax) - ox) + s * (ay + t * (by - ay) - oy)
        if 0 <= along < best:
            best = along
    return best


def exact_reading(edges, origin, heading, z, range_max):
    reading = exact_range(edges, origin, heading, z, range_max)
    c, s = math.cos(heading), math.sin(heading)
    for side in (-1, 1):
        for turn in (-2e-6, 2e-6):
            moved = (origin[0] - side * 2e-6 * s, origin[1] + side * 2e-6 * c)
            if abs(exact_range(edges, moved, heading + turn, z, range_max) - reading) > 2e-4:
                return None
    return reading


# The grid engine's cells.

def crossings(across, up):
    """Returns the borders between cells that a line of `across` by `up` cells crosses, in order: True for a crossing along x. If
    the line crosses two borders at once, the crossing along y comes first."""
    along_x = [(fractions.Fraction(2 * i - 1, across), 1) for i in range(1, across + 1)]
    along_y = [(fractions.Fraction(2 * j - 1, up), 0) for j in range(1, up + 1)]
    return [bool(x) for _, x in sorted(along_x + along_y)]


def cell_of(point, cell):
    return math.floor(point[0] / cell), math.floor(point[1] / cell)


def cells_of_edge(a, b, cell):
    x, y = cell_of(a, cell)
    to_x, to_y = cell_of(b, cell)
    step_x, step_y = (1 if to_x > x else -1), (1 if to_y > y else -1)
    cells = []
    for along_x in crossings(abs(to_x - x), abs(to_y - y)):
        cells.append((x, y))
        x, y = (x + step_x, y) if along_x else (x, y + step_y)
    return cells or [(x, y)]


def drawn(edges, cell, into):
    for a, b, z_min, z_max in edges:
        for at in cells_of_edge(a, b, cell):
            into.setdefault(at, set()).add((z_min, z_max))
    return into


def square_of(at):
    return at[0] // 32, at[1] // 32


def grid_range(maps, squares, origin, heading, z, range_max, cell):
    """maps: the cells that the ray can hit; squares: the squares of 32 x 32 cells in which anything is drawn. Computes with
    fractions, so nothing is rounded except where the rules of the grid engine round."""
    direction = (math.cos(heading), math.sin(heading))
    forward = [fractions.Fraction(abs(component)) for component in direction]
    step = [-1 if component < 0 else 1 for component in direction]
    start = [fractions.Fraction(value) / fractions.Fraction(cell) for value in origin]
    # The extents of the ray in whole cells: they decide the order of its steps and how many there are.
    extent = [int(part * fractions.Fraction(range_max) / fractions.Fraction(cell)) for part in forward]
    left = sum(extent)
    at, steps = start, [0, 0]
    while left > 0:
        here = [int(value) for value in at]  # towards zero
        square = square_of(here)
        if square not in squares:
            # Jumps along the line from here. `borders`: where the next jumps end.
            line, before = at, 0
            borders = [32 * number + (32 if sign > 0 else -1) for number, sign in zip(square, step)]
            while left > 0 and square not in squares:
                times = [abs(border - value) / part if part else math.inf for border, value, part in zip(borders, line, forward)]
                axis = 0 if times[0] < times[1] else 1
                at = [value + sign * times[axis] * part for value, sign, part in zip(line, step, forward)]
                at[axis] = fractions.Fraction(borders[axis])
                borders[axis] += 32 * step[axis]
                left = int(left - (times[axis] - before) * sum(forward))
                before = times[axis]
                square = square_of([int(value) for value in at])
            continue
        while left > 0 and square_of(here) == square:
            if any(z_min <= z <= z_max for each in maps for z_min, z_max in each.get(tuple(here), ())):
                axis = 0 if extent[0] > extent[1] else 1
                return min(float(abs(at[axis] - start[axis]) / forward[axis] * fractions.Fraction(cell)), range_max)
            # Of the next border along x, at (2 i + 1) / extent x, and the next one along y, the ray crosses the nearer one.
            axis = 0 if extent[1] * (2 * steps[0] + 1) < extent[0] * (2 * steps[1] + 1) else 1
            steps[axis] += 1
            here[axis] += step[axis]
            at = [value + (step[axis] if k == axis else 0) for k, value in enumerate(at)]
            left -= 1
    return range_max


def grid_reading(maps, squares, origin, heading, z, range_max, cell):
    reading = grid_range(maps, squares, origin, heading, z, range_max, cell)
    for dx, dy, turn in ((1e-9, 0, 0), (-1e-9, 0, 0), (0, 1e-9, 0), (0, -1e-9, 0), (0, 0, 1e-9), (0, 0, -1e-9)):
        moved = grid_range(maps, squares, (origin[0] + dx, origin[1] + dy), heading + turn, z, range_max, cell)
        if abs(moved - reading) > 1e-6:
            return None
    return reading


def moving_edges(kind, pose):
    edges = Edges()
    for outline, z in kind["outlines"]:
        edges.ring(placed(outline, pose), z)
    return edges.edges


def records(world, engine):
    robots, ticks, cell = world["robots"], world["ticks"], world["cell"]
    of_all = paths(robots, world["law"], ticks)
    fixed = world["fixed"]().edges
    fixed_cells = drawn(fixed, cell, {})
    lines = []
    for tick in range(1, ticks + 1):
        if (tick - 1) % EVERY:
            continue
        outlines = [moving_edges(kind, poses[tick - 1]) for (_, kind, _), poses in zip(robots, of_all)]
        cells = [drawn(edges, cell, {}) for edges in outlines]
        for r, (name, kind, _) in enumerate(robots):
            others = [edge for o, edges in enumerate(outlines) if o != r for edge in edges]
            maps = [fixed_cells] + [each for o, each in enumerate(cells) if o != r]
            squares = {square_of(at) for each in [fixed_cells, *cells] for at in each}
            for ranger, transducers in kind["rangers"]:
                sensors = []
                for mount, z, range_max, angles in transducers:
                    x, y, heading = joined(of_all[r][tick - 1], mount)
                    ranges = []
                    for angle in angles:
                        if engine == "exact":
                            reading = exact_reading(fixed + others, (x, y), heading + angle, z, range_max)
                        else:
                            reading = grid_reading(maps, squares, (x, y), heading + angle, z, range_max, cell)
                        ranges.append(None if reading is None else round(reading, 5))
                    sensors.append({"ranges": ranges})
                lines.append({"t": round(tick * TICK, 3), "model": f"{name}.{ranger}",
                              "pose": [round(value, 10) for value in of_all[r][tick]], "sensors": sensors})
    return lines


# A swarm whose commands depend on its readings.

SWARM = {"count": 24, "ticks": 100, "told": (10, 30, 60, 100)}


def expand(ranges):
    """Stage's expand_swarm: returns the command for the readings of twelve beams, 30 degrees apart; None: no new command."""
    x = sum(r * math.cos(math.radians(30 * i)) for i, r in enumerate(ranges))
    y = sum(r * math.sin(math.radians(30 * i)) for i, r in enumerate(ranges))
    if x == 0 or y == 0:
        return None
    turn = math.atan2(y, x)
    free = all(ranges[i] > 0.5 / share for i, share in ((0, 1), (1, 1.5), (2, 3), (3, 5), (9, 5), (10, 3), (11, 1.5)))
    speed = 0.3 if free and abs(turn) < 0.5 else 0.0
    return speed, min(max(turn, -math.pi / 2), math.pi / 2)


def swarm():
    """Returns poses at some ticks, and the mean distance of the robots from their initial poses, m."""
    plan = Edges()
    for outline in stretched(contours(yard()), 9, 6):
        plan.ring(placed(outline, (0, 0.05, 0)), (0, 0.5))
    for wall in (box(9, 0.01, 0, 2.995), box(9, 0.01, 0, -2.995), box(0.01, 6, 4.495, 0), box(0.01, 6, -4.495, 0)):
        plan.ring(placed(wall, (0, 0.05, 0)), (0, 0.5))
    start = [(-1.9 + 0.4 * (n // 6), -1 + 0.4 * (n % 6), math.radians(n * 37 % 360)) for n in range(SWARM["count"])]
    poses, commands = start, [(0.0, 0.0)] * len(start)
    lines = []
    for tick in range(1, SWARM["ticks"] + 1):
        outlines = []
        for pose in poses:
            edges = Edges()
            edges.ring(placed(box(0.1, 0.1), pose), (0, 0.1))
            outlines.append(edges.edges)
        decided = []
        for r, (x, y, heading) in enumerate(poses):
            seen = plan.edges + [edge for o, (ox, oy, _) in enumerate(poses) if o != r and math.hypot(ox - x, oy - y) < 2.1
                                 for edge in outlines[o]]
            decided.append(expand([exact_range(seen, (x, y), heading + math.radians(30 * i), 0.06, 2.0) for i in range(12)]))
        poses = [(x + v * TICK * math.cos(heading), y + v * TICK * math.sin(heading),
                  math.remainder(heading + turn * TICK, 2 * math.pi)) for (x, y, heading), (v, turn) in zip(poses, commands)]
        commands = [new or old for new, old in zip(decided, commands)]
        nearest = min(math.dist(a[:2], b[:2]) for i, a in enumerate(poses) for b in poses[:i])
        assert nearest > 0.1415, f"robots may touch at tick {tick}, which is not worked out here"
        if tick in SWARM["told"]:
            lines.append({"t": round(tick * TICK, 3), "poses": [[round(value, 9) for value in pose] for pose in poses],
                          "displacement": round(sum(math.dist(a[:2], b[:2]) for a, b in zip(poses, start)) / len(poses), 9)})
    return lines


def files():
    made = {}
    for name, world in WORLDS.items():
        made[f"{name}.png"] = write_png(world["plan"]())
        for engine in ("exact", "grid"):
            text = "".join(json.dumps(record, separators=(",", ":")) + "\n" for record in records(world, engine))
            made[f"{name}.{engine}.jsonl"] = text.encode()
    made["swarm.jsonl"] = "".join(json.dumps(line, separators=(",", ":")) + "\n" for line in swarm()).encode()
    plans = [HERE / f"{name}.png" for name in WORLDS] + [ROOT / name for name in BITMAPS]
    made["bitmaps.txt"] = "".join(f"{plan.relative_to(ROOT)} {counted(plan)}\n" for plan in plans).encode()
    return made


def main():
    if sys.argv[1:] not in ([], ["--check"]):
        sys.exit("usage: readings.py [--check]")
    if not sys.argv[1:]:
        for name, world in WORLDS.items():
            (HERE / f"{name}.png").write_bytes(write_png(world["plan"]()))
    differ = []
    for name, data in files().items():
        file = HERE / name
        if not sys.argv[1:]:
            file.write_bytes(data)
        elif not file.is_file() or file.read_bytes() != data:
            differ.append(name)
    if differ:
        sys.exit(f"{HERE}: not what readings.py makes: {', '.join(differ)}")


if __name__ == "__main__":
    main()
