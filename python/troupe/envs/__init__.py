"""Environments for reinforcement learning in any world, with the interfaces of Gymnasium and PettingZoo.

    import gymnasium
    import troupe.envs

    env = gymnasium.make("troupe/Navigation-v0")                              # one robot learns
    envs = troupe.envs.VectorEnv(troupe.envs.Navigation(), num_envs=8 * 64)   # 64 copies of a world of 8 robots
    env = troupe.envs.ParallelEnv(troupe.envs.Navigation())                   # one agent per robot

All environments need the package gymnasium; ParallelEnv also needs pettingzoo. See docs/learning.md.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Any, Optional

try:
    import gymnasium as _gymnasium
except ImportError as _error:
    raise ImportError("troupe.envs needs the package gymnasium: pip install gymnasium pettingzoo") from _error
if not hasattr(_gymnasium.vector, "AutoresetMode"):
    raise ImportError(
        f"troupe.envs needs Gymnasium 1.1 or later, found {_gymnasium.__version__}: pip install --upgrade gymnasium"
    )

from .batch import Batch, Task
from .single import Env
from .tasks import TASKS, Aggregation, Dispersion, Flocking, Foraging, Navigation, Pursuit
from .team import Team
from .vector import VectorEnv

if TYPE_CHECKING:
    from .parallel import ParallelEnv

__all__ = [
    "Aggregation", "Batch", "Dispersion", "Env", "Flocking", "Foraging", "Navigation", "ParallelEnv", "Pursuit", "TASKS",
    "Task", "Team", "VectorEnv",
]

_OF_TASK = ("robots", "size")


def make_env(task: str, **options: Any) -> Env:
    """Makes an environment of the task named `task` (a key of TASKS), for gymnasium.make(). Passes the options `robots`
    (number of robots) and `size` (side of the room, m) to the task, and other options to Env."""
    own = {key: options.pop(key) for key in _OF_TASK if key in options}
    return Env(TASKS[task](**own), **options)


def make_vector_env(task: str, num_envs: int, robot: Optional[str] = "r0", **options: Any) -> VectorEnv:
    """Makes an environment of the task named `task` (a key of TASKS), for gymnasium.make_vec(). In each copy of the
    world, only the robot named `robot` learns; with robot=None, all robots learn. Passes the options `robots` (number
    of robots) and `size` (side of the room, m) to the task, and other options to VectorEnv."""
    own = {key: options.pop(key) for key in _OF_TASK if key in options}
    return VectorEnv(TASKS[task](**own), num_envs, robot=robot, **options)


for _task in TASKS:
    _id = f"troupe/{_task}-v0"
    if _id not in _gymnasium.registry:
        _gymnasium.register(
            id=_id,
            entry_point="troupe.envs:make_env",
            vector_entry_point="troupe.envs:make_vector_env",
            kwargs={"task": _task},
        )


def __getattr__(name: str) -> Any:
    if name != "ParallelEnv":
        raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
    try:
        from .parallel import ParallelEnv
    except ImportError as error:
        raise ImportError("troupe.envs.ParallelEnv needs the package pettingzoo: pip install pettingzoo") from error
    return ParallelEnv
