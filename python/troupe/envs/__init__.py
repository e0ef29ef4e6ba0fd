"""Environments for reinforcement learning, of any world.

    import troupe.envs

    env = troupe.envs.ParallelEnv("worlds/hospital.json", robots=50)   # an agent a robot, as in PettingZoo
    envs = troupe.envs.VectorEnv("worlds/hospital.json", 8, robots=1)  # so many worlds side by side, as in Gymnasium

What robots observe, do and are rewarded for says a Task (docs/python.md). Neither package is needed; where they are
installed, the classes derive from theirs.
"""

from .parallel import ParallelEnv
from .spaces import Box
from .task import Task
from .vector import AutoresetMode, VectorEnv

__all__ = ["AutoresetMode", "Box", "ParallelEnv", "Task", "VectorEnv"]
