"""Simulation of very large robot swarms, with results that have the same bits on any number of threads.

    import troupe

    simulation = troupe.Simulation("worlds/hospital.json", robots=500)
    simulation.run_for(10)
    print(f"{simulation.state_hash():016x}")

See docs/python.md. The module `troupe.math` has mathematical functions whose results have the same bits as in C++
controllers. The module `troupe.envs` has environments for reinforcement learning.
"""

import pathlib as _pathlib
import sys as _sys

try:
    import numpy as _numpy
except ModuleNotFoundError as missing:
    raise ModuleNotFoundError(
        f"{missing}: troupe needs NumPy (Debian, Ubuntu: apt install python3-numpy; pip install numpy)") from missing
try:
    from ._core import __version__  # `from . import _core` would blame a circular import if there is no such file
except ModuleNotFoundError as missing:
    _built = [_each.name for _each in _pathlib.Path(__file__).parent.glob("_core.*.so")]
    _python = f"Python {_sys.version_info[0]}.{_sys.version_info[1]}"
    raise ModuleNotFoundError(
        f"{missing}: the package was built for another Python than this one, which is {_python}: found {_built[0]}"
        if _built else
        f"{missing}: the C++ part of the package is not in this folder; build it (cmake --build build/release --target "
        "troupe_python), and import the package from build/release/lib/python3/dist-packages or from the folder in "
        "which it is installed") from missing

from . import _checkpoint, _show, math
from ._core import (
    BatchEnv,
    BatchView,
    Event,
    Events,
    Field,
    Hit,
    InputError,
    Measures,
    Model,
    Pose,
    Random,
    Recording,
    Robots,
    Simulation,
    Speed,
    StepError,
    Swarm,
    Table,
    View,
    version_line,
)
from ._files import cmake_dir, worlds_dir
from ._script import Controller, measure
from ._sweep import sweep

__all__ = [
    "BatchEnv",
    "BatchView",
    "Controller",
    "Event",
    "Events",
    "Field",
    "Hit",
    "InputError",
    "Measures",
    "Model",
    "Pose",
    "Random",
    "Recording",
    "Robots",
    "Simulation",
    "Speed",
    "StepError",
    "Swarm",
    "Table",
    "View",
    "__version__",
    "cmake_dir",
    "math",
    "measure",
    "sweep",
    "version_line",
    "worlds_dir",
]

for _name in __all__:  # messages and help() then show the public module, not troupe._core
    _thing = globals()[_name]
    if isinstance(_thing, type):
        _thing.__module__ = __name__
del _name, _numpy, _pathlib, _sys, _thing
