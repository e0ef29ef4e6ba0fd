"""The class Team: a group of robots that learn one policy, and its observations, actions and rewards."""

from __future__ import annotations

import dataclasses
import numbers
from typing import Any, Dict, List, Optional, Sequence, Union

import numpy as np
import numpy.typing as npt
from gymnasium import spaces

Part = Dict[str, Any]
Parts = List[Part]

#: Two actions that command a drive: the forward speed from 0 to 0.5 m/s, and the turn rate from -1.5 to 1.5 rad/s.
DRIVE: List[Part] = [
    {"command": "forward", "low": 0.0, "high": 0.5},
    {"command": "turn", "low": -1.5, "high": 1.5},
]


def _no_parts() -> Parts:
    return []


@dataclasses.dataclass
class Team:
    """A group of robots that learn one policy. Parts (groups of columns of an observation), actions, rewards and ends
    are dicts, whose members docs/learning.md lists."""

    #: Name of a type, of a population or of one robot, as in Simulation.swarm(); empty: all robots.
    robots: str = ""
    #: The observation of a robot: a list of parts, whose columns are concatenated into a Box, or a dict with one such
    #: list per name, for a Dict of boxes. If a list has one part with the member "shape", the Box has this shape and
    #: the element type of the reading instead of float32; use this for images.
    observation: Union[Parts, Dict[str, Parts]] = dataclasses.field(default_factory=_no_parts)
    #: The commands that an action sets. By default an action is a Box with one number from -1 to 1 per command. The
    #: number -1 commands the value `low`, and 1 the value `high`.
    actions: List[Part] = dataclasses.field(default_factory=lambda: list(DRIVE))
    #: If given, the action space is Discrete: an action is the index of a row in this list. The list has one row or
    #: more, and each row has one number from -1 to 1 per command. Giving both `choices` and `levels` is an error.
    choices: Optional[Sequence[Sequence[float]]] = None
    #: If given, the action space is MultiDiscrete: an action has one index per command, which selects a number in the
    #: list of this command. There is one list per command, and each has one or more numbers from -1 to 1.
    levels: Optional[Sequence[Sequence[float]]] = None
    #: Arrays that rewards and ends use but that are not observed: a dict from names to lists of parts.
    arrays: Dict[str, Parts] = dataclasses.field(default_factory=dict)
    #: Terms of the reward, which are summed.
    rewards: List[Part] = dataclasses.field(default_factory=list)
    #: Conditions that finish a robot, that is, end its episode.
    ends: List[Part] = dataclasses.field(default_factory=list)
    #: Unique name; empty: team0, team1, ...
    name: str = ""


_LISTS = (list, tuple, np.ndarray)


def is_whole(value: Any) -> bool:
    """Whether a value is a whole number of Python or NumPy above 0."""
    return isinstance(value, numbers.Integral) and not isinstance(value, bool) and int(value) > 0


def check_team(team: Team) -> None:
    """Raises TypeError if a member of a team is not made of lists as Team describes. Raises ValueError if `choices` or
    `levels` do not fit `actions`, have numbers outside of -1 to 1, or are both given, if an array has the name of an
    observation, if a part with a shape is not the only part of its list, or if the member low, high or shape of a part
    is invalid."""
    if not isinstance(team.arrays, dict):
        raise TypeError(f"Team.arrays: must be a dict from names to lists of parts, found {team.arrays!r}")
    observation = team.observation
    lists: Dict[str, Any] = {"actions": team.actions, "rewards": team.rewards, "ends": team.ends}
    if isinstance(observation, dict):
        lists.update({f"observation[{name!r}]": parts for name, parts in observation.items()})
    else:
        lists["observation"] = observation
    lists.update({f"arrays[{name!r}]": parts for name, parts in team.arrays.items()})
    for member, parts in lists.items():
        if not isinstance(parts, _LISTS) or not all(isinstance(part, dict) for part in parts):
            raise TypeError(f"Team.{member}: must be a list of dicts, found {parts!r}")
        if len(parts) > 1 and any("shape" in part for part in parts):
            raise ValueError(f'Team.{member}: has a part with a "shape" and other parts: a part with a shape must be the only one of its list')
        for index, part in enumerate(parts if member.startswith(("observation", "arrays")) else ()):
            _check_space_of(f"Team.{member}[{index}]", part)
    observed = observation if isinstance(observation, dict) else ["observation"]
    for name in team.arrays:
        if name in observed:
            raise ValueError(f'Team.arrays has the name "{name}" of an observation: give the array another name')
    for member, rows in (("choices", team.choices), ("levels", team.levels)):
        if rows is not None:
            _check_numbers(member, rows)
    commands = len(team.actions)
    if team.choices is not None and team.levels is not None:
        raise ValueError("Team.choices and Team.levels are both given: give one of them, because each defines the action space")
    if team.choices is not None:
        if len(team.choices) == 0:
            raise ValueError("Team.choices is empty: give one row or more")
        for index, row in enumerate(team.choices):
            if len(row) != commands:
                raise ValueError(f"Team.choices[{index}] has {_counted(len(row), 'number')}: give {commands}, one per entry of actions")
    if team.levels is not None:
        if len(team.levels) != commands:
            raise ValueError(f"Team.levels has {_counted(len(team.levels), 'list')}: give {commands}, one per entry of actions")
        for index, values in enumerate(team.levels):
            if len(values) == 0:
                raise ValueError(f"Team.levels[{index}] is empty: give one number or more")


def _check_space_of(what: str, part: Part) -> None:
    """Raises TypeError or ValueError if the members low, high and shape of a part of an observation, which define the
    observation space, are invalid. what: the part, for the error text."""
    for member in ("low", "high"):
        if member in part and (not isinstance(part[member], numbers.Real) or part[member] != part[member]):
            raise TypeError(f'{what}: the value {part[member]!r} of the member "{member}" must be a number')
    if "low" in part and "high" in part and part["low"] > part["high"]:
        raise ValueError(f'{what}: "low" is {part["low"]}, "high" is {part["high"]}: the lower bound must not exceed the upper one')
    if "shape" not in part:
        return
    shape = part["shape"]
    if not isinstance(shape, _LISTS) or not all(map(is_whole, shape)):
        raise TypeError(f'{what}: the value {shape!r} of the member "shape" must be a list of whole numbers from 1')
    if part.get("of", "reading") != "reading":
        raise ValueError(f'{what}: a part "{part["of"]}" has no shape: only a part with the member "field" can have one')


def _check_numbers(member: str, rows: Any) -> None:
    """Raises TypeError if a member of a team is not a list of lists of numbers, and ValueError if a number is not from
    -1 to 1."""
    if not isinstance(rows, _LISTS) or not all(isinstance(row, _LISTS) for row in rows):
        raise TypeError(f"Team.{member}: must be a list of lists of numbers, found {rows!r}")
    for index, row in enumerate(rows):
        for column, number in enumerate(row):
            if not isinstance(number, numbers.Real):
                raise TypeError(f"Team.{member}[{index}][{column}]: must be a number from -1 to 1, found {number!r}")
            if not -1 <= float(number) <= 1:  # true for NaN
                raise ValueError(f"Team.{member}[{index}][{column}] is {number}: give a number from -1 to 1")


def _counted(count: int, noun: str) -> str:
    return f"{count} {noun}" if count == 1 else f"{count} {noun}s"


def action_space(team: Team) -> "spaces.Space[Any]":
    """Returns the action space of one robot of a team: Discrete if the team has choices, MultiDiscrete if it has
    levels, else a Box with one number per action."""
    if team.choices is not None:
        return spaces.Discrete(len(team.choices))
    if team.levels is not None:
        return spaces.MultiDiscrete([len(values) for values in team.levels])
    return spaces.Box(-1.0, 1.0, (len(team.actions),), np.float32)


def commands_of(team: Team, actions: Any) -> npt.NDArray[np.float64]:
    """Converts actions in the action space of the team, with any leading axes, to one number from -1 to 1 per command.
    Raises ValueError for an index that the action space does not contain; numbers of a Box are not checked."""
    if team.choices is not None:
        index = np.asarray(actions)
        table = np.asarray(team.choices, np.float64)
        if index.dtype.kind not in "iu" or (index < 0).any() or (index >= len(table)).any():
            raise ValueError(f"actions: must be whole numbers from 0 to {len(table) - 1}, found {actions!r}")
        chosen: npt.NDArray[np.float64] = table[index]
        return chosen
    if team.levels is not None:
        index = np.asarray(actions)
        columns = []
        for column, values in enumerate(team.levels):
            at = index[..., column]
            if index.dtype.kind not in "iu" or (at < 0).any() or (at >= len(values)).any():
                raise ValueError(f"actions, column {column} (counted from 0): must be whole numbers from 0 to {len(values) - 1}, found {at!r}")
            columns.append(np.asarray(values, np.float64)[at])
        return np.stack(columns, axis=-1)
    return np.array(actions, np.float64)  # a copy, which Task.act() may change
