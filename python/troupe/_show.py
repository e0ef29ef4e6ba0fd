"""Functions of Simulation that are written in Python: films, replay pages, and pictures in notebooks."""

from __future__ import annotations

import base64
import contextlib
import html
import math
import os
import pathlib
import tempfile
from typing import Any, Iterator, Sequence, Union

from ._arguments import is_number, is_path
from ._core import InputError, Simulation, _check_output, _Film, _write_replay_page

_File = Union[str, "os.PathLike[str]"]


def _check_number(name: str, value: Any) -> None:
    if not is_number(value):
        raise TypeError(f"{name}: found {value!r}: give a number")


def _check_finite(function: str, **numbers: float) -> None:
    for name, number in numbers.items():
        _check_number(name, number)
        if not 0 < number < math.inf:
            raise ValueError(f"{function}: {name} must be a finite number above 0, found {number}")


def _path(file: Any) -> str:
    if not is_path(file):
        raise TypeError(f"file: found {file!r}: give a path")
    return os.fsdecode(file)


@contextlib.contextmanager
def _errors_name(page: str, recording: str) -> Iterator[None]:
    """Replaces the name of the recording, a temporary file, by that of the page in the errors of a block."""
    try:
        yield
    except (InputError, RuntimeError) as error:
        raise type(error)(str(error).replace(recording, page)) from None


def film(
    self: Simulation, file: _File, seconds: float, width: int = 1280, height: int = 720, *,
    speed: float = 1.0, fps: float = 30.0, **look: Any,
) -> None:
    """Steps the simulation by `seconds` of simulated time, rounded to the nearest tick, and writes a film of the run
    (.mp4; needs ffmpeg).

    width, height: size of the film, pixels. A second of the film shows `speed` simulated seconds in `fps` pictures.
    look: the keyword arguments of picture(), such as camera. Poses between two ticks are interpolated. An existing file
    is replaced when the film is complete. If a stop condition ends the run, the film ends at that time. Raises
    ValueError if `file` does not end in .mp4, or if `seconds`, `speed` or `fps` is not a finite number above 0.
    """
    _check_finite("film()", seconds=seconds, speed=speed, fps=fps)
    name = _path(file)
    if os.path.splitext(name)[1] != ".mp4":
        raise ValueError(f"film(): the name of a film must end in .mp4, found {name!r}")
    begin = self.time_s
    with _Film(self, name, speed, fps, width, height, **look) as frames:
        frames.observe()
        while self.time_s - begin < seconds - self.tick_s / 2 and not self.stopped:
            self.step()
            frames.observe()


def replay(
    self: Simulation, file: _File, seconds: float, *, every_s: float = 0.0, fields: Sequence[str] = (), replace: bool = False
) -> None:
    """Steps the simulation by `seconds` of simulated time and writes a page (.html) that plays this run in a browser.

    every_s: simulated time between two frames of the page, s. fields: names of components of the state ("stall") or of
    fields of sensors ("ranges") that the page can show in addition to poses, as in record(). If either is not given,
    the value that the world file sets under "record" is used. replace: whether an existing file is replaced. If
    `replace` is False and the file exists, raises FileExistsError before the first step. The run ends earlier if a stop
    condition holds. Raises ValueError if `seconds` is not a finite number above 0, `every_s` is not a finite number of
    0 or more or `file` does not end in .html, and TypeError if `fields` is a string.
    """
    _check_finite("replay()", seconds=seconds)
    _check_number("every_s", every_s)
    if not 0 <= every_s < math.inf:
        raise ValueError(f"replay(): every_s must be a finite number of 0 or more, found {every_s}")
    if isinstance(fields, str):
        raise TypeError(f"replay(): fields must be a list of names, as in [{fields!r}], found {fields!r}")
    names = list(fields)
    if names and "pose" not in names:
        names.append("pose")
    page = _path(file)
    if not replace and os.path.exists(page):
        raise FileExistsError(f"{page}: the file exists; replace=True replaces it")
    _check_output(self, page)
    if os.path.splitext(page)[1] != ".html":
        raise ValueError(f"replay(): the name of the page must end in .html, found {page}")
    with tempfile.TemporaryDirectory() as folder:
        recording = os.path.join(folder, "run.h5")
        with _errors_name(page, recording):
            self.record(recording, every_s=every_s, fields=names)
        try:
            self.run_for(seconds)
        finally:
            self.stop_recording()
        with _errors_name(page, recording):
            _write_replay_page(recording, page, replace)


def _png(self: Simulation, width: int, height: int, **look: Any) -> bytes:
    with tempfile.TemporaryDirectory() as folder:
        file = pathlib.Path(folder) / "picture.png"
        self.snapshot(file, width, height, **look)
        return file.read_bytes()


def show(self: Simulation, width: int = 960, height: int = 540, **look: Any) -> Any:
    """Shows a picture of the world: in a notebook below the cell, otherwise in the program that opens PNG files. width,
    height: size of the picture, pixels.

    look: the keyword arguments of snapshot(). Returns the image that the notebook displays or, outside a notebook, the
    name of a new temporary PNG file, which is not removed.
    """
    picture = _png(self, width, height, **look)
    try:
        from IPython import display, get_ipython
    except ImportError:
        get_ipython = None
    if get_ipython is not None and get_ipython() is not None:
        return display.Image(data=picture)
    with tempfile.NamedTemporaryFile(prefix="troupe-", suffix=".png", delete=False) as file:
        file.write(picture)
    import webbrowser

    webbrowser.open(pathlib.Path(file.name).as_uri())
    return file.name


def _repr_html_(self: Simulation) -> str:
    """What a notebook displays for a simulation: a picture of the world and a line of text, as HTML. If no picture can
    be drawn, for example because a step has failed or no library draws pictures, it is a text with the reason."""
    try:
        picture = base64.b64encode(_png(self, 640, 360)).decode()
    except RuntimeError as error:  # the notebook would show a traceback of the functions of this package
        return html.escape(f"A simulation of which no picture can be drawn: {error}")
    text = f"{self.title}: {self.robots} robots, {self.time_s:g} s, state {self.state_hash():016x}"
    return f'<img src="data:image/png;base64,{picture}" width="640" height="360"><br>{html.escape(text)}'


for _function in (film, replay, show, _repr_html_):
    setattr(Simulation, _function.__name__, _function)
