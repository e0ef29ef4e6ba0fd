"""Environments with the vector interface of Gymnasium: many worlds side by side."""

from __future__ import annotations

from concurrent.futures import ThreadPoolExecutor
from enum import Enum
from typing import TYPE_CHECKING, Any, Callable, Dict, List, Optional, Sequence, Tuple, Union

import numpy as np
import numpy.typing as npt

from .. import math
from .._core import Simulation, processors_allowed
from .episodes import Episodes, World
from .spaces import stacked
from .task import Task


class _AutoresetMode(Enum):
    NEXT_STEP = "NextStep"
    SAME_STEP = "SameStep"
    DISABLED = "Disabled"


class _VectorEnv:
    """What gymnasium.vector.VectorEnv gives to those who derive from it."""

    metadata: Dict[str, Any] = {}
    spec: Any = None
    render_mode: Optional[str] = None
    closed = False
    num_envs: int

    _np_random: Optional[np.random.Generator] = None
    _np_random_seed: Optional[int] = None

    def reset(self, *, seed: Optional[int] = None, options: Optional[Dict[str, Any]] = None) -> Any:
        if seed is not None:
            self._np_random, self._np_random_seed = np.random.default_rng(seed), seed

    def close(self, **kwargs: Any) -> None:
        if not self.closed:
            self.close_extras(**kwargs)
            self.closed = True

    def close_extras(self, **kwargs: Any) -> None:
        pass

    @property
    def np_random(self) -> np.random.Generator:
        if self._np_random is None:
            self._np_random, self._np_random_seed = np.random.default_rng(0), 0
        return self._np_random

    @np_random.setter
    def np_random(self, value: np.random.Generator) -> None:
        self._np_random, self._np_random_seed = value, -1

    @property
    def np_random_seed(self) -> Optional[int]:
        if self._np_random_seed is None:
            self._np_random, self._np_random_seed = np.random.default_rng(0), 0
        return self._np_random_seed

    @property
    def unwrapped(self) -> Any:
        return self

    def __repr__(self) -> str:
        return f"{type(self).__name__}(num_envs={self.num_envs})"


if TYPE_CHECKING:
    _Base = _VectorEnv
    AutoresetMode = _AutoresetMode
else:
    try:
        from gymnasium.vector import VectorEnv as _Base
    except ImportError:
        _Base = _VectorEnv
    try:
        from gymnasium.vector import AutoresetMode  # from 1.1 on
    except ImportError:
        AutoresetMode = _AutoresetMode

_Flags = npt.NDArray[np.bool_]


class VectorEnv(_Base):
    """So many copies of a world, each with a seed of its own; one policy drives all robots of the task in each.

    world         a file or a dict, as of troupe.Simulation, whose options follow
    task          what is learnt; by default Task(), which is to disperse
    spaces        a row a robot; of a task of one robot its numbers alone, without an axis for robots
    rewards       the mean of those of the robots that are there
    episodes      of one copy end after task.seconds, or when the task is done for all its robots; the step after begins
                  the next (autoreset NEXT_STEP: that step's action is not looked at, its reward is 0)
    seeds         copy i has seed + i, or the i-th of a list, in its first episode, and numbers drawn from that in
                  those that follow. Without any seed the world's own counts: nothing is drawn from the clock
    workers       copies that are stepped at once; 0: one for each processor that it may use. It changes no result
    """

    _pool: Optional[ThreadPoolExecutor] = None
    metadata = {"name": "troupe_v0", "render_modes": ["rgb_array"], "autoreset_mode": AutoresetMode.NEXT_STEP}

    def __init__(
        self,
        world: World,
        num_envs: int,
        task: Optional[Task] = None,
        *,
        render_mode: Optional[str] = None,
        workers: int = 0,
        **options: Any,
    ) -> None:
        if num_envs < 1:
            raise ValueError(f"num_envs={num_envs}: give 1 or more")
        if render_mode not in (None, "rgb_array"):
            raise ValueError(f'unknown render_mode "{render_mode}"; known: rgb_array')
        self.num_envs = num_envs
        self.render_mode = render_mode
        self.task = Task() if task is None else task
        options.setdefault("threads", 1)
        first = Episodes(world, self.task, options)
        seed = int(first.simulation.options["seed"])
        others = [Episodes(world, self.task, {**options, "seed": seed + i}) for i in range(1, num_envs)]
        self._copies = [first, *others]
        self._pool = ThreadPoolExecutor(min(num_envs, workers or processors_allowed()), "troupe-env")

        self._robots = len(first.swarm)
        self._is_single = self._robots == 1
        observation_space = self.task.observation_space(first.swarm)
        action_space = self.task.action_space(first.swarm)
        self._action_shape = action_space.shape
        if not self._is_single:
            observation_space = stacked(observation_space, self._robots)
            action_space = stacked(action_space, self._robots)
        self.single_observation_space = observation_space
        self.single_action_space = action_space
        self.observation_space = stacked(observation_space, num_envs)
        self.action_space = stacked(action_space, num_envs)
        self._is_over = np.ones(num_envs, np.bool_)  # until the first reset
        self._was_reset = False

    @property
    def simulations(self) -> List[Simulation]:
        """The troupe.Simulation of each copy."""
        return [copy.simulation for copy in self._copies]

    def reset(
        self, *, seed: Union[None, int, Sequence[Optional[int]]] = None, options: Optional[Dict[str, Any]] = None
    ) -> Tuple[npt.NDArray[Any], Dict[str, Any]]:
        """Observations and infos. There are no options: they are not looked at."""
        super().reset(seed=seed if isinstance(seed, (int, np.integer)) else None)
        seeds: Sequence[Optional[int]]
        if seed is None:
            seeds = [None] * self.num_envs
        elif isinstance(seed, (int, np.integer)):
            seeds = [int(seed) + i for i in range(self.num_envs)]
        else:
            seeds = list(seed)
            if len(seeds) != self.num_envs:
                raise ValueError(f"{len(seeds)} seeds for {self.num_envs} environments")
        self._for_all(lambda i: self._copies[i].begin(seeds[i]))
        self._is_over[:] = False
        self._was_reset = True
        return self._observations(), {}

    def step(self, actions: npt.ArrayLike) -> Tuple[npt.NDArray[Any], npt.NDArray[np.float64], _Flags, _Flags, Dict[str, Any]]:
        """Observations, rewards, terminations, truncations, infos. Throws ValueError for actions of another shape than
        the action space's, and for such that are no finite numbers."""
        if not self._was_reset:
            raise RuntimeError("reset() comes before the first step()")
        table = np.asarray(actions, np.float64)
        if table.shape != self.action_space.shape or not np.isfinite(table).all():
            raise ValueError(f"actions: give finite numbers of shape {self.action_space.shape}, not {actions!r}")
        rows = table.reshape(self.num_envs, self._robots, *self._action_shape)
        begins = self._is_over.copy()
        rewards = np.zeros(self.num_envs)
        terminations = np.zeros(self.num_envs, np.bool_)
        truncations = np.zeros(self.num_envs, np.bool_)
        everybody = np.ones(self._robots, np.bool_)

        def step_one(i: int) -> None:
            copy = self._copies[i]
            if begins[i]:
                copy.begin(None)
                return
            copy.step(rows[i], everybody)
            alive = copy.swarm.alive()
            there = max(int(alive.sum()), 1)
            rewards[i] = math.ordered_sum(np.where(alive, self.task.reward(copy.swarm), 0.0)) / there
            terminations[i] = bool((self.task.terminated(copy.swarm) | ~alive).all())
            truncations[i] = copy.truncated()

        self._for_all(step_one)
        self._is_over = terminations | truncations
        return self._observations(), rewards, terminations, truncations, {}

    def _for_all(self, work: Callable[[int], None]) -> None:
        if self._pool is None:
            raise RuntimeError("this environment was closed")
        list(self._pool.map(work, range(self.num_envs)))

    def _observations(self) -> npt.NDArray[Any]:
        observations: npt.NDArray[Any] = np.stack([copy.observe() for copy in self._copies])
        return observations[:, 0] if self._is_single else observations

    def render(self) -> Optional[Tuple[npt.NDArray[np.uint8], ...]]:
        """The copies from above, height x width x 3 each, where the render mode is rgb_array."""
        if self.render_mode is None:
            return None
        return tuple(copy.simulation.picture() for copy in self._copies)

    def close_extras(self, **kwargs: Any) -> None:
        if self._pool is not None:
            self._pool.shutdown()
        self._pool = None
        self._copies = []
        self._was_reset = False
