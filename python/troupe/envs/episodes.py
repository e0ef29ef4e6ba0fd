"""One world, many episodes."""

from __future__ import annotations

import copy
import hashlib
import json
import math
import os
from typing import Any, Dict, Optional, Union

import numpy as np
import numpy.typing as npt

from .._core import Simulation, Swarm
from .task import Task

World = Union[str, "os.PathLike[str]", Dict[str, Any]]


class Episodes:
    """Runs of a world that differ in their seeds alone.

    Robots of the task act as they are told: in a JSON world their types lose the controllers that they have there.
    """

    def __init__(self, world: World, task: Task, options: Dict[str, Any]) -> None:
        self.task = task
        self._options = dict(options)
        self._seed: Optional[int] = self._options.pop("seed", None)  # of episode 0
        self._episode = -1
        if isinstance(world, dict):
            self._world: Union[str, Dict[str, Any]] = copy.deepcopy(world)
        else:
            self._world = os.fspath(world)
        self._load(self._seed)
        if self._take_controllers_away():
            self._load(self._seed)
        if self._seed is None:
            self._seed = int(self.simulation.options["seed"])
        if len(self.swarm) == 0:
            raise ValueError("an environment needs a robot, and this world has none")
        self._loaded = self._seed
        self._last_tick = 0

    def _load(self, seed: Optional[int]) -> None:
        self.simulation = Simulation(self._world, seed=seed, **self._options)
        self.swarm: Swarm = self.simulation.swarm(self.task.robots)
        self.swarm.subscribe()

    def _take_controllers_away(self) -> bool:
        """False where there is nothing to take."""
        if isinstance(self._world, str):
            if not self._world.endswith(".json"):
                return False
            file = self._world
            if not os.path.exists(file):  # found on the search path: under that name
                return False
            with open(file, encoding="utf-8") as text:
                self._world = json.load(text)
            self._options.setdefault("name", file)
        assert isinstance(self._world, dict)
        types = self._world.get("types", {})
        taken = [types[name].pop("controller", None) for name in self.swarm.types if name in types]
        return any(controller is not None for controller in taken)

    def begin(self, seed: Optional[int]) -> None:
        """An episode with this seed, or the one that follows the last. Takes one tick, in which robots are told
        nothing, so that their sensors have looked."""
        if seed is not None:
            self._seed, self._episode = int(seed), -1
        self._episode += 1
        assert self._seed is not None
        seed = episode_seed(self._seed, self._episode)
        if seed == self._loaded:
            self.simulation.reset()
        else:
            self._load(seed)
            self._loaded = seed
        self.simulation.step()
        ticks = math.ceil(self.task.seconds / self.simulation.tick_s - 1e-9)
        self._last_tick = self.simulation.tick + ticks

    def step(self, actions: npt.NDArray[np.float64], where: npt.NDArray[np.bool_]) -> None:
        self.task.act(self.swarm, actions, where)
        self.simulation.step(self.task.ticks)

    def truncated(self) -> bool:
        return self.simulation.tick >= self._last_tick

    def observe(self) -> npt.NDArray[Any]:
        return np.array(self.task.observe(self.swarm))  # a copy: tasks may give what changes with the next step


def episode_seed(seed: int, episode: int) -> int:
    """The world's seed in an episode: `seed` itself in the first, numbers drawn from it in those that follow."""
    if episode == 0:
        return seed
    digest = hashlib.blake2b(f"{seed} {episode}".encode(), digest_size=8).digest()
    return int.from_bytes(digest, "little")
