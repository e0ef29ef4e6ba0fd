"""JSON texts of worlds, studies and settings that a program gives as Python values."""

import json
from typing import Any

import numpy as np


def _plain(value: Any) -> Any:
    if isinstance(value, (np.generic, np.ndarray)):
        return value.tolist()
    raise TypeError(f"a {type(value).__name__} has no counterpart in JSON: give a dict, a list, a text, a number, a bool, "
                    f"None or a NumPy array; found {value!r}")


def text_of(value: Any, **options: Any) -> str:
    """Returns the JSON text of a value, which may contain NumPy numbers and arrays. options: those of json.dumps().
    Raises TypeError if the value has no counterpart in JSON, and ValueError for a number that is not finite."""
    return json.dumps(value, allow_nan=False, default=_plain, **options)
