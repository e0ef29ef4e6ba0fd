"""Draws a measure of a sweep over time: mean and standard deviation over runs, one line per value of a parameter.

`troupe plot` runs this file. In Python, call troupe.plot.draw("results", "coverage", by="robots", out="coverage.png"),
where "results" is the folder of the sweep. The module needs matplotlib and Python's standard library only.
"""

from __future__ import annotations

import argparse
import csv
import math
import os
import sys
import textwrap
from typing import Dict, List, Optional, Sequence, Set, Tuple, Union

_File = Union[str, "os.PathLike[str]"]
_Key = Tuple[str, ...]
_Points = List[Tuple[float, float, float, int]]

# The colours of Okabe and Ito, which colour-blind readers can distinguish, and black.
COLORS = ("#0072b2", "#e69f00", "#009e73", "#d55e00", "#56b4e9", "#cc79a7", "#000000", "#f0e442")
MOST_LINES = 12
LABEL_WIDTH = 36  # most characters in a line of the label of the y axis: a longer line would not fit
OWN_COLUMNS = ("run", "seed", "ticks", "time_s", "stopped_by", "state_hash", "error")


class PlotError(ValueError):
    """Raised if the requested data do not exist or cannot be drawn. The text states the reason and, if a file is
    missing, invalid or cannot be written, its name."""


def _read(file: str) -> Tuple[List[str], List[List[str]]]:
    try:
        with open(file, newline="", encoding="utf-8") as stream:
            rows = list(csv.reader(stream))
    except FileNotFoundError:
        raise PlotError(f"{file}: error: there is no such file: give the folder of a completed sweep") from None
    except (OSError, UnicodeDecodeError) as error:
        raise PlotError(f"{file}: error: cannot be read: {error}") from None
    if not rows or any(len(row) != len(rows[0]) for row in rows):
        raise PlotError(f"{file}: error: this is not a table of a sweep: it is empty, or its lines have different "
                        "numbers of columns")
    return rows[0], rows[1:]


def _known(what: str, name: str, known: Sequence[str]) -> str:
    if name not in known:
        raise PlotError(f'error: unknown {what} "{name}"; known: {", ".join(known) if known else "none"}')
    return name


def _column_of(measure: str, columns: Sequence[str]) -> str:
    """Returns the name of the column of a measure. The name of the column may contain a unit that `measure` lacks: the
    measure displacement:leaders has the column displacement_m:leaders. Raises PlotError if there is no such column."""
    name, _, of = measure.partition(":")
    with_unit = [column for column in columns
                 if column.startswith(f"{name}_") and "_" not in column[len(name) + 1:].split(":")[0]
                 and column.partition(":")[2] == of]
    # A measure of a script has a colon in its own name: my:reach has the column my:reach_m.
    with_unit += [column for column in columns if of and column.startswith(f"{measure}_") and "_" not in column[len(measure) + 1:]]
    return with_unit[0] if measure not in columns and len(with_unit) == 1 else _known("measure", measure, columns)


def _number(text: str) -> Optional[float]:
    try:
        return float(text)
    except ValueError:
        return None


def _order(value: _Key) -> List[Tuple[int, float, str]]:
    """Returns a sort key for the values of parameters: numbers come first, in ascending order, and then texts."""
    numbers = [_number(part) for part in value]
    return [(0, number, "") if number is not None else (1, 0.0, part) for number, part in zip(numbers, value)]


def _stray_ends(runs: Sequence[Sequence[float]]) -> Set[float]:
    """Returns the times at which only runs that end there have a sample, although another run has samples before and
    after this time. A condition of `stop_when` ends a run at any time, and a mean of these runs alone would look like a
    jump of the line. runs: for each run of a line, the times of its samples, in ascending order."""
    ends = {times[-1] for times in runs} - {time_s for times in runs for time_s in times[:-1]}
    return {end for end in ends if any(times[0] < end < times[-1] for times in runs)}


def series_by(folder: _File, measure: Optional[str] = None,
              by: Optional[str] = None) -> Tuple[str, List[str], Dict[_Key, _Points]]:
    """Reads the tables of a sweep and averages a measure over its runs.

    folder   the folder of the sweep
    measure  name of the measure, with or without its unit; None: the first measure in series.csv
    by       names of parameters, separated by commas; runs with equal values of these parameters are averaged to one
             line. None: all parameters that have several values
    returns  the name of the measure, the names of the parameters that distinguish the lines, and a dict from their
             values to the points of a line: a list of (time_s, mean, sample standard deviation, number of runs) in the
             order of time. The deviation has the divisor n - 1; it is 0 for one run. NaN values of the measure are left
             out, and so is the last sample of a run that `stop_when` ended between two samples of another run of the
             line
    errors   PlotError if a table is missing or invalid, if a measure or parameter does not exist, if the measure has no
             value in any run, or if there are more than 12 lines
    """
    table_head, table = _read(os.path.join(folder, "table.csv"))
    series_file = os.path.join(folder, "series.csv")
    if not os.path.exists(series_file):
        raise PlotError(f'{series_file}: error: there is no such file: set "series": true in the study, and run the sweep again')
    head, series = _read(series_file)
    if head[:2] != ["run", "time_s"] or len(head) < 3:
        raise PlotError(f"{series_file}: error: this is not the series of a sweep: it must begin with run,time_s")
    if "run" not in table_head or "seed" not in table_head:
        raise PlotError(f"{os.path.join(folder, 'table.csv')}: error: this is not the table of a sweep: it "
                        "must have the columns run and seed")
    measure = _column_of(measure, head[2:]) if measure else head[2]
    parameters = table_head[1:table_head.index("seed")]
    values = {row[0]: dict(zip(table_head, row)) for row in table}
    if by is None:
        names = [name for name in parameters if len({row[name] for row in values.values()}) > 1]
    else:
        names = [_known("parameter", name, parameters) for name in by.split(",")]

    column = head.index(measure)
    lines: Dict[_Key, Dict[float, List[float]]] = {}
    sampled: Dict[_Key, Dict[str, List[float]]] = {}  # for each line and run, the times of the samples
    for row in series:
        number = _number(row[column])
        time_s = _number(row[1])
        if number is None or time_s is None or row[0] not in values:
            raise PlotError(f"{series_file}: error: this is not the series of the sweep in table.csv: a run is not in "
                            "that table, or a value is not a number")
        key = tuple(values[row[0]][name] for name in names)
        sampled.setdefault(key, {}).setdefault(row[0], []).append(time_s)
        if not math.isnan(number):
            lines.setdefault(key, {}).setdefault(time_s, []).append(number)
    if len(lines) > MOST_LINES:
        raise PlotError(f"error: one line per value of {' and '.join(names)} gives {len(lines)} lines, but a plot has "
                        f"at most {MOST_LINES}: select fewer parameters with --by (in Python: by), from: {', '.join(parameters)}")
    if not lines:
        raise PlotError(f'error: the measure "{measure}" has no value in any run')
    result: Dict[_Key, _Points] = {}
    for key in sorted(lines, key=_order):
        result[key] = []
        regular = set(lines[key]) - _stray_ends(list(sampled[key].values()))
        for time_s in sorted(regular or lines[key]):  # a line has at least one point
            numbers = lines[key][time_s]
            mean = math.fsum(numbers) / len(numbers)
            spread = math.fsum((number - mean) ** 2 for number in numbers)
            result[key].append((time_s, mean, math.sqrt(spread / max(len(numbers) - 1, 1)), len(numbers)))
    return measure, names, result


def draw(folder: _File, measure: Optional[str] = None, by: Optional[str] = None, out: Optional[_File] = None,
         title: Optional[str] = None) -> str:
    """Draws a measure of a sweep into a .png, .svg or .pdf file and returns the name of the file. folder, measure, by:
    as in series_by(). out: name of the file; None: MEASURE.png in the folder. title: title of the plot; None: no title.
    Raises PlotError in the cases of series_by(), if the name has another ending, and if the file cannot be written;
    raises ImportError if matplotlib is missing."""
    measure, names, lines = series_by(folder, measure, by)
    file = os.fspath(out) if out else os.path.join(folder, f"{measure}.png")
    if os.path.splitext(file)[1] not in (".png", ".svg", ".pdf"):
        raise PlotError(f'error: "{file}" is not the name of a picture: it must end in .png, .svg or .pdf')
    import matplotlib

    matplotlib.use("Agg")
    from matplotlib import pyplot

    figure, axes = pyplot.subplots(figsize=(6.4, 4.0), constrained_layout=True)
    for i, (key, points) in enumerate(lines.items()):
        times, means, deviations, _ = zip(*points)
        color = COLORS[i % len(COLORS)]
        style = "-" if i < len(COLORS) else "--"
        label = ", ".join(f"{name} = {value}" for name, value in zip(names, key))
        axes.plot(times, means, style, color=color, label=label or None, linewidth=1.6)
        axes.fill_between(times, [m - d for m, d in zip(means, deviations)], [m + d for m, d in zip(means, deviations)],
                          color=color, alpha=0.18, linewidth=0)
    most = max(runs for points in lines.values() for *_, runs in points)
    axes.set_xlabel("time (s)")
    label = f"{measure}, mean and standard deviation" if most > 1 else measure
    axes.set_ylabel(textwrap.fill(label, LABEL_WIDTH))
    axes.grid(color="0.9")
    axes.set_axisbelow(True)
    if names:
        axes.legend(frameon=False, title=None if most == 1 else f"{most} runs per line")
    if title:
        axes.set_title(title)
    try:
        figure.savefig(file, dpi=150)
    except OSError as error:
        raise PlotError(f"{file}: error: cannot be written: {error.strerror}") from None
    finally:
        pyplot.close(figure)
    return file


def main(arguments: Optional[Sequence[str]] = None) -> int:
    parser = argparse.ArgumentParser(prog="troupe plot", description=__doc__.splitlines()[0])
    parser.add_argument("folder")
    parser.add_argument("--measure")
    parser.add_argument("--by")
    parser.add_argument("--out")
    parser.add_argument("--title")
    given = parser.parse_args(arguments)
    try:
        print(draw(given.folder, given.measure, given.by, given.out, given.title))
    except PlotError as error:
        text = str(error)
        print(text if not text.startswith("error:") else f"troupe plot: {text}", file=sys.stderr)
        return 2
    except ImportError as error:
        print(f"troupe plot: error: {sys.executable} cannot import matplotlib: {error} (Debian, Ubuntu: apt install "
              "python3-matplotlib; elsewhere: pip install matplotlib; the environment variable TROUPE_PYTHON selects "
              "another python3)", file=sys.stderr)
        return 1
    return 0


if __name__ == "__main__":
    if sys.path and sys.path[0] == "":
        del sys.path[0]  # set by python3 -c: do not import modules from the current folder
    sys.exit(main())
