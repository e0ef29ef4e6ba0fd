"""Mathematical functions of numbers and arrays whose results have the same bits as in Troupe's C++ code.

Results are also the same on every processor and with every compiler. The results of NumPy's sin, cos, arctan2, exp and
log differ between processors in their last bits. Those of NumPy's +, -, *, / and sqrt do not differ, but the order in
which NumPy's sum() adds depends on the length of the array. Use the functions of this module for a controller that must
make the same decisions on every machine, or the same decisions as a controller in C++. Angles are in radians. Array
arguments are broadcast. Results are float64 arrays, or numbers if all arguments are numbers; sincos() and ordered_sum()
always return arrays.
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
    """Returns (sine, cosine) of angles in radians, as float64 arrays of the shape of the argument. Their bits are those
    of sin() and cos(), but one call is faster than two."""
    return _sincos(radians)


def ordered_sum(values: npt.ArrayLike, axis: int = -1) -> npt.NDArray[np.float64]:
    """Returns the sums of an array along an axis, added in ascending order of the index: 0 + v[0] + v[1] + ... The
    result has the shape of the array without this axis; the sum of no numbers is 0. Raises NumPy's AxisError, an
    IndexError, if the array has no such axis; a single number has none."""
    return _ordered_sum(np.moveaxis(np.asarray(values, dtype=np.float64), axis, -1))
