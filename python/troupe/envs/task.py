"""Tasks: the observations, actions and rewards of the robots that learn."""

from __future__ import annotations

import dataclasses
import os
from typing import TYPE_CHECKING, Any, Dict, List, Optional, Sequence, Union

import numpy as np
import numpy.typing as npt
from gymnasium import spaces

if TYPE_CHECKING:
    from .batch import Batch

World = Union[str, "os.PathLike[str]", Dict[str, Any]]
Part = Dict[str, Any]
Parts = List[Part]

#: Forward speed and turn rate of a drive.
DRIVE: List[Part] = [
    {"command": "forward", "low": 0.0, "high": 0.5},
    {"command": "turn", "low": -1.5, "high": 1.5},
]


def _no_parts() -> Parts:
    return []


@dataclasses.dataclass
class Team:
    """Robots that learn one policy. docs/learning.md lists the members of parts, actions, rewards and ends."""

    #: A type, a population or one robot, as in Simulation.swarm; empty: all robots.
    robots: str = ""
    #: A list of parts for a Box, or name -> list of parts for a Dict of boxes. A list of one part with "shape" keeps
    #: the element type of its reading, for images.
    observation: Union[Parts, Dict[str, Parts]] = dataclasses.field(default_factory=_no_parts)
    #: The commands of an action: one number from -1 to 1 each.
    actions: List[Part] = dataclasses.field(default_factory=lambda: list(DRIVE))
    #: Rows of such numbers: the action space is then Discrete, and an action is the index of a row.
    choices: Optional[Sequence[Sequence[float]]] = None
    #: The allowed values of each number of an action: the action space is then MultiDiscrete.
    levels: Optional[Sequence[Sequence[float]]] = None
    #: Arrays for rewards and ends that are not observed: name -> list of parts.
    arrays: Dict[str, Parts] = dataclasses.field(default_factory=dict)
    rewards: List[Part] = dataclasses.field(default_factory=list)
    ends: List[Part] = dataclasses.field(default_factory=list)
    name: str = ""


class Task:
    """A world, the robots that learn in it, and how long an episode lasts.

    To define a task, set these members, or derive from this class to override the functions below. They get the whole
    batch: arrays are copies x robots x columns, and one call is for all copies.
    """

    world: World = {}
    teams: List[Team] = []
    ticks = 1  #: ticks of the world per step
    seconds = 60.0  #: length of an episode in world time, s; it is then truncated
    measures: List[str] = []  #: measures of each copy, for rewards and ends
    max_return: Optional[float] = None  #: the greatest possible return, if known

    def begin(self, batch: "Batch", copies: npt.NDArray[np.bool_]) -> None:
        """Called after the copies marked in `copies` have begun an episode."""

    def act(self, batch: "Batch", team: int, actions: npt.NDArray[np.float64]) -> npt.NDArray[np.float64]:
        """Maps the actions of the policy to commands, both from -1 to 1."""
        return actions

    def reward(self, batch: "Batch", team: int) -> Optional[npt.NDArray[np.float64]]:
        """Copies x robots: rewards to add to those of Team.rewards; None for none. Called once per step."""
        return None

    def terminated(self, batch: "Batch", team: int) -> Optional[npt.NDArray[np.bool_]]:
        """Copies x robots: robots that are finished, in addition to Team.ends; None for none."""
        return None

    def observe(self, batch: "Batch", team: int, name: str) -> Optional[npt.NDArray[np.float32]]:
        """Copies x robots x columns: columns to append to an observed array; None for none. They are added to the
        observation space with the bounds -1 and 1."""
        return None

    def baseline(self, observations: Any, team: int = 0) -> npt.NDArray[np.float64]:
        """Actions of a simple hand-written rule, one row per row of the observations."""
        raise NotImplementedError(f"{type(self).__name__} has no baseline")


def action_space(team: Team) -> "spaces.Space[Any]":
    """The action space of one robot."""
    if team.choices is not None:
        return spaces.Discrete(len(team.choices))
    if team.levels is not None:
        return spaces.MultiDiscrete([len(values) for values in team.levels])
    return spaces.Box(-1.0, 1.0, (len(team.actions),), np.float32)


def commands_of(team: Team, actions: Any) -> npt.NDArray[np.float64]:
    """Converts actions of the team's space, with any leading axes, to numbers from -1 to 1."""
    if team.choices is not None:
        index = np.asarray(actions)
        table = np.asarray(team.choices, np.float64)
        if index.dtype.kind not in "iu" or (index < 0).any() or (index >= len(table)).any():
            raise ValueError(f"actions: give whole numbers from 0 to {len(table) - 1}, not {actions!r}")
        chosen: npt.NDArray[np.float64] = table[index]
        return chosen
    if team.levels is not None:
        index = np.asarray(actions)
        columns = []
        for column, values in enumerate(team.levels):
            at = index[..., column]
            if index.dtype.kind not in "iu" or (at < 0).any() or (at >= len(values)).any():
                raise ValueError(f"actions, column {column}: give whole numbers from 0 to {len(values) - 1}")
            columns.append(np.asarray(values, np.float64)[at])
        return np.stack(columns, axis=-1)
    return np.asarray(actions, np.float64)
