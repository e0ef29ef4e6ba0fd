"""An environment with the interface of gymnasium.Env, in which one robot learns."""

from __future__ import annotations

from typing import Any, Dict, Optional, Tuple

import gymnasium
import numpy as np
import numpy.typing as npt
from gymnasium.utils import EzPickle

from .._core import _seed_of
from .batch import Task, one_copy, require_one_team
from .render import RENDER_MODES, RENDER_SIZE, OneCopy, Renderer, render_metadata


def first_of(observations: Any, *index: int) -> Any:
    """Returns the elements at `index` of an array of observations, or of each array in a dict of observations."""
    if isinstance(observations, dict):
        return {name: array[index] for name, array in observations.items()}
    return observations[index]


def info_of(infos: Dict[str, npt.NDArray[Any]], *index: int) -> Dict[str, Any]:
    """Returns the elements at `index` of the arrays of Batch.infos(): numbers and bools of Python, or arrays."""
    return {name: array[index].item() if array.ndim == len(index) else array[index] for name, array in infos.items()}


def checked(action: Any, space: "gymnasium.Space[Any]", what: str) -> npt.NDArray[Any]:
    """Returns an action as an array. Raises ValueError unless it has the shape of the action space, and, if the space
    is discrete, consists of whole numbers. what: the name of the action in the error text."""
    given = np.asarray(action)
    shape = space.shape or ()
    if given.shape != shape:
        raise ValueError(f"{what}: must have the shape {shape}, found {given.shape}")
    if space.dtype is not None and space.dtype.kind in "iu" and given.dtype.kind not in "iu":
        raise ValueError(f"{what}: must consist of whole numbers, found {action!r}")
    return given


class Env(OneCopy, EzPickle, gymnasium.Env[Any, Any]):
    """An environment in which one robot of a task learns. The other robots run the controllers of the world file.

    robot        name of the robot that learns; None: the first robot of the team
    max_episode_steps
                 number of steps after which an episode is truncated, if it has not reached task.seconds before
    render_mode  rgb_array: render() returns a picture. human: the world runs in real time in a browser, at the address
                 that the first reset() prints
    render_size  width and height of pictures, pixels
    render_look  keyword arguments of Simulation.picture(), a dict such as {"camera": "perspective"}
    options      keyword arguments of troupe.Simulation, except threads
    seeds        reset(seed=s) begins an episode with the seed s. A later reset() without a seed begins an episode whose
                 seed is derived from s. If no seed was ever given, the first seed is the option `seed`, or else random
    pickle       a copy of the environment, also by copy.deepcopy(), is a new environment with the same arguments, which
                 needs a reset()
    options and  a dict `options` that reset() is given is passed to Task.begin(), as batch.options; the infos of
    infos        reset() and step() have the values that Task.info() returns
    errors       TypeError if `task` is not a Task; ValueError if the task has several teams; LookupError if no robot
                 has the name `robot`; RuntimeError after close()
    """

    metadata = {"render_modes": RENDER_MODES, "render_fps": 10.0}  # render_fps of an object: that of its world

    def __init__(
        self,
        task: Task,
        *,
        robot: Optional[str] = None,
        max_episode_steps: Optional[int] = None,
        render_mode: Optional[str] = None,
        render_size: Tuple[int, int] = RENDER_SIZE,
        render_look: Optional[Dict[str, Any]] = None,
        **options: Any,
    ) -> None:
        EzPickle.__init__(
            self, task, robot=robot, max_episode_steps=max_episode_steps, render_mode=render_mode, render_size=render_size,
            render_look=render_look, **options)
        require_one_team(task, "Env")
        self.task = task
        self.render_mode = render_mode
        self.renderer = Renderer(render_mode, render_size, render_look)
        if robot is None:
            robot = one_copy(task, **options).names[0][0]
        self._batch = one_copy(task, robot=robot, max_episode_steps=max_episode_steps, **options)
        self.metadata = {**self.metadata, **render_metadata(self._batch)}
        self.robot = robot
        self.observation_space = self._batch.observation_spaces[0]
        self.action_space = self._batch.action_spaces[0]

    def reset(self, *, seed: Optional[int] = None, options: Optional[Dict[str, Any]] = None) -> Tuple[Any, Dict[str, Any]]:
        if seed is not None:
            seed = _seed_of(seed)  # first, because Gymnasium has other errors for wrong seeds, and rejects NumPy's integers
        super().reset(seed=seed)
        self.batch.reset(seeds=[seed], options=options)
        self.renderer.begin(self.batch)
        return first_of(self.batch.observations(), 0, 0), info_of(self.batch.infos(), 0, 0)

    def step(self, action: Any) -> Tuple[Any, float, bool, bool, Dict[str, Any]]:
        batch = self.batch
        batch.step([checked(action, self.action_space, "action")[np.newaxis, np.newaxis]])
        return (
            first_of(batch.observations(), 0, 0),
            float(batch.core.rewards()[0, 0]),
            bool(batch.core.terminated()[0, 0]),
            bool(batch.core.truncated[0]),
            info_of(batch.infos(), 0, 0),
        )
