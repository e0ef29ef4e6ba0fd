"""Environments with the parallel interface of PettingZoo: one agent a robot."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any, Dict, List, Optional, Tuple

import numpy as np
import numpy.typing as npt

from .._core import Simulation
from .episodes import Episodes, World
from .spaces import Box, same
from .task import Task


class _ParallelEnv:
    """What pettingzoo.ParallelEnv gives to those who derive from it."""

    metadata: Dict[str, Any] = {}
    agents: List[str]
    possible_agents: List[str]

    @property
    def num_agents(self) -> int:
        return len(self.agents)

    @property
    def max_num_agents(self) -> int:
        return len(self.possible_agents)

    @property
    def unwrapped(self) -> Any:
        return self

    def __str__(self) -> str:
        return str(self.metadata.get("name", type(self).__name__))


if TYPE_CHECKING:
    _Base = _ParallelEnv
else:
    try:
        from pettingzoo import ParallelEnv as _Base
    except ImportError:
        _Base = _ParallelEnv

_PerAgent = Dict[str, Any]


class ParallelEnv(_Base):
    """A world in which each robot of the task is an agent, named as the robot.

    world     a file or a dict, as of troupe.Simulation, whose options follow
    task      what is learnt; by default Task(), which is to disperse
    episodes  end for all after task.seconds, and for a robot when the task says so or it dies. Who is born later
              becomes an agent then
    seeds     reset(seed=s) gives the same episode each time; reset() after it one that is drawn from s. Without any
              seed the world's own counts: nothing is drawn from the clock
    """

    metadata = {"name": "troupe_v0", "render_modes": ["rgb_array"], "is_parallelizable": True}

    def __init__(
        self, world: World, task: Optional[Task] = None, *, render_mode: Optional[str] = None, **options: Any
    ) -> None:
        if render_mode not in (None, "rgb_array"):
            raise ValueError(f'unknown render_mode "{render_mode}"; known: rgb_array')
        self.render_mode = render_mode
        self.task = Task() if task is None else task
        self._episodes: Optional[Episodes] = Episodes(world, self.task, options)
        swarm = self._episodes.swarm
        self.possible_agents = list(swarm.names)
        self.agents = []
        self._rows = {agent: row for row, agent in enumerate(self.possible_agents)}
        if len(self._rows) != len(self.possible_agents):
            raise ValueError("agents are named as their robots, and two robots of this world have one name")
        observation_space = self.task.observation_space(swarm)
        action_space = self.task.action_space(swarm)
        self.observation_spaces = {agent: same(observation_space) for agent in self.possible_agents}
        self.action_spaces = {agent: same(action_space) for agent in self.possible_agents}
        self._action_shape = action_space.shape
        self._finished = np.zeros(len(swarm), np.bool_)

    @property
    def simulation(self) -> Simulation:
        """The troupe.Simulation of the episode."""
        return self._use().simulation

    def _use(self) -> Episodes:
        if self._episodes is None:
            raise RuntimeError("this environment was closed")
        return self._episodes

    def observation_space(self, agent: str) -> Box:
        return self.observation_spaces[agent]

    def action_space(self, agent: str) -> Box:
        return self.action_spaces[agent]

    def reset(
        self, seed: Optional[int] = None, options: Optional[Dict[str, Any]] = None
    ) -> Tuple[_PerAgent, Dict[str, Dict[str, Any]]]:
        """Observations and infos of the robots that are there. There are no options: they are not looked at."""
        episodes = self._use()
        episodes.begin(seed)
        self._finished[:] = False
        alive = episodes.swarm.alive()
        self.agents = [agent for agent in self.possible_agents if alive[self._rows[agent]]]
        observations = episodes.observe()
        return {agent: observations[self._rows[agent]] for agent in self.agents}, {agent: {} for agent in self.agents}

    def step(
        self, actions: _PerAgent
    ) -> Tuple[_PerAgent, Dict[str, float], Dict[str, bool], Dict[str, bool], Dict[str, Dict[str, Any]]]:
        """Observations, rewards, terminations, truncations and infos of the robots that could act, and of those born
        meanwhile. A robot without an action goes on with its last one. Throws ValueError for who is no agent now, and
        for actions that are no finite numbers."""
        episodes = self._use()
        if not self.agents:
            return {}, {}, {}, {}, {}
        swarm = episodes.swarm
        table, where = self._table_of(actions)
        before = set(self.agents)
        episodes.step(table, where)
        alive = swarm.alive()
        told = [
            agent
            for agent, row in self._rows.items()
            if agent in before or (alive[row] and not self._finished[row])
        ]
        observations = episodes.observe()
        rewards = self.task.reward(swarm)
        terminated = self.task.terminated(swarm) | ~alive
        is_over = episodes.truncated()
        rows = self._rows
        self._finished |= terminated
        self.agents = [] if is_over else [agent for agent in told if not terminated[rows[agent]]]
        return (
            {agent: observations[rows[agent]] for agent in told},
            {agent: float(rewards[rows[agent]]) for agent in told},
            {agent: bool(terminated[rows[agent]]) for agent in told},
            {agent: is_over for agent in told},
            {agent: {} for agent in told},
        )

    def _table_of(self, actions: _PerAgent) -> Tuple[npt.NDArray[np.float64], npt.NDArray[np.bool_]]:
        """A row for each robot, and which of them are meant."""
        table = np.zeros((len(self._rows), *self._action_shape))
        where = np.zeros(len(self._rows), np.bool_)
        strangers = set(actions) - set(self.agents)
        if strangers:
            raise ValueError(f"actions for who is no agent now: {', '.join(sorted(map(str, strangers)))}")
        for agent, action in actions.items():
            numbers = np.asarray(action, np.float64)
            if numbers.shape != self._action_shape or not np.isfinite(numbers).all():
                raise ValueError(f"action of {agent}: give {self._action_shape} finite numbers, not {action!r}")
            table[self._rows[agent]] = numbers
            where[self._rows[agent]] = True
        return table, where

    def state(self) -> npt.NDArray[np.float64]:
        """Where all robots are: x, y, z, heading of each."""
        return self._use().swarm.poses()

    def render(self) -> Optional[npt.NDArray[np.uint8]]:
        """The world from above, height x width x 3, where the render mode is rgb_array."""
        return None if self.render_mode is None else self._use().simulation.picture()

    def close(self) -> None:
        self._episodes = None
        self.agents = []
