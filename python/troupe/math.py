"""Functions on numbers and arrays with exactly the bits of Troupe's C++: every processor and compiler gives the same.

NumPy's own sin, cos, arctan2, exp and log differ between processors in their last bits; its +, -, *, / and sqrt do not,
but its sums are taken in an order that depends on the length. So a controller that is to decide alike everywhere, or as
one in C++ does, takes these. Arrays are broadcast against one another; results are float64, and single numbers give single
numbers.
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
    """Both at once, faster than one after the other: the same bits as sin() and cos()."""
    return _sincos(np.asarray(radians, dtype=np.float64))


def ordered_sum(values: npt.ArrayLike, axis: int = -1) -> npt.NDArray[np.float64]:
    """The sum along an axis, from its first element to its last: 0 + v[0] + v[1] + ..., as a loop in C++ takes it."""
    return _ordered_sum(np.moveaxis(np.asarray(values, dtype=np.float64), axis, -1))
