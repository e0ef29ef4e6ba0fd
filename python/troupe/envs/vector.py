"""An environment with the interface of gymnasium.vector.VectorEnv: many copies of a world in parallel."""

from __future__ import annotations

from typing import Any, Dict, List, Optional, Sequence, Tuple, Union

import numpy as np
import numpy.typing as npt
from gymnasium.utils import EzPickle
from gymnasium.vector import AutoresetMode
from gymnasium.vector import VectorEnv as _VectorEnv
from gymnasium.vector.utils import batch_space

from .._core import _seed_of
from .batch import Batch, Flags, Task, require_one_team
from .render import RENDER_SIZE, Copies, Renderer, render_metadata
from .single import checked
from .team import is_whole


class VectorEnv(Copies, EzPickle, _VectorEnv[Any, Any, Any]):
    """Many copies of the world of a task. Each robot of each copy is one environment: num_envs is copies * robots, and
    environment c * robots + i is robot i of copy c.

    robot           name of a robot: only this robot learns in each copy, the others run the controllers of the world
                    file, and num_envs is the number of copies. None: all robots of the team learn
    autoreset_mode  when a copy whose episode has ended begins the next one: an AutoresetMode of Gymnasium
    max_episode_steps
                    number of steps after which an episode is truncated, if it has not reached task.seconds before
    threads         number of threads; 0: one per processor that the process may use. The number changes no result
    render_mode     rgb_array: render() returns pictures. human: the first copy runs in real time in a browser, at the
                    address that the first reset() prints
    render_size     width and height of pictures, pixels
    render_look     keyword arguments of Simulation.picture(), a dict such as {"camera": "perspective"}
    options         keyword arguments of troupe.Simulation, except threads
    episodes        the episodes of all robots of a copy end together, when all robots are finished (by Team.ends,
                    Task.terminated(), the world's `stop_when` or death) or task.seconds have passed. If several robots
                    learn in each copy, step() returns infos["finished"] and infos["alive"], one bool per environment.
                    From the step in which a robot is finished to the end of the episode, infos["finished"] is True for
                    the robot. Its rewards in the steps after that step are 0. With AutoresetMode.SAME_STEP, the step
                    that ends an episode returns these two infos of the ended episode in infos["final_info"]. If a robot
                    has not been born yet, infos["alive"] is False for the robot, its observation and its rewards are 0,
                    and its episode ends with that of its copy. The infos also have the values that Task.info() returns
    seeds           after reset(seed=s) the first episode of copy c has the seed s + c, modulo 2^64. s may also be a
                    list with one seed per copy, or, as in Gymnasium, per environment; all environments of a copy then
                    need the same seed. The seeds of later episodes of the copy are derived from this seed
    pickle          a copy of the environment, also by copy.deepcopy(), is a new environment with the same arguments,
                    which needs a reset()
    errors          TypeError if `task` is not a Task; ValueError if the task does not have exactly one team, or if
                    num_envs is not a positive multiple of the number of robots that learn in each copy; RuntimeError
                    after close(), and from step() with AutoresetMode.DISABLED if the episode of a copy has ended
    """

    def __init__(
        self,
        task: Task,
        num_envs: int,
        *,
        robot: Optional[str] = None,
        autoreset_mode: Union[str, AutoresetMode] = AutoresetMode.NEXT_STEP,
        max_episode_steps: Optional[int] = None,
        threads: int = 0,
        render_mode: Optional[str] = None,
        render_size: Tuple[int, int] = RENDER_SIZE,
        render_look: Optional[Dict[str, Any]] = None,
        **options: Any,
    ) -> None:
        EzPickle.__init__(
            self, task, num_envs, robot=robot, autoreset_mode=autoreset_mode, max_episode_steps=max_episode_steps,
            threads=threads, render_mode=render_mode, render_size=render_size,
            render_look=render_look, **options)
        require_one_team(task, "VectorEnv")
        try:
            mode = AutoresetMode(autoreset_mode)
        except ValueError:
            known = ", ".join(each.value for each in AutoresetMode)
            raise ValueError(f"unknown autoreset_mode {autoreset_mode!r}; known: {known}") from None
        if not is_whole(num_envs):
            raise ValueError(f"num_envs={num_envs!r}: give a whole number above 0")
        num_envs = int(num_envs)
        robots = 1
        if robot is None:
            robots = len(Batch(task, 1, threads=1, **options).names[0])
        if num_envs % robots:
            raise ValueError(f"num_envs={num_envs}: {robots} robots learn in each copy: give a multiple of {robots}")
        self._batch = Batch(
            task, num_envs // robots, threads=threads, robot=robot, max_episode_steps=max_episode_steps, **options)
        self.task = task
        self.num_envs = num_envs
        self.copies = num_envs // robots
        self.robots = robots
        self.render_mode = render_mode
        self.renderer = Renderer(render_mode, render_size, render_look)
        self.autoreset_mode = mode
        self.metadata = {**render_metadata(self._batch), "autoreset_mode": self.autoreset_mode}
        self.single_observation_space = self._batch.observation_spaces[0]
        self.single_action_space = self._batch.action_spaces[0]
        self.observation_space = batch_space(self.single_observation_space, num_envs)
        self.action_space = batch_space(self.single_action_space, num_envs)
        self._is_over = np.zeros(self.copies, np.bool_)

    def reset(
        self,
        *,
        seed: Union[None, int, Sequence[Optional[int]]] = None,
        options: Optional[Dict[str, Any]] = None,
    ) -> Tuple[Any, Dict[str, Any]]:
        """Begins an episode in some copies, and returns (observations, infos), one row of observations per environment.
        The infos have the values that Task.info() returns, for the copies that begin an episode. seed: see the class.
        options: a dict. Its entry "reset_mask" is an array of one bool per environment, True for all environments of
        the copies that begin an episode; without a mask, all copies begin one. Task.begin() finds the other entries in
        batch.options. Raises TypeError for options that are not a dict and for a mask that is not a NumPy array of
        bool; ValueError for a mask of a wrong shape or that marks no environment or only some robots
        of a copy, and for a list of seeds of a wrong length or with different seeds for one copy."""
        seeds = self._seeds_of(seed)  # first, because Gymnasium has other errors for wrong seeds
        if seed is None or isinstance(seed, (int, np.integer)):
            super().reset(seed=None if seed is None else int(seed))
        which = None
        if isinstance(options, dict) and "reset_mask" in options:
            which = self._copies_of(options["reset_mask"])
            options = {name: option for name, option in options.items() if name != "reset_mask"}
        self.batch.reset(which, seeds, options)
        self.renderer.begin(self.batch)
        self._is_over[slice(None) if which is None else which] = False
        begun = np.ones(self.num_envs, np.bool_) if which is None else np.repeat(which, self.robots)
        return self._rows(self.batch.observations()), self._task_infos(begun)

    def step(self, actions: Any) -> Tuple[Any, npt.NDArray[np.float64], Flags, Flags, Dict[str, Any]]:
        batch = self.batch
        begins = self._is_over
        if self.autoreset_mode == AutoresetMode.DISABLED and begins.any():
            raise RuntimeError(
                f"the episodes of copies {np.flatnonzero(begins).tolist()} have ended: call reset(options={{'reset_mask': ...}}) first"
            )
        table = checked(actions, self.action_space, "actions")
        table = table.reshape(self.copies, self.robots, *table.shape[1:])
        batch.step([table], begins if begins.any() else None)
        # At once, so that an exception in the following code loses results, but not the ends of episodes.
        self._is_over = over = batch.core.over().copy()
        terminated = batch.core.terminated().copy()
        rewards = batch.core.rewards().reshape(-1).copy()
        truncated = batch.core.truncated.copy()
        # All environments of a copy end together. If the time limit has not ended the episode, all robots in the world
        # are finished; robots that have not been born are then terminated too, because they will not be born any more.
        terminations = (over[:, np.newaxis] & (terminated | ~truncated[:, np.newaxis])).reshape(-1)
        truncations = np.repeat(truncated, self.robots)
        final: Dict[str, Any] = {}
        if self.autoreset_mode == AutoresetMode.SAME_STEP and over.any():
            final = self._final(np.repeat(over, self.robots))
            batch.reset(over)
            self._is_over = np.zeros_like(over)
        infos = self._infos(np.ones(self.num_envs, np.bool_)) | final
        return self._rows(batch.observations()), rewards, terminations, truncations, infos

    def _task_infos(self, which: Flags) -> Dict[str, Any]:
        """Returns the infos of the task of the environments marked in `which`, in the format of
        gymnasium.vector.SyncVectorEnv: 0 or False for the other environments."""
        infos: Dict[str, Any] = {}
        for name, array in self.batch.infos().items():
            infos[name] = self._rows(array)
            infos[name][~which] = 0
            infos[f"_{name}"] = which.copy()
        return infos

    def _infos(self, which: Flags) -> Dict[str, Any]:
        """Returns the infos of the task and, if several robots learn in each copy, `finished` and `alive`, in the
        format of _task_infos()."""
        infos = self._task_infos(which)
        if self.robots == 1:
            return infos
        core = self.batch.core
        return infos | {
            "finished": core.terminated().reshape(-1) & which,
            "_finished": which.copy(),
            "alive": core.alive().reshape(-1) & which,
            "_alive": which.copy(),
        }

    def _final(self, done: Flags) -> Dict[str, Any]:
        """Returns the last observations and infos of the environments marked in `done`, whose episodes are over, in the
        format of gymnasium.vector.SyncVectorEnv: one object per environment, None for the others."""
        observations = self._rows(self.batch.observations())
        final = np.full(self.num_envs, None, dtype=object)
        for env in np.flatnonzero(done):  # copies: a view would keep the observations of all environments in memory
            if isinstance(observations, dict):
                final[env] = {name: array[env].copy() for name, array in observations.items()}
            else:
                final[env] = observations[env].copy()
        infos = {"final_obs": final, "_final_obs": done.copy()}
        return infos | {"final_info": self._infos(done), "_final_info": done.copy()}

    def _rows(self, observations: Any) -> Any:
        """Reshapes observations of copies x robots to one row per environment."""
        if isinstance(observations, dict):
            return {name: self._rows(array) for name, array in observations.items()}
        return observations.reshape(self.num_envs, *observations.shape[2:])

    def _copies_of(self, mask: Any) -> Flags:
        if not isinstance(mask, np.ndarray) or mask.dtype != np.bool_:
            raise TypeError(f"options['reset_mask'] must be a NumPy array of bool, found {mask!r}")
        if mask.shape != (self.num_envs,):
            raise ValueError(f"options['reset_mask'] must have the shape ({self.num_envs},), found {mask.shape}")
        rows = mask.reshape(self.copies, self.robots)
        cut = np.flatnonzero(rows.any(axis=1) & ~rows.all(axis=1))
        if cut.size:
            first = int(cut[0]) * self.robots
            raise ValueError(
                f"options['reset_mask'] marks only some robots of copy {cut[0]}: mark all or none of environments {first} "
                f"to {first + self.robots - 1}, which share one world"
            )
        if not rows.any():
            raise ValueError("options['reset_mask'] must mark at least one environment")
        return rows[:, 0].copy()

    def _seeds_of(self, seed: Union[None, int, Sequence[Optional[int]]]) -> List[Optional[int]]:
        if seed is None:
            return []
        if isinstance(seed, (int, np.integer)):
            return [(_seed_of(seed) + copy) % 2**64 for copy in range(self.copies)]
        if isinstance(seed, str) or not hasattr(seed, "__iter__"):
            raise TypeError(f"seed: found {seed!r}: give a whole number, or a list with one seed per copy")
        seeds = [None if each is None else _seed_of(each) for each in seed]
        if len(seeds) == self.copies:
            return seeds
        if len(seeds) != self.num_envs:
            per_env = "" if self.robots == 1 else f", or {self.num_envs}, one per environment"
            raise ValueError(f"seed: found a list of {len(seeds)} seeds: give {self.copies}, one per copy{per_env}")
        for env, each in enumerate(seeds):
            first = env - env % self.robots
            if each != seeds[first]:
                raise ValueError(
                    f"seed: environments {first} and {env} share one world, but have the seeds {seeds[first]} and {each}: "
                    "give all environments of a copy the same seed"
                )
        return seeds[:: self.robots]

    def render(self) -> Optional[Tuple[npt.NDArray[np.uint8], ...]]:
        """Returns a tuple of one picture per copy, with the options `render_look`: height x width x 3, uint8, RGB. None
        unless the render mode is rgb_array."""
        return self.renderer.pictures(self.batch)

    def close_extras(self, **kwargs: Any) -> None:
        self.release()
