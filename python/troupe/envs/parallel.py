"""An environment with the parallel interface of PettingZoo, with one agent per robot."""

from __future__ import annotations

import copy
from collections.abc import Mapping
from typing import Any, Callable, Dict, List, Optional, Tuple

import numpy as np
import numpy.typing as npt
from gymnasium import spaces
from gymnasium.utils import EzPickle
from pettingzoo import ParallelEnv as _ParallelEnv

from .batch import Task, one_copy, require_task
from .render import RENDER_MODES, RENDER_SIZE, OneCopy, Renderer, render_metadata
from .single import checked, first_of, info_of

_PerAgent = Dict[str, Any]


class ParallelEnv(OneCopy, EzPickle, _ParallelEnv):
    """An environment in which each robot of each team of a task is an agent. The name of an agent is the name of its
    robot. Agents of different teams may have different observation and action spaces.

    max_episode_steps
                 number of steps after which an episode is truncated, if it has not reached task.seconds before
    render_mode  rgb_array: render() returns a picture. human: the world runs in real time in a browser, at the address
                 that the first reset() prints
    render_size  width and height of pictures, pixels
    render_look  keyword arguments of Simulation.picture(), a dict such as {"camera": "perspective"}
    options      keyword arguments of troupe.Simulation, except threads
    episodes     an episode ends for all agents after task.seconds, and for a single agent when its robot is finished
                 (by Team.ends, Task.terminated() or the world's `stop_when`) or dies. A robot that is born during an
                 episode becomes an agent at that time
    spaces       observation_spaces and action_spaces are dicts with one space per possible agent; state_space is the
                 space of state()
    seeds        reset(seed=s) begins an episode with the seed s. A later reset() without a seed begins an episode whose
                 seed is derived from s. If no seed was ever given, the first seed is the option `seed`, or else random
    pickle       a copy of the environment, also by copy.deepcopy(), is a new environment with the same arguments, which
                 needs a reset()
    errors       TypeError if `task` is not a Task; ValueError if two robots have the same name; RuntimeError after
                 close()
    """

    # render_fps of an object: that of its world
    metadata = {"name": "troupe_v0", "render_modes": RENDER_MODES, "render_fps": 10.0, "is_parallelizable": True}

    def __init__(
        self,
        task: Task,
        *,
        max_episode_steps: Optional[int] = None,
        render_mode: Optional[str] = None,
        render_size: Tuple[int, int] = RENDER_SIZE,
        render_look: Optional[Dict[str, Any]] = None,
        **options: Any,
    ) -> None:
        EzPickle.__init__(
            self, task, max_episode_steps=max_episode_steps, render_mode=render_mode, render_size=render_size,
            render_look=render_look, **options)
        require_task(task)
        self.task = task
        self.render_mode = render_mode
        self.renderer = Renderer(render_mode, render_size, render_look)
        self._batch = one_copy(task, max_episode_steps=max_episode_steps, **options)
        self.metadata = {**self.metadata, **render_metadata(self._batch)}
        self._places: Dict[str, Tuple[int, int]] = {}  # team and row of each agent
        for team, names in enumerate(self._batch.names):
            for row, name in enumerate(names):
                if name in self._places:
                    raise ValueError(f'agents have the names of their robots, but two robots are called "{name}": rename one')
                self._places[name] = (team, row)
        self.possible_agents = list(self._places)
        self.agents: List[str] = []
        self._met: Dict[str, bool] = {}  # whether each agent of this episode is finished
        self.observation_spaces = {name: _same(self._batch.observation_spaces[t]) for name, (t, _) in self._places.items()}
        self.action_spaces = {name: _same(self._batch.action_spaces[t]) for name, (t, _) in self._places.items()}
        self._observed_by_all = spaces.Tuple([self.observation_spaces[name] for name in self.possible_agents])
        self.state_space = spaces.flatten_space(self._observed_by_all)

    def observation_space(self, agent: str) -> Any:
        return self.observation_spaces[agent]

    def action_space(self, agent: str) -> Any:
        return self.action_spaces[agent]

    def state(self) -> npt.NDArray[Any]:
        """Returns the observations of all possible agents after the last step as one row, for methods that train a
        central critic: the observations, flattened, in the order of `possible_agents`. The row has the same length in
        all steps: it also has the observations of finished robots, and zeros for robots that are not in the world."""
        observations = tuple(self._observations(self.possible_agents).values())
        return np.asarray(spaces.flatten(self._observed_by_all, observations))

    def reset(self, seed: Optional[int] = None, options: Optional[Dict[str, Any]] = None) -> Tuple[_PerAgent, _PerAgent]:
        """Begins an episode and returns (observations, infos), dicts by agent, of the robots that are in the world. An
        info has the values that Task.info() returns. options: a dict for Task.begin(), which finds it as
        batch.options."""
        self.batch.reset(seeds=[] if seed is None else [seed], options=options)
        self.renderer.begin(self.batch)
        is_alive = self._values_of(self.batch.core.alive)
        self.agents = [agent for agent in self.possible_agents if is_alive[agent]]
        self._met = {agent: False for agent in self.agents}
        return self._observations(self.agents), self._infos(self.agents)

    def step(self, actions: _PerAgent) -> Tuple[_PerAgent, _PerAgent, _PerAgent, _PerAgent, _PerAgent]:
        """Advances the world by one step. actions: a dict with one action per agent; the action of a missing agent is
        all zeros (in a discrete space the action with the index 0). Returns (observations, rewards, terminations,
        truncations, infos), dicts by agent, of the robots that were agents before the step and of robots born in the
        step; all dicts are empty if there are no agents. Raises TypeError for actions that are not a dict, ValueError
        for a name that is not in `agents` and for an action of a wrong shape or, in a discrete space, that is not a
        whole number, and RuntimeError before the first reset(), and before the next reset() after a step that an
        exception has ended."""
        batch = self.batch
        batch.require_reset()
        if not self.agents:
            return {}, {}, {}, {}, {}
        if not isinstance(actions, Mapping):
            raise TypeError(f"actions: found {actions!r}: give a dict with one action per agent")
        strangers = sorted(map(str, set(actions) - set(self.agents)))
        if strangers:
            raise ValueError(f"actions: found actions of {', '.join(strangers)}, which are not agents at this time; agents: {', '.join(self.agents)}")
        tables = []
        for team, space in enumerate(batch.action_spaces):
            # Not float32, the type of a Box, which would round the actions of a policy that uses float64.
            dtype = np.float64 if isinstance(space, spaces.Box) else space.dtype
            table = np.zeros((1, len(batch.names[team]), *(space.shape or ())), dtype)
            tables.append(table)
        for agent, action in actions.items():
            team, row = self._places[agent]
            tables[team][0, row] = checked(action, batch.action_spaces[team], f"action of {agent}")
        batch.step(tables)
        before = set(self.agents)
        is_alive, rewards, is_finished = map(self._values_of, (batch.core.alive, batch.core.rewards, batch.core.terminated))
        told = [agent for agent in self.possible_agents if agent in before or (agent not in self._met and is_alive[agent])]
        truncated = bool(batch.core.truncated[0])
        terminations = {agent: is_finished[agent] for agent in told}
        self._met.update(terminations)
        self.agents = [] if truncated else [agent for agent in told if not terminations[agent]]
        return (
            self._observations(told),
            {agent: rewards[agent] for agent in told},
            terminations,
            {agent: truncated for agent in told},
            self._infos(told),
        )

    def _values_of(self, array: Callable[[int], npt.NDArray[Any]]) -> _PerAgent:
        """Returns numbers or bools by possible agent: the elements of array(team), which is 1 x robots, of all
        teams."""
        rows = [array(team)[0].tolist() for team in range(len(self.batch.teams))]
        return {agent: rows[team][row] for agent, (team, row) in self._places.items()}

    def _observations(self, agents: List[str]) -> _PerAgent:
        of_teams = [self.batch.observations(team) for team in range(len(self.batch.teams))]
        places = {agent: self._places[agent] for agent in agents}
        return {agent: first_of(of_teams[team], 0, row) for agent, (team, row) in places.items()}

    def _infos(self, agents: List[str]) -> _PerAgent:
        of_teams = [self.batch.infos(team) for team in range(len(self.batch.teams))]
        places = {agent: self._places[agent] for agent in agents}
        return {agent: info_of(of_teams[team], 0, row) for agent, (team, row) in places.items()}

    def close(self) -> None:
        super().close()
        self.agents = []


def _same(space: Any) -> Any:
    """Returns a copy of the space. Each agent needs its own, because a space contains a random generator."""
    return copy.deepcopy(space)
