"""What is learnt."""

from __future__ import annotations

from typing import Any

import numpy as np
import numpy.typing as npt

from .. import math
from .._core import Swarm
from .spaces import Box


class Task:
    """How robots observe and act, and what they are rewarded for. Derive from it to change any of it.

    Arrays hold a row for each robot of the swarm, in its order. This task: disperse. Robots observe their ranges and
    command their speeds; what is free about them is the reward.
    """

    robots = ""  #: which: a type, a population, a robot, as of Simulation.swarm; all
    ticks = 1  #: of the world in a step of the environment
    seconds = 60.0  #: of the world in an episode, which is then truncated
    max_speed = 0.5  #: m/s, of an action of 1
    max_turn = 1.0  #: rad/s

    def observation_space(self, swarm: Swarm) -> Box:
        """Of one robot."""
        return Box(low=0.0, high=swarm.range_bound(), shape=(swarm.bearings().size,), dtype=np.float32)

    def action_space(self, swarm: Swarm) -> Box:
        """Of one robot."""
        return Box(low=-1.0, high=1.0, shape=(2,), dtype=np.float32)

    def observe(self, swarm: Swarm) -> npt.NDArray[Any]:
        return swarm.ranges()

    def act(self, swarm: Swarm, actions: npt.NDArray[np.float64], where: npt.NDArray[np.bool_]) -> None:
        """actions: finite, also of robots that are not to act: `where` is False there."""
        forward, turn = np.clip(actions, -1, 1).T
        swarm.set_speeds(self.max_speed * forward, self.max_turn * turn, where=where)

    def reward(self, swarm: Swarm) -> npt.NDArray[np.float64]:
        """Of the step that was taken."""
        ranges = swarm.ranges()
        return math.ordered_sum(ranges) / (ranges.shape[1] * swarm.range_bound()) - swarm.stalled()

    def terminated(self, swarm: Swarm) -> npt.NDArray[np.bool_]:
        """Who has come to the end of what is to be done. Who dies has, whatever this says."""
        return np.zeros(len(swarm), np.bool_)
