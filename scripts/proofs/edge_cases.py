"""Edge cases that random_worlds.py adds to some of its worlds: interventions at the first and the last tick, bodies that touch
exactly or overlap, a body that is far wider than the others, joints mounted on joints, radios at exactly their range, and worlds
far from the origin. The bodies of edge cases have types of their own, so that the other bodies of the world are as without them."""

import copy

# Edges of cells of the spatial index, m, with the tile sizes of checks.py. Cells may also be half as wide, and so on.
BORDERS = (0.6, 0.9, 2.3)


def add_edge_cases(world, draws, end_s, half):
    """Adds one to three edge cases to a world, a JSON document. draws: a random.Random; end_s: end of the run, s; half: half the
    width of the world, m."""
    chosen = draws.sample(CASES, draws.randint(1, 3))
    for add in sorted(chosen, key=CASES.index):
        add(world, draws, end_s, half)


def _interventions(world, draws, end_s, _):
    """Repeats some interventions of the world at tick 0, in the middle and in the last two ticks, several of them in one tick."""
    tick_s = world["tick_s"]
    times = [draws.choice((0, tick_s, end_s / 2, end_s - tick_s, end_s)) for _ in range(2)]
    again = [{**copy.deepcopy(one), "time_s": draws.choice(times)} for one in world["at"] for _ in range(2) if "set" not in one]
    world["at"] += draws.sample(again, min(len(again), 6))


def _touching(world, draws, _, half):
    """Pushable crates that touch one another, on the borders of cells."""
    edge = draws.choice((0.1, 0.15, 0.3))
    low = -edge * int((half - 1.7) / edge)
    region = [[low, low], [-low, -low]]
    world["types"]["crate"] = {"size_m": [edge, edge, 0.2], "pushable": True, "gripper_return": True, "color": "gold"}
    world["populations"].append({"name": "crate", "type": "crate", "count": 4, "reserve": draws.choice((0, 2)),
                                 "place": {"rule": "grid", "region_m": region, "pitch_m": edge, "spill_m": region}})


def _wide(world, draws, _, half):
    """A board above the other bodies that is far wider than they are, and turns."""
    world["types"]["board"] = {"size_m": [draws.choice((1, 2, 10)) * half, draws.choice((0.01, half)), 0.1], "drive": {"kind": "omni"},
                               "fiducial_return": 3, "controller": {"kind": "script", "legs": [
                                   {"until_s": 1e9, "forward_mps": 0.01, "turn_radps": 0.3}]}}
    world["models"].append({"name": "board", "type": "board", "pose": {"z_m": 1.5}})


def _joints(world, draws, _, half):
    """Bodies with an arm on an arm, which carries a ring of LEDs and a ranger."""
    finger = {"name": "finger", "size_m": [0.04, 0.04, 0.04], "pose": {"x_m": 0.1, "z_m": 0.7}, "fiducial_return": 4,
              "device": {"kind": "actuator", "type": "rotational", "min_position": -3, "max_position": 3},
              "sensors": [{"kind": "ranger", "name": "tip", "transducers": [{"ring": {"count": 5}, "range_max_m": 2}]}],
              "controller": {"kind": "operate", "orders": [{"at_s": 0, "device": "finger", "order": "speed", "value": 2}]}}
    arm = {"name": "arm", "size_m": [0.08, 0.05, 0.05], "pose": {"z_m": 0.6}, "parts": [finger],
           "device": {"kind": "actuator", "min_position": -0.2, "max_position": 0.5, "axis": draws.choice(([1, 0, 0], [1, 1, 1]))},
           "controller": {"kind": "operate", "orders": [{"at_s": 0, "device": "arm", "order": "speed", "value": 0.4}]}}
    leds = {"name": "led", "ring": {"count": 3, "radius_m": 0.1}, "size_m": [0.02, 0.02, 0.02], "pose": {"z_m": 0.5},
            "obstacle": False, "devices": [{"name": "led", "kind": "led"}]}
    world["types"]["arms"] = {"disc": {"radius_m": 0.15, "height_m": 0.3}, "drive": {"kind": "diff"}, "parts": [arm, leds],
                              "controller": {"kind": "script", "law": "wave"}}
    inner = half - 1.7
    world["populations"].append({"name": "arms", "type": "arms", "count": 2, "reserve": draws.choice((0, 2)), "place": {
        "rule": "uniform", "region_m": [[-inner, -inner], [inner, inner]]}})


def _ranges(world, draws, _, half):
    """Two radios at exactly their range. The radio that speaks is on the rim of its body, whose origin is on the border of a cell,
    and rounding makes the sum of the range and of the radius of the body smaller than the distance of the bodies."""
    while True:
        radius, range_m, listener = draws.randint(5, 30) / 100, draws.randint(20, 300) / 100, draws.randint(-200, 200) / 100
        speaker = round(listener + range_m + radius, 2)
        is_on_border = any(speaker / border == int(speaker / border) for border in BORDERS)
        if (is_on_border and 2 * radius < speaker < half and (listener + range_m) + radius < speaker
                and abs((speaker - radius) - listener) <= range_m):
            break
    rim = [[radius, 0], [0, radius], [-radius, 0], [0, -radius]]
    for name, x, at in (("listener", 0, listener), ("speaker", -radius, speaker)):
        world["types"][name] = {"blocks": [{"points_m": rim, "z_m": [2, 2.2]}], "sensors": [{
            "name": "radio", "kind": "radio", "range_m": range_m, "beacon": name == "speaker", "pose": {"x_m": x, "z_m": 2.1}}]}
        world["models"].append({"name": name, "type": name, "pose": {"x_m": at}})


def _overlaps(world, draws, *_):
    """Robots that touch, overlap or are inside one another, a thin wall or a corner of walls, at any angle, high above the other
    bodies."""
    height = {"z_m": 4}
    world["types"] |= {
        "sheet": {"size_m": [0.01, 2, 0.2]},
        "corner": {"blocks": [{"points_m": [[0, 0], [1, 0], [1, 0.3], [0.3, 0.3], [0.3, 1], [0, 1]], "z_m": [0, 0.2]}]}}
    dented = [[-0.1, -0.1], [0.1, -0.1], [0.1, 0.1], [0, 0], [-0.1, 0.1]]
    shapes = ({"disc": {"radius_m": 0.1, "height_m": 0.1}}, {"size_m": [0.2, 0.15, 0.1]}, {"size_m": [0.3, 0.01, 0.1]},
              {"blocks": [{"points_m": dented, "z_m": [0, 0.1]}]})
    ways = ({"forward_mps": 0.3}, {"forward_mps": -0.1, "turn_radps": 0.4}, {"forward_mps": -0.2, "left_mps": 0.1}, {"turn_radps": 1})
    for name, x in (("sheet", -1), ("corner", 1)):
        world["models"].append({"name": name, "type": name, "pose": {"x_m": x, **height}})
    for i in range(draws.randint(3, 6)):
        legs = [{"until_s": until_s, **draws.choice(ways)} for until_s in (0.5, 1e9)]
        robot = {"drive": {"kind": draws.choice(("omni", "diff")), "pushes": draws.choice((0, 4))},
                 "controller": {"kind": "script", "legs": legs}}
        world["types"][f"stuck{i}"] = {**draws.choice(shapes), **({"pushable": True} if draws.random() < 0.2 else robot)}
        x, y = draws.choice(((-1, 0), (-1, 0.3), (1.1, 0.15), (1.15, 0.4), (1.3, 0.3)))
        x += draws.choice((0, 0.01, -0.09, 0.1, 0.105, -0.105))
        world["models"].append({"name": f"stuck{i}", "type": f"stuck{i}",
                                "pose": {"x_m": x, "y_m": y, "heading_deg": draws.choice((0, 90, 180, 37)), **height}})


def _far(world, draws, *_):
    """Moves the whole world away from the origin."""
    shift = [draws.choice((0, 1e4, -90000.1)), draws.choice((0.1, 9e4))]

    def moved(points):
        return [[x + shift[0], y + shift[1]] for x, y in points]

    def move(pose):
        return {**pose, "x_m": pose.get("x_m", 0) + shift[0], "y_m": pose.get("y_m", 0) + shift[1]}

    for one in [*world["models"], *world.get("floorplans", ())]:
        one["pose"] = move(one.get("pose", {}))
    places = [one["place"] for one in world["populations"]]
    for one in [world, *places, *(at["add"] for at in world["at"] if "add" in at)]:
        one.update({key: moved(one[key]) for key in ("bounds_m", "region_m", "spill_m", "polygon_m") if key in one})
        one.update({key: moved([one[key]])[0] for key in ("mean_m", "from_m") if key in one})
    for at in world["at"]:
        for key in ("add", "move"):
            if "pose" in at.get(key, ()):
                at[key] = {**at[key], "pose": move(at[key]["pose"])}


CASES = (_interventions, _touching, _wide, _joints, _ranges, _overlaps, _far)  # _far last: it moves the bodies of the others, too
