"""Boxes of numbers: Gymnasium's where it is installed, else a small class that does what environments need."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any, Optional, Sequence, Tuple

import numpy as np
import numpy.typing as npt


class _Box:
    """All arrays of one shape and type between two bounds, both included."""

    def __init__(
        self,
        low: npt.ArrayLike,
        high: npt.ArrayLike,
        shape: Optional[Sequence[int]] = None,
        dtype: Any = np.float32,
        seed: Optional[int] = None,
    ) -> None:
        self.dtype = np.dtype(dtype)
        self.shape: Tuple[int, ...] = tuple(shape) if shape is not None else np.shape(low)
        self.low = np.broadcast_to(np.asarray(low, self.dtype), self.shape).copy()
        self.high = np.broadcast_to(np.asarray(high, self.dtype), self.shape).copy()
        self._random = np.random.default_rng(seed)

    def seed(self, seed: Optional[int] = None) -> None:
        self._random = np.random.default_rng(seed)

    def sample(self) -> npt.NDArray[Any]:
        return self._random.uniform(self.low, self.high).astype(self.dtype).clip(self.low, self.high)

    def contains(self, x: Any) -> bool:
        x = np.asarray(x)
        return bool(
            np.can_cast(x.dtype, self.dtype) and x.shape == self.shape and (x >= self.low).all() and (x <= self.high).all()
        )

    __contains__ = contains

    def __eq__(self, other: object) -> bool:
        return (
            isinstance(other, _Box)
            and self.shape == other.shape
            and self.dtype == other.dtype
            and np.array_equal(self.low, other.low)
            and np.array_equal(self.high, other.high)
        )

    def __repr__(self) -> str:
        return f"Box({self.low.min(initial=np.inf)}, {self.high.max(initial=-np.inf)}, {self.shape}, {self.dtype})"


if TYPE_CHECKING:
    Box = _Box
else:
    try:
        from gymnasium.spaces import Box
    except ImportError:
        Box = _Box


def same(box: Box) -> Box:
    """Another box with the same bounds, to be sampled by itself."""
    return Box(low=box.low, high=box.high, dtype=box.dtype)


def stacked(box: Box, count: int) -> Box:
    """Of `count` points of a box at once."""
    shape = (count, *box.shape)
    return Box(low=np.broadcast_to(box.low, shape), high=np.broadcast_to(box.high, shape), dtype=box.dtype)
