"""Functions on numbers and arrays with the same bits as in Troupe's C++, on every processor and compiler.

NumPy's own sin, cos, arctan2, exp and log differ between processors in their last bits; its +, -, *, / and sqrt do not,
but the order of its sums depends on the length. Use these functions for a controller that must decide the same on every
machine, or the same as one in C++. Arrays are broadcast; results are float64, and scalars for scalar arguments.
"""

from __future__ import annotations

from typing import Tuple

import numpy as np
import numpy.typing as npt

from ._core import atan2, cos, exp, log, sin, sqrt, wrap_angle
from ._core import ordered_sum as _ordered_sum
from ._core import sincos as _sincos

__all__ = ["atan2", "cos", "exp", "log", "ordered_sum", "sin", "sincos", "sqrt", "wrap_angle"]


def sincos(radians: npt.ArrayLike) -> Tuple[npt.NDArray[np.float64], npt.NDArray[np.float64]]:
    """Sine and cosine, with the bits of sin() and cos(), faster than two calls."""
    return _sincos(np.asarray(radians, dtype=np.float64))


def ordered_sum(values: npt.ArrayLike, axis: int = -1) -> npt.NDArray[np.float64]:
    """The sum along an axis in the order of a loop in C++: 0 + v[0] + v[1] + ..."""
    return _ordered_sum(np.moveaxis(np.asarray(values, dtype=np.float64), axis, -1))
