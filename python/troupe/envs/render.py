"""The render modes of the environments: rgb_array (pictures) and human (the running world in a browser)."""

from __future__ import annotations

import sys
import tempfile
from typing import Any, Dict, Optional, Tuple

import numpy as np
import numpy.typing as npt

from .._core import BatchView, Simulation
from .batch import Batch
from .team import is_whole

RENDER_MODES = ["human", "rgb_array"]
RENDER_SIZE = (480, 480)
#: Keyword arguments of Simulation.picture() that the argument `render_look` of environments may have.
_LOOK = ("camera", "layers", "center_m", "angle_rad", "across_m", "color_by", "color_range", "background")


def render_metadata(batch: Batch) -> Dict[str, Any]:
    """Returns the entries of the metadata of an environment about pictures. A film with one picture per step shows the
    world in real time if it has `render_fps` pictures per second, the number of steps in a second of simulated time."""
    return {"render_modes": RENDER_MODES, "render_fps": 1.0 / batch.step_s}


def _check_pictures() -> None:
    """Draws a small picture of an empty world, so that a missing library (a wheel contains no OSMesa and no EGL) is
    reported before the training begins and not by its first picture. Raises RuntimeError if pictures cannot be
    drawn."""
    try:
        Simulation({"troupe": 1}, threads=1).picture(width=16, height=16)
    except RuntimeError as error:
        raise RuntimeError(f'render_mode="rgb_array": {error}') from None


def _checked_size(size: Any) -> Tuple[int, int]:
    """Returns the argument `render_size`, width and height, as whole numbers. Raises ValueError for any other value."""
    sides = list(size) if isinstance(size, (list, tuple, np.ndarray)) else []
    if len(sides) != 2 or not all(map(is_whole, sides)):
        raise ValueError(f"render_size={size!r}: give the width and the height of pictures, whole numbers of pixels from 1")
    return int(sides[0]), int(sides[1])


def _checked_look(look: Any) -> Dict[str, Any]:
    """Returns the argument `render_look` as a dict. Raises TypeError unless it is None or a dict with names in
    _LOOK."""
    if look is not None and (not isinstance(look, dict) or not set(look) <= set(_LOOK)):
        raise TypeError(f"render_look={look!r}: give a dict of options of pictures; known: {', '.join(_LOOK)}")
    return dict(look or {})


class Renderer:
    """Renders the copies of the world of a batch.

    mode  rgb_array: picture() returns pictures. human: from the first episode on, the first copy is shown in a browser
          and runs in real time. None: nothing is rendered
    size  width and height of pictures, pixels
    look  keyword arguments of Simulation.picture(), such as camera; None: none

    Raises ValueError for an unknown mode or a wrong size, TypeError for a look with unknown names, and RuntimeError,
    which names the package to install, if the mode is rgb_array and pictures cannot be drawn.
    """

    def __init__(self, mode: Optional[str], size: Tuple[int, int], look: Optional[Dict[str, Any]]) -> None:
        if mode is not None and mode not in RENDER_MODES:
            raise ValueError(f'unknown render_mode "{mode}"; known: {", ".join(RENDER_MODES)}')
        self.size = _checked_size(size)
        self.look = _checked_look(look)
        if mode == "rgb_array":
            _check_pictures()
        self.mode = mode
        self._view: Optional[BatchView] = None
        self._sessions: Optional[tempfile.TemporaryDirectory[str]] = None  # folder of the session files of the view

    @property
    def address(self) -> Optional[str]:
        """Address of the page that the mode `human` shows, with read-only access; None before the first episode and in
        other modes."""
        return None if self._view is None else self._view.read_only_address

    def begin(self, batch: Batch) -> None:
        """Shows the first copy if the mode is human and no page shows it yet. Call it after an episode has begun: the
        seed of the episode determines the poses of the bodies, which the page must show. The page is read-only, because
        users must not change the world that a policy learns in."""
        if self.mode != "human" or self._view is not None:
            return
        self._sessions = tempfile.TemporaryDirectory(prefix="troupe-")
        self._view = batch.core.view(out=self._sessions.name)
        print(f"troupe: the world is shown at {self.address}", file=sys.stderr, flush=True)

    def pictures(self, batch: Batch) -> Optional[Tuple[npt.NDArray[np.uint8], ...]]:
        """Returns one picture per copy, height x width x 3, uint8, RGB, or None if the mode is not rgb_array."""
        if self.mode != "rgb_array":
            return None
        return tuple(batch.core.picture(copy, *self.size, **self.look) for copy in range(batch.copies))

    def close(self) -> None:
        if self._view is not None:
            self._view.close()
            self._view = None
        if self._sessions is not None:
            self._sessions.cleanup()
            self._sessions = None


class Copies:
    """The members that all environments share: the copies of the world and their renderer."""

    renderer: Renderer
    _batch: Optional[Batch] = None

    @property
    def batch(self) -> Batch:
        """The Batch with the copies of the world, which this environment uses. Raises RuntimeError after close()."""
        if self._batch is None:
            raise RuntimeError("this environment was closed: create another one")
        return self._batch

    def release(self) -> None:
        """Releases the copies of the world and their page in a browser. close() calls this function."""
        self.renderer.close()
        self._batch = None


class OneCopy(Copies):
    """The members that the environments with one copy of the world share."""

    def render(self) -> Optional[npt.NDArray[np.uint8]]:
        """Returns a picture of the world, with the options `render_look`: height x width x 3, uint8, RGB. None unless
        the render mode is rgb_array."""
        pictures = self.renderer.pictures(self.batch)
        return None if pictures is None else pictures[0]

    def close(self) -> None:
        self.release()
