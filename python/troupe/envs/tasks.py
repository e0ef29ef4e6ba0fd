"""Six tasks of swarm robotics, with their worlds. docs/learning.md describes each task and states the return of its
baseline."""

from __future__ import annotations

from typing import Any, Dict, List, Optional, Tuple

import numpy as np
import numpy.typing as npt

from .. import math
from .batch import Batch, Task
from .team import Team

Floats = npt.NDArray[np.float64]

LIDAR_RANGE = 3.0  #: largest range, m
LIDAR_BEAMS = 12


def room(size: float, populations: List[Dict[str, Any]], types: Dict[str, Any], seed: int = 1) -> Dict[str, Any]:
    """Returns a world, a dict as in a JSON world file, with a square room that has walls and is centred on the origin.
    size: length of a side, m. populations, types, seed: values of these keys of the world; a type `wall` is added to
    `types`. Raises ValueError if `size` is not a finite number above 0.2."""
    if not 0.2 < size < float("inf"):
        raise ValueError(f"size={size}: give the length of a side of the room, above 0.2 m")
    half = size / 2
    wall = {"size_m": [0.1, size - 0.2, 0.5], "color": "gray50"}

    def model(name: str, x: float, y: float, turn: float) -> Dict[str, Any]:
        return {"name": name, "type": "wall", "pose": {"x_m": x, "y_m": y, "heading_deg": turn}}

    return {
        "troupe": 1,
        "seed": seed,
        "tick_s": 0.1,
        "types": {"wall": wall, **types},
        "models": [
            model("west", -half, 0, 0), model("east", half, 0, 0), model("south", 0, -half, 90), model("north", 0, half, 90)
        ],
        "populations": populations,
    }


def robot_type(color: str = "SteelBlue", beams: int = LIDAR_BEAMS) -> Dict[str, Any]:
    """Returns a type of robots with a differential drive and a lidar: `beams` beams at equal angles over 360 degrees,
    with a range of 3 m. Robots that do not learn run the controller `wander`. color: name of the colour of the
    robots."""
    return {
        "size_m": [0.3, 0.3, 0.2],
        "color": color,
        "drive": {"kind": "diff", "velocity_max_x_mps": 0.5},
        "sensors": [
            {
                "name": "lidar",
                "kind": "ranger",
                "pose": {"z_m": 0.1},
                "transducers": [{"range_max_m": LIDAR_RANGE, "fov_deg": 360 - 360 / beams, "samples": beams}],
            }
        ],
        "controller": {"kind": "wander", "cruise_speed_mps": 0.3, "min_front_m": 0.6},
    }


def marker_type(color: str, size: float = 0.2) -> Dict[str, Any]:
    """Returns a type of square marks on the floor, which are not obstacles and which lidars do not detect. color: name
    of the colour of the marks. size: length of a side, m."""
    return {"size_m": [size, size, 0.01], "color": color, "obstacle": False, "ranger_return": -1}


def spread(name: str, kind: str, count: int, size: float) -> Dict[str, Any]:
    """Returns a population of `count` bodies of the type `kind` at uniformly random poses in a square room that is
    centred on the origin, at least 0.5 m from its sides. size: length of a side of the room, m. Raises ValueError if it
    is less than 1 m."""
    if not size >= 1:
        raise ValueError(f"size={size}: give the length of a side of the room, at least 1 m, because bodies are placed 0.5 m from its sides")
    half = size / 2 - 0.5
    return {"name": name, "type": kind, "count": count, "place": {"rule": "uniform", "region_m": [[-half, -half], [half, half]]}}


def gathered(name: str, kind: str, count: int, size: float, deviation: float) -> Dict[str, Any]:
    """Returns a population of `count` bodies of the type `kind` whose positions are normally distributed around the
    origin, in a square room that is centred there, at least 0.5 m from its sides. size: length of a side of the room,
    m. deviation: standard deviation along each axis, m."""
    population = spread(name, kind, count, size)
    population["place"] |= {"rule": "gaussian", "mean_m": [0, 0], "deviation_m": [deviation, deviation]}
    return population


def lidar(scale: float = 1 / LIDAR_RANGE) -> Dict[str, Any]:
    """Returns a part of an observation: the ranges of the lidar in m, multiplied by `scale`."""
    return {"field": "ranges", "device": "lidar", "scale": scale}


def located(target: Dict[str, Any], size: float) -> Dict[str, Any]:
    """Returns a part of an observation: a part "target" of the task, whose lengths are divided by the side of the room,
    size (m). Two bodies in the room are at most sqrt(2) * size apart."""
    return {**target, "scale": 1 / size, "low": -1.5, "high": 1.5}


def own_speed() -> Dict[str, Any]:
    """Returns a part of an observation: the speeds of the robot in m/s and rad/s. The drive of robot_type() limits them
    to 0.5 m/s and, by default, pi / 2 rad/s."""
    return {"of": "speed", "low": -2.0, "high": 2.0}


def steer(x: Floats, y: Floats, speed: Floats) -> Floats:
    """Returns actions (forward, turn), numbers from -1 to 1 in the last axis, that turn the robot towards the direction
    (x, y) in its frame. The forward speed is proportional to the cosine of the direction's angle, and 0 if the
    direction points backwards. speed: forward speed if the direction is straight ahead, as a fraction of the largest
    speed, from 0 to 1."""
    length = np.sqrt(x * x + y * y)
    safe = np.where(length > 0, length, 1.0)
    ahead, side = x / safe, y / safe
    turn = np.clip(np.where(ahead < 0, np.where(side < 0, -1.0, 1.0), 2 * side), -1, 1)
    forward = np.clip(speed * np.maximum(ahead, 0.0), 0, 1)
    return np.stack([2 * forward - 1, turn], axis=-1)


def away_from_walls(ranges: Floats, x: Floats, y: Floats, near: float = 0.25) -> Tuple[Floats, Floats]:
    """Returns the direction (x, y) in the robot's frame, turned away from obstacles whose lidar readings are below
    `near`. ranges: readings of the lidar in the last axis. Readings and `near` are fractions of the largest range. The
    length of the result is not 1."""
    beams = ranges.shape[-1]
    first = -np.pi * (beams - 1) / beams
    sin, cos = math.sincos(first + 2 * np.pi / beams * np.arange(beams))
    push = np.maximum(near - ranges, 0.0) / near
    return x - math.ordered_sum(push * cos), y - math.ordered_sum(push * sin)


def straight_to(target: Floats, ranges: Floats, near: float = 0.25) -> Floats:
    """Returns actions as steer() does, at the largest speed, that drive to a target and away from near obstacles.
    target: its x, y and distance in the last axis. ranges and near: as for away_from_walls()."""
    safe = np.where(target[..., 2] > 0, target[..., 2], 1.0)
    x, y = away_from_walls(ranges, target[..., 0] / safe, target[..., 1] / safe, near)
    return steer(x, y, np.ones_like(x))


class Navigation(Task):
    """Each robot drives to its own goal and avoids walls and other robots.

    observed  12 ranges, divided by 3 m; x, y and distance of the goal in the robot's frame, divided by the size of the
              room; forward, left and turn speed
    reward    in each step, the decrease of the distance to the goal, m, minus 0.05 if the robot is stalled. When the
              robot arrives within 0.3 m of the goal, it gets 5 more and is finished
    """

    seconds = 60.0

    def __init__(self, robots: int = 8, size: float = 8.0) -> None:
        self.world = room(
            size,
            [spread("r", "robot", robots, size), spread("goal", "goal", robots, size)],
            {"robot": robot_type(), "goal": marker_type("LimeGreen")},
        )
        goal = {"of": "target", "name": "goal"}
        self.teams = [
            Team(
                robots="r",
                observation=[lidar(), located(goal, size), own_speed()],
                arrays={"goal": [goal], "stalled": [{"of": "stalled"}]},
                rewards=[
                    {"array": "goal", "column": 2, "weight": -1.0, "change": True},
                    {"array": "stalled", "weight": -0.05},
                ],
                ends=[{"array": "goal", "column": 2, "below": 0.3, "reward": 5.0}],
            )
        ]

    def baseline(self, observations: Any, team: int = 0) -> Floats:
        """Drives straight to the goal, but turns away from near obstacles."""
        rows = np.asarray(observations, np.float64)
        n = LIDAR_BEAMS
        return straight_to(rows[..., n : n + 3], rows[..., :n])


class Aggregation(Task):
    """Robots gather at any place.

    observed  12 ranges, divided by 3 m; for each of the 4 nearest robots within 6 m: x and y in the robot's frame,
              divided by 6 m, cosine and sine of its relative heading, and 1, or five zeros for each missing robot
    reward    in each step, -0.1 times the mean of (distance / 6 m) to the 4 nearest robots; a missing robot counts as
              6 m away
    """

    seconds = 60.0
    reach = 6.0
    nearest = 4

    def __init__(self, robots: int = 12, size: float = 8.0) -> None:
        self.world = room(size, [spread("r", "robot", robots, size)], {"robot": robot_type()})
        near = {"of": "nearest", "name": "r", "count": self.nearest, "range_m": self.reach, "scale": 1 / self.reach}
        self.teams = [Team(robots="r", observation=[lidar(), near], arrays={"near": [near]})]

    def reward(self, batch: Batch, team: int) -> Optional[Floats]:
        near = batch.array("near", team).astype(np.float64)
        near = near.reshape(*near.shape[:2], self.nearest, 5)
        distance = np.sqrt(near[..., 0] * near[..., 0] + near[..., 1] * near[..., 1])
        distance = np.where(near[..., 4] > 0, distance, 1.0)
        mean: Floats = math.ordered_sum(distance) / self.nearest
        return -0.1 * mean

    def baseline(self, observations: Any, team: int = 0) -> Floats:
        """Drives to the mean position of the nearest robots, and stops when the nearest is within 0.5 m."""
        rows = np.asarray(observations, np.float64)
        near = rows[..., LIDAR_BEAMS:].reshape(*rows.shape[:-1], self.nearest, 5)
        x, y = near[..., 0].sum(axis=-1), near[..., 1].sum(axis=-1)
        close = (np.sqrt(near[..., 0] ** 2 + near[..., 1] ** 2)[..., 0] * self.reach < 0.5) & (near[..., 0, 4] > 0)
        return steer(x, y, np.where(close, 0.0, 1.0))


class Dispersion(Task):
    """Robots spread out so that each has as much free space around it as possible.

    observed  12 ranges, divided by 3 m
    reward    in each step, 0.1 times the mean range divided by 3 m, minus 0.1 if the robot is stalled
    """

    seconds = 60.0

    def __init__(self, robots: int = 12, size: float = 10.0) -> None:
        self.world = room(size, [gathered("r", "robot", robots, size, 1.0)], {"robot": robot_type()})
        self.teams = [
            Team(
                robots="r",
                observation=[lidar()],
                arrays={"stalled": [{"of": "stalled"}], "lidar": [lidar()]},
                rewards=[
                    *({"array": "lidar", "column": beam, "weight": 0.1 / LIDAR_BEAMS} for beam in range(LIDAR_BEAMS)),
                    {"array": "stalled", "weight": -0.1},
                ],
            )
        ]

    def baseline(self, observations: Any, team: int = 0) -> Floats:
        """Drives away from everything in range of the lidar, as the controller `expand` does."""
        rows = np.asarray(observations, np.float64)
        zero = np.zeros(rows.shape[:-1])
        x, y = away_from_walls(rows, zero, zero, near=1.0)
        return steer(x, y, np.minimum(2 * np.sqrt(x * x + y * y), 1.0))


class Flocking(Task):
    """Robots drive together in one direction.

    observed  12 ranges, divided by 3 m; for each of the 4 nearest robots within 3 m: x and y in the robot's frame,
              divided by 3 m, cosine and sine of its relative heading, and 1, or five zeros for each missing robot;
              forward, left and turn speed
    reward    in each step, 0.05 times the mean cosine of the relative headings of these 4 robots (0 for a missing one),
              plus 0.1 times the forward speed in m/s, minus 0.1 if the robot is stalled
    """

    seconds = 60.0
    reach = 3.0
    nearest = 4

    def __init__(self, robots: int = 12, size: float = 12.0) -> None:
        self.world = room(size, [gathered("r", "robot", robots, size, 1.5)], {"robot": robot_type()})
        near = {"of": "nearest", "name": "r", "count": self.nearest, "range_m": self.reach, "scale": 1 / self.reach}
        self.teams = [
            Team(
                robots="r",
                observation=[lidar(), near, own_speed()],
                arrays={"near": [near], "speed": [{"of": "speed"}], "stalled": [{"of": "stalled"}]},
                rewards=[
                    *({"array": "near", "column": 5 * k + 2, "weight": 0.05 / self.nearest} for k in range(self.nearest)),
                    {"array": "speed", "column": 0, "weight": 0.1},
                    {"array": "stalled", "weight": -0.1},
                ],
            )
        ]

    def baseline(self, observations: Any, team: int = 0) -> Floats:
        """Drives along the mean heading of the neighbours, slightly towards them, and away from near obstacles."""
        rows = np.asarray(observations, np.float64)
        near = rows[..., LIDAR_BEAMS : LIDAR_BEAMS + 5 * self.nearest]
        near = near.reshape(*rows.shape[:-1], self.nearest, 5)
        x = 1 + near[..., 2].sum(axis=-1) + 0.5 * near[..., 0].sum(axis=-1)
        y = near[..., 3].sum(axis=-1) + 0.5 * near[..., 1].sum(axis=-1)
        length = np.maximum(np.sqrt(x * x + y * y), 1e-9)
        x, y = away_from_walls(rows[..., :LIDAR_BEAMS], x / length, y / length, near=0.3)
        return steer(x, y, np.ones_like(x))


class Foraging(Task):
    """Robots repeatedly carry loads from a source to a nest.

    observed  12 ranges, divided by 3 m; x, y and distance of the source and of the nest in the robot's frame, divided
              by the size of the room; 1 if the robot has a load, else -1
    reward    in each step, 0.1 times the decrease of the distance, m, to the nest (with a load) or to the source
              (without); 0.5 for taking a load at the source, and 1 for delivering it at the nest. A robot takes or
              delivers a load when it comes within 0.6 m of the place; no action is needed
    """

    seconds = 90.0
    near = 0.6

    def __init__(self, robots: int = 8, size: float = 8.0) -> None:
        places = {"source": "LimeGreen", "nest": "OrangeRed"}
        types = {"robot": robot_type(), **{name: marker_type(color, 0.8) for name, color in places.items()}}
        world = room(size, [spread("r", "robot", robots, size)], types)
        for x, name in ((-0.3 * size, "source"), (0.3 * size, "nest")):
            world["models"].append({"name": name, "type": name, "pose": {"x_m": x}})
        self.world = world
        source, nest = {"of": "target", "name": "source"}, {"of": "target", "name": "nest"}
        self.teams = [
            Team(
                robots="r",
                observation=[lidar(), located(source, size), located(nest, size)],
                arrays={"source": [source], "nest": [nest]},
            )
        ]

    def _loaded(self, batch: Batch) -> npt.NDArray[np.bool_]:
        none = np.zeros((batch.copies, len(batch.names[0])), np.bool_)
        loaded: npt.NDArray[np.bool_] = batch.memory.setdefault("loaded", none)
        return loaded

    def _way(self, batch: Batch) -> Floats:
        """Returns the distance of each robot to its destination, m: to the nest if it has a load, else to the
        source."""
        way = np.where(self._loaded(batch), batch.array("nest")[..., 2], batch.array("source")[..., 2])
        return way.astype(np.float64)

    def begin(self, batch: Batch, copies: npt.NDArray[np.bool_]) -> None:
        loaded = self._loaded(batch)
        loaded[copies] = False
        batch.memory.setdefault("way", np.zeros(loaded.shape))[copies] = self._way(batch)[copies]

    def reward(self, batch: Batch, team: int) -> Optional[Floats]:
        loaded = self._loaded(batch)
        way = self._way(batch)
        arrived = way < self.near
        reward: Floats = 0.1 * (batch.memory["way"] - way) + np.where(arrived, np.where(loaded, 1.0, 0.5), 0.0)
        loaded ^= arrived
        batch.memory["way"] = self._way(batch)
        return reward

    def observe(self, batch: Batch, team: int, name: str) -> Optional[npt.NDArray[np.float32]]:
        return np.where(self._loaded(batch), 1.0, -1.0).astype(np.float32)[..., np.newaxis]

    def baseline(self, observations: Any, team: int = 0) -> Floats:
        """Drives straight to the nest with a load, else to the source, but turns away from near obstacles."""
        rows = np.asarray(observations, np.float64)
        n = LIDAR_BEAMS
        at = np.where(rows[..., -1:] > 0, rows[..., n + 3 : n + 6], rows[..., n : n + 3])
        return straight_to(at, rows[..., :n], near=0.2)


class Pursuit(Task):
    """Robots (the hunters) catch a slower robot that wanders (the prey).

    observed  12 ranges, divided by 3 m; x, y and distance of the prey in the robot's frame, divided by the size of the
              room; for each of the 3 nearest hunters within 6 m: x and y in the robot's frame, divided by 6 m, cosine
              and sine of its relative heading, and 1, or five zeros for each missing hunter
    reward    in each step, the decrease of the distance to the prey, m. When the robot comes within 0.6 m of the prey,
              it gets 5 more and is finished
    """

    seconds = 60.0

    def __init__(self, robots: int = 4, size: float = 8.0) -> None:
        prey = {**robot_type("OrangeRed")}
        self.world = room(
            size,
            [spread("r", "robot", robots, size), spread("prey", "prey", 1, size)],
            {"robot": robot_type(), "prey": prey},
        )
        target = {"of": "target", "name": "prey0"}
        near = {"of": "nearest", "name": "r", "count": 3, "range_m": 6.0, "scale": 1 / 6.0}
        self.teams = [
            Team(
                robots="r",
                observation=[lidar(), located(target, size), near],
                arrays={"prey": [target]},
                rewards=[{"array": "prey", "column": 2, "weight": -1.0, "change": True}],
                ends=[{"array": "prey", "column": 2, "below": 0.6, "reward": 5.0}],
            )
        ]

    def baseline(self, observations: Any, team: int = 0) -> Floats:
        """Drives straight to the prey, but turns away from near obstacles."""
        rows = np.asarray(observations, np.float64)
        n = LIDAR_BEAMS
        return straight_to(rows[..., n : n + 3], rows[..., :n], near=0.15)


#: Tasks by name; their Gymnasium ids are troupe/Navigation-v0 and so on.
TASKS = {task.__name__: task for task in (Aggregation, Dispersion, Flocking, Foraging, Navigation, Pursuit)}
