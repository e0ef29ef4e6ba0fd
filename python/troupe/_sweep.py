"""troupe.sweep(): makes all runs of a study in this process."""

from __future__ import annotations

import concurrent.futures
import json
import math
import operator
import os
import threading
import traceback
import warnings
from typing import TYPE_CHECKING, Any, Dict, List, Mapping, Optional, Sequence, Tuple, Union

from . import _core
from ._json import text_of, without_lines
from .plot import rounded_time_s

if TYPE_CHECKING:
    import pandas

Rows = Tuple[Dict[str, Any], List[Dict[str, Any]]]

#: The keyword arguments of Simulation() that sweep() passes on.
_OPTIONS = ("robots", "ranging", "search_path", "plugin_path", "controllers", "tile_size_m", "ranks")


def _statistic(name: str, values: List[float]) -> float:
    if name == "last":
        return values[-1] if values else math.nan
    known = [value for value in values if not math.isnan(value)]
    if not known:
        return math.nan
    if name == "mean":
        total = 0.0
        for value in known:  # in the order in which `troupe sweep` adds, because sum() may round differently
            total += value
        return total / len(known)
    return min(known) if name == "min" else max(known)


def _column(measure: str, statistic: str) -> str:
    return measure if statistic == "last" else f"{measure}_{statistic}"


def _wanted(measures: Sequence[str]) -> List[Union[str, Dict[str, Any]]]:
    return [json.loads(measure) if measure.startswith("{") else measure for measure in measures]


def _without_lines(error: _core.InputError, name: str, below: str = "") -> _core.InputError:
    """Returns an error whose findings name only JSON pointers, not lines of a text that is not a file."""
    return _core.InputError(without_lines(str(error), name, below))


def _load(world: Any, name: str, study: Dict[str, Any], index: int, options: Dict[str, Any]) -> _core.Simulation:
    """Returns the world of the run with this index."""
    texts, seed = study["runs"][index]
    # Pairs, not a dict: several parameters may append to the same list, that is, have the same pointer.
    settings = [(pointer, json.loads(text)) for (_, pointer), text in zip(study["parameters"], texts)]
    if not isinstance(world, Mapping):
        return _core.Simulation(world, threads=1, seed=seed, set=settings, **options)
    try:
        return _core.Simulation(dict(world), threads=1, seed=seed, set=settings, name=name, **options)
    except _core.InputError as error:
        raise _without_lines(error, name, below="/world") from None


def _first_world(world: Any, name: str, study: Dict[str, Any], options: Dict[str, Any]) -> _core.Simulation:
    """Returns the world of the first run whose world can be loaded, as first_world() of `troupe sweep` does: of a large
    study, it tries only some runs. Raises the InputError of run 0 if it finds no such run."""
    first: Optional[_core.InputError] = None
    index = 0
    while index < len(study["runs"]):
        try:
            return _load(world, name, study, index, options)
        except _core.InputError as error:
            first = first or error
        index += 1 + index // 4
    assert first is not None  # because a study has at least one run
    raise first


def _end_time_s(world: Any, name: str, study: Dict[str, Any], simulation: _core.Simulation) -> float:
    """Returns the end time of a run. Raises InputError if neither the study nor the world of the run has one."""
    end_s: Optional[float] = study["for_s"] if study["for_s"] is not None else simulation.quit_time_s
    if end_s is None:
        file = name if isinstance(world, Mapping) else world
        raise _core.InputError(
            f'{file}: error: no end time: give "for_s" in the study, or set quit_time_s in the world (quit_time in a .world)')
    return end_s


def _make(world: Any, name: str, study: Dict[str, Any], index: int, options: Dict[str, Any],
          has_ended: threading.Event) -> Rows:
    """Makes the run with this index. Raises CancelledError if `has_ended` is set: the caller no longer needs the
    run."""
    simulation = _load(world, name, study, index, options)
    seed = simulation.seed
    values = [json.loads(text) for text in study["runs"][index][0]]
    measures = _core.Measures(simulation, _wanted(study["measures"]))
    end_s = _end_time_s(world, name, study, simulation)
    end = _core._ticks_until(end_s, simulation.tick_s)
    every = _core._period_ticks(study["measure_every_s"], simulation.tick_s)
    looks: List[List[float]] = []
    series: List[Dict[str, Any]] = []
    head = {"run": index, **dict(zip((parameter for parameter, _ in study["parameters"]), values))}

    def look() -> None:
        looks.append(list(measures.values()))
        if study["series"]:
            series.append({**head, "seed": seed, "time_s": rounded_time_s(simulation.time_s), **dict(zip(measures.columns, looks[-1]))})

    look()
    while simulation.tick < end and not simulation.stopped:
        if has_ended.is_set():
            raise concurrent.futures.CancelledError
        simulation.step()
        measures.see()
        if simulation.tick % every == 0 or simulation.tick == end or simulation.stopped:
            look()
    row: Dict[str, Any] = {**head, "seed": seed, "ticks": simulation.tick, "time_s": rounded_time_s(simulation.time_s)}
    for k, column in enumerate(measures.columns):
        for statistic in study["statistics"]:
            row[_column(column, statistic)] = _statistic(statistic, [values[k] for values in looks])
    row["stopped_by"] = simulation.stopped or ""
    row["state_hash"] = f"{simulation.state_hash():016x}"
    return row, series


def _check_failures(failed: Dict[int, Exception], runs: int) -> None:
    """Raises the exception of the first failed run if all runs of a series have failed, and warns if some have."""
    if not failed:
        return
    first = min(failed)
    if len(failed) == runs:
        raise failed[first]
    warnings.warn(
        f"{len(failed)} of {runs} runs failed and have no rows in this series: run{'' if len(failed) == 1 else 's'} "
        f"{_core._runs_text(sorted(failed))}. Run {first}: {failed[first]}", RuntimeWarning, stacklevel=3)


def _thread_count(threads: Any) -> int:
    """Returns the number of threads for the argument `threads` of sweep()."""
    try:
        count = 0 if threads is None else operator.index(threads)
    except TypeError:
        raise TypeError(f"threads: found {threads!r}: give a whole number from 0, or None") from None
    if count < 0:
        raise ValueError(f"threads: found {count}: give a whole number from 0, or None")
    return count or len(os.sched_getaffinity(0))


def _read(study: Any, name: Union[str, "os.PathLike[str]"], options: Mapping[str, Any]) -> Tuple[Any, Any, str]:
    """Reads the arguments `study`, `name` and `options` of sweep(). Returns the study, its world (a dict or the name of
    a file), and the name of its file; for a dict, this is `name`."""
    world: Any = None
    kinds = {option: options[option] for option in ("plugin_path", "controllers") if option in options}
    if isinstance(study, Mapping):
        document = dict(study)
        file = os.fspath(name)
        if isinstance(document.get("world"), Mapping):
            world = document["world"]
            document["world"] = file
        world_text = None if world is None else text_of(dict(world), "/world")
        try:
            read = _core._read_study(file, text_of(document), world_text, **kinds)
        except _core.InputError as error:
            raise _without_lines(error, file) from None
    elif isinstance(study, (str, bytes, os.PathLike)):
        file = os.fsdecode(study)
        read = _core._read_study(file, **kinds)
    else:
        raise TypeError(f"study: found {study!r}: give a dict or a path")
    return read, read["world"] if world is None else world, file


def _make_all(world: Any, name: str, read: Any, options: Dict[str, Any], runs_at_once: int
              ) -> Tuple[List[Dict[str, Any]], List[Dict[str, Any]], Dict[int, Exception]]:
    """Makes all runs. Returns the rows of sweep(), its rows with `series`, and the exceptions of failed runs by
    index."""
    rows: List[Dict[str, Any]] = []
    looks: List[Dict[str, Any]] = []
    failed: Dict[int, Exception] = {}
    with concurrent.futures.ThreadPoolExecutor(runs_at_once) as pool:
        has_ended = threading.Event()
        futures: List["concurrent.futures.Future[Rows]"] = []
        try:
            for index in range(len(read["runs"])):
                futures.append(pool.submit(_make, world, name, read, index, options, has_ended))
            for index, future in enumerate(futures):
                try:
                    row, made = future.result()
                    rows.append({**row, "error": ""})
                    looks += made
                except Exception as error:  # a plug-in may raise anything
                    traceback.clear_frames(error.__traceback__)  # they hold the world of the run
                    failed[index] = error
                    texts, _ = read["runs"][index]
                    values = {parameter: json.loads(text) for (parameter, _), text in zip(read["parameters"], texts)}
                    seed = read["seed_of"](index, read["world_seed"])
                    rows.append({"run": index, **values, "seed": seed, "ticks": 0, "stopped_by": "", "state_hash": "",
                                 "error": str(error)})
        except BaseException:
            has_ended.set()  # else Ctrl-C would wait for the end of the running runs
            for future in futures:
                future.cancel()
            raise
    return rows, looks, failed


def sweep(study: Union[str, "os.PathLike[str]", Mapping[str, Any]], *, series: Optional[bool] = None,
          threads: Optional[int] = None, name: Union[str, "os.PathLike[str]"] = "dict.json",
          **options: Any) -> "pandas.DataFrame":
    """Makes all runs of a study and returns a pandas data frame. Each run uses one thread; several runs are made in
    parallel.

    study    the name of a study file (docs/sweeps.md), or a dict with the content of a study file, whose "world" may be
             a file name or a dict
    series   True: the result has the measures over time, one row per sample, instead of one row per run. None: the
             value of "series" in the study
    threads  number of parallel runs; None or 0: one per processor that the process may use
    name     if `study` is a dict: the file name that error messages show, with a JSON pointer. Relative paths in
             the dict are resolved from the folder in this name
    options  keyword arguments of Simulation() for all runs, such as search_path and plugin_path; not threads, seed, set
             and name, which the study or this function determines
    returns  one row per run with the columns run, the parameters, seed, ticks, time_s, the measures, stopped_by,
             state_hash and error. With series: one row per sample, with the columns run, the parameters, seed, time_s
             and the measures. Without "measures" in the study, the first world that can be loaded determines the
             columns; a measure that the world of another run does not have is NaN
    errors   InputError for an invalid study; if the world of no run can be loaded: the error of the first run; and if
             neither the study nor the first world that can be loaded has an end time. If runs fail later, the column
             `error` of their rows states the reason. In a series, a failed run has no rows: a RuntimeWarning lists the
             failed runs and the first error, and if all runs fail, the exception of the first run is raised. TypeError
             for an unknown keyword argument. ImportError if pandas is missing
    """
    for option in options:
        if option not in _OPTIONS:
            known = ["series", "threads", "name", *_OPTIONS]
            raise TypeError(f'sweep() has no keyword argument "{option}"; known: {", ".join(known)}')
    try:
        import pandas
    except ImportError as missing:
        raise ImportError("troupe.sweep() needs pandas (Debian, Ubuntu: apt install python3-pandas; pip install pandas)") from missing
    runs_at_once = _thread_count(threads)
    read, world, name = _read(study, name, options)
    if series is not None:
        read["series"] = series

    # Errors of the study or of the worlds of all runs are raised here, as `troupe sweep` does before its first run;
    # errors of single runs become rows.
    first = _first_world(world, name, read, options)
    columns = list(_core.Measures(first, _wanted(read["measures"])).columns)
    _end_time_s(world, name, read, first)
    read["check_columns"](columns)
    read["world_seed"] = first.seed
    del first
    rows, looks, failed = _make_all(world, name, read, options, runs_at_once)
    # Without `columns`, the first row would determine the order, and other worlds could add measures.
    head = ["run", *(parameter for parameter, _ in read["parameters"]), "seed"]
    if read["series"]:
        _check_failures(failed, len(read["runs"]))
        return pandas.DataFrame(looks, columns=[*head, "time_s", *columns])
    results = [_column(column, statistic) for column in columns for statistic in read["statistics"]]
    return pandas.DataFrame(rows, columns=[*head, "ticks", "time_s", *results, "stopped_by", "state_hash", "error"])
