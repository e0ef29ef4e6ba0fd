"""Draws a measure of a sweep, over time or over the values of a parameter: mean and standard deviation over runs, mean
and confidence interval, or median and quartiles. Draws also the fraction of the runs that a condition of `stop_when`
ended.

`troupe plot` runs this file. In Python, call troupe.plot.draw("results", "coverage", by="robots", out="coverage.png"),
where "results" is the folder of the sweep. The module needs matplotlib and Python's standard library only.
"""

from __future__ import annotations

import argparse
import bisect
import csv
import difflib
import errno
import functools
import io
import math
import os
import shutil
import sys
import textwrap
import warnings
from typing import Any, Callable, Dict, List, Mapping, Optional, Sequence, Set, TextIO, Tuple, Union

_File = Union[str, "os.PathLike[str]"]
_Key = Tuple[str, ...]
_Points = List[Tuple[float, float, float, int]]
# A mean, median or fraction, and the lengths of its bar below and above; NaN: there is no bar.
_Summary = Tuple[float, float, float]
_Drawn = List[Tuple[float, float, float, float, int]]  # points of a line: x, the three numbers of a summary, number of runs

# The colours of Okabe and Ito, which colour-blind readers can distinguish, and black.
COLORS = ("#0072b2", "#e69f00", "#009e73", "#d55e00", "#56b4e9", "#cc79a7", "#000000", "#f0e442")
MOST_LINES = 12
LARGEST = 1e300  # largest value in a plot: matplotlib computes limits of the axes that exceed the values
LABEL_WIDTH = 36  # most characters in a line of the label of the y axis: a longer line would not fit
TITLE_WIDTH = 56  # most characters in a line of the title, of the label of the x axis and of the legend
TICK_WIDTH = 24  # most characters in a line of a text at a tick of the x axis
MOST_LEVEL = 60  # most characters of all texts at ticks together; more are written upwards, as they would overlap
MOST_OF_NAME = 48  # most characters of a name or a value in the legend and at a tick
OWN_COLUMNS = ("run", "seed", "ticks", "time_s", "stopped_by", "state_hash", "error")
NORMAL_QUANTILE = 1.959963984540054  # 97.5 % of a normally distributed variable are below this number of deviations
MOST_DEGREES = 1000  # more degrees of freedom count as 1000: the quantile of the t distribution is then 0.1 % too large


class PlotError(ValueError):
    """Raised if the requested data do not exist or cannot be drawn. The text states the reason and, if a file is
    missing, invalid or cannot be written, its name."""


def _read(file: str) -> Tuple[List[str], List[List[str]]]:
    if os.path.exists(file) and not os.path.isfile(file):  # opening a pipe could block for ever
        raise PlotError(f"{file}: error: cannot be read: this is not a regular file")
    longest = csv.field_size_limit(sys.maxsize)  # an error of a run may be longer than the default limit
    try:
        with open(file, newline="", encoding="utf-8") as stream:
            lines = stream.readlines()
            rows = list(csv.reader(lines))
    except FileNotFoundError:
        raise PlotError(f"{file}: error: there is no such file: give the folder of a completed sweep") from None
    except (OSError, UnicodeDecodeError, csv.Error) as error:
        raise PlotError(f"{file}: error: cannot be read: {error}") from None
    finally:
        csv.field_size_limit(longest)
    if not rows or any(len(row) != len(rows[0]) for row in rows):
        raise PlotError(f"{file}: error: this is not a table of a sweep: it is empty, or its lines have different "
                        "numbers of columns")
    if not lines[-1].endswith(("\n", "\r")):
        raise PlotError(f"{file}: error: the file was cut off: its last line has no end: copy the file again, or give the command "
                        "of the sweep again, which writes the tables again")
    return rows[0], rows[1:]


def _known(what: str, name: str, known: Sequence[str]) -> str:
    if name not in known:
        near = difflib.get_close_matches(name, known, 1)
        raise PlotError(f'error: unknown {what} "{name}"; known: {", ".join(sorted(known)) if known else "none"}'
                        + (f' (did you mean "{near[0]}"?)' if near else ""))
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


def rounded_time_s(time_s: float) -> float:
    """Returns a simulated time as the tables of `troupe` contain it: rounded to 12 significant digits, so that the same
    time in runs with different lengths of ticks is one number."""
    return float(f"{time_s:.12g}")


def _order(value: _Key) -> List[Tuple[int, float, str]]:
    """Returns a sort key for the values of parameters: numbers come first, in ascending order, and then texts."""
    numbers = [_number(part) for part in value]
    return [(0, number, "") if number is not None else (1, 0.0, part) for number, part in zip(numbers, value)]


def _stray_ends(runs: Sequence[Sequence[float]]) -> Set[float]:
    """Returns the times at which only runs that end there have a sample, although another run has samples before and
    after this time. A condition of `stop_when` ends a run at any time, and a mean of these runs alone would look like a
    jump of the line. runs: for each run of a line, the times of its samples, in ascending order."""
    ends = {times[-1] for times in runs} - {time_s for times in runs for time_s in times[:-1]}
    spans = sorted((times[0], times[-1]) for times in runs)
    starts = [start for start, _ in spans]
    latest = [-math.inf]  # of the first i spans
    for _, end in spans:
        latest.append(max(latest[-1], end))
    return {end for end in ends if latest[bisect.bisect_left(starts, end)] > end}


class _Table:
    """The table of a sweep, and its rows by the number of the run."""

    def __init__(self, folder: _File):
        if not isinstance(folder, (str, os.PathLike)):
            raise TypeError(f"folder: found a {type(folder).__name__}: give the name of the folder of a completed sweep")
        if not os.path.exists(folder):
            raise PlotError(f"{folder}: error: there is no such folder: give the folder of a completed sweep")
        if not os.path.isdir(folder):
            raise PlotError(f"{folder}: error: this is a file: give the folder of a completed sweep")
        self.file = os.path.join(folder, "table.csv")
        self.head, rows = _read(self.file)
        if "run" not in self.head or "seed" not in self.head:
            raise PlotError(f"{self.file}: error: this is not the table of a sweep: it must have the columns run and seed")
        self.parameters = self.head[1:self.head.index("seed")]
        self.rows = {row[0]: dict(zip(self.head, row)) for row in rows}

    def varying(self, by: Optional[str], without: Optional[str] = None) -> List[str]:
        """Returns the parameters that distinguish the lines: those of `by`, none if `by` is empty, or else all that
        vary. without: the parameter of the x axis, if there is one; then only those that vary between runs with the
        same value of this parameter."""
        if by == "" and by not in self.parameters:
            return []
        if by is not None:
            listed = [by] if by in self.parameters else next(csv.reader([by]), [])
            names = [_known("parameter", name, self.parameters) for name in listed or [by]]
            if without in names:
                raise PlotError(f'error: the parameter "{without}" is on the x axis, so it cannot distinguish lines: leave it out '
                                "of --by (in Python: by)")
            return names
        # Without parameters that vary together with the one on the x axis, as each line would have one point.
        of_axis = {run: row[without] if without is not None else "" for run, row in self.rows.items()}
        return [name for name in self.parameters
                if len({(of_axis[run], row[name]) for run, row in self.rows.items()}) > len(set(of_axis.values()))]

    def key_of(self, run: str, names: Sequence[str]) -> _Key:
        return tuple(self.rows[run][name] for name in names)

    def number(self, run: str, column: str) -> float:
        text = self.rows[run][column]
        number = _number(text)
        if number is None:
            raise PlotError(f'{self.file}: error: "{text}" is not a number, in the column {column} of run {run}')
        return number

    def stopped(self, measure: str) -> Dict[str, bool]:
        """Returns for each run, except failed runs, whether a condition of `stop_when` ended it. measure: "stopped_by"
        for any condition, or "stopped_by:CONDITION" for the condition with this text."""
        _known("column", "stopped_by", self.head)
        condition = measure.partition(":")[2]
        stops = {run: row["stopped_by"] for run, row in self.rows.items() if not row.get("error")}
        if condition:
            _known("condition", condition, sorted(set(stops.values()) - {""}))
        return {run: stop == condition if condition else stop != "" for run, stop in stops.items()}


def _warn_of_failed_runs(folder: _File) -> None:
    table = _Table(folder)
    failed = [run for run, row in table.rows.items() if row.get("error")]
    if failed:
        warnings.warn(f"{table.file}: warning: {len(failed)} of {len(table.rows)} runs failed and are not in the plot; run "
                      f"{failed[0]}: {table.rows[failed[0]]['error']}", RuntimeWarning, stacklevel=3)


def _check_lines(lines: Mapping[_Key, object], measure: str, names: Sequence[str], parameters: Sequence[str]) -> None:
    if len(lines) > MOST_LINES:
        raise PlotError(f"error: one line per value of {' and '.join(names)} gives {len(lines)} lines, but a plot has "
                        f"at most {MOST_LINES}: select fewer parameters with --by (in Python: by), from: {', '.join(parameters)}; "
                        "or none, with --by ''")
    if not lines:
        raise PlotError(f'error: the measure "{measure}" has no value in any run')


def _average(numbers: Sequence[float]) -> Tuple[float, float, int]:
    """Returns the mean, the sample standard deviation (0 for one number) and how many numbers there are. With infinite
    numbers, the deviation is NaN, and the mean is infinite, or NaN if the numbers have both signs. The deviation is
    infinite if it exceeds the largest float."""
    count = len(numbers)
    if not all(map(math.isfinite, numbers)):
        return sum(numbers) / count, math.nan, count
    try:
        mean = math.fsum(numbers) / count
    except OverflowError:  # of the sum, not of the mean
        mean = math.fsum(number / count for number in numbers)
    # The squares of large deviations are infinite; hypot() scales them.
    return mean, math.hypot(*(number - mean for number in numbers)) / math.sqrt(max(count - 1, 1)), count


def _deviation(numbers: Sequence[float]) -> _Summary:
    mean, deviation, count = _average(numbers)
    bar = deviation if count > 1 else math.nan  # a bar of 0 would look like runs with equal results
    return mean, bar, bar


def _within(t: float, degrees: int) -> float:
    """Returns the probability that a variable with Student's t distribution is between -t and t. degrees: the degrees
    of freedom, at least 1. Source: Abramowitz and Stegun, Handbook of Mathematical Functions, 1964, 26.7.3 and
    26.7.4."""
    angle = math.atan2(t, math.sqrt(degrees))
    is_odd = degrees % 2 == 1
    term = math.cos(angle) if is_odd else 1.0
    total = 0.0
    for exponent in range(degrees % 2, degrees - 1, 2):  # of the cosine in the term
        total += term
        term *= math.cos(angle) ** 2 * (exponent + 1) / (exponent + 2)
    within = math.sin(angle) * total
    return 2 / math.pi * (angle + within) if is_odd else within


@functools.lru_cache(maxsize=None)
def _t_quantile(degrees: int) -> float:
    """Returns the 97.5 % quantile of Student's t distribution, for up to MOST_DEGREES degrees of freedom."""
    low, high = 0.0, 13.0  # the largest quantile, that of one degree, is 12.7
    middle = high / 2
    while low < middle < high:
        if _within(middle, degrees) < 0.95:
            low = middle
        else:
            high = middle
        middle = (low + high) / 2
    return middle


def _interval(numbers: Sequence[float]) -> _Summary:
    """Returns the mean with the confidence interval of the mean for a level of 95 %: Student, The probable error of a
    mean, Biometrika 6, 1908. It assumes normally distributed numbers or means."""
    mean, deviation, count = _average(numbers)
    half = _t_quantile(min(count - 1, MOST_DEGREES)) * deviation / math.sqrt(count) if count > 1 else math.nan
    return mean, half, half


def _quantile(ordered: Sequence[float], share: float) -> float:
    """Returns a quantile of numbers in ascending order, interpolated linearly between the two nearest numbers:
    definition 7 of Hyndman and Fan, Sample quantiles in statistical packages, The American Statistician 50, 1996, which
    NumPy and R use by default."""
    place = share * (len(ordered) - 1)
    below = int(place)
    part = place - below
    if part == 0 or ordered[below] == ordered[below + 1]:
        return ordered[below]
    return (1 - part) * ordered[below] + part * ordered[below + 1]


def _quartiles(numbers: Sequence[float]) -> _Summary:
    """Returns the median, with a bar from the first to the third quartile unless one of these is infinite."""
    ordered = sorted(numbers)
    first, median, third = (_quantile(ordered, share) for share in (0.25, 0.5, 0.75))
    if len(ordered) == 1 or not math.isfinite(third - first):
        return median, math.nan, math.nan
    return median, median - first, third - median


def _fraction(hits: float, count: int) -> _Summary:
    """Returns the fraction `hits` of `count` runs, with its confidence interval for a level of 95 %: the score interval
    of Wilson, Probable inference, the law of succession, and statistical inference, Journal of the American Statistical
    Association 22, 1927. It exists for any number of runs, and is within 0 to 1."""
    fraction = hits / count
    z2 = NORMAL_QUANTILE**2
    middle = (hits + z2 / 2) / (count + z2)
    half = NORMAL_QUANTILE / (count + z2) * math.sqrt(hits * (count - hits) / count + z2 / 4)
    # Without max(), rounding could give negative lengths for 0 hits and for `count` hits.
    return fraction, max(fraction - middle + half, 0.0), max(middle + half - fraction, 0.0)


def _fraction_of(numbers: Sequence[float]) -> _Summary:
    return _fraction(sum(numbers), len(numbers))


# What draw() shows of the runs at a point: the words in the label, and the function that computes it.
BARS: Dict[str, Tuple[str, Callable[[Sequence[float]], _Summary]]] = {
    "deviation": ("mean and standard deviation", _deviation),
    "interval": ("mean and 95 % confidence interval", _interval),
    "quartiles": ("median and quartiles", _quartiles),
}


def _is_fraction(measure: Optional[str]) -> bool:
    return measure is not None and measure.partition(":")[0] == "stopped_by"


def _series(folder: _File, measure: Optional[str], by: Optional[str]
            ) -> Tuple[str, List[str], Dict[_Key, List[Tuple[float, List[float]]]]]:
    """Reads what series_by() averages: for each line, the times and the values of the runs at each time."""
    table = _Table(folder)
    series_file = os.path.join(folder, "series.csv")
    if not os.path.exists(series_file):
        raise PlotError(f'{series_file}: error: there is no such file: set "series": true in the study, and run the sweep again; '
                        "or plot results at the end of the runs against a parameter, with --over (in Python: over)")
    head, series = _read(series_file)
    if head[:2] != ["run", "time_s"] or len(head) < 3:
        raise PlotError(f"{series_file}: error: this is not the series of a sweep: it must begin with run,time_s")
    measure = _column_of(measure, head[2:]) if measure else head[2]
    names = table.varying(by)

    column = head.index(measure)
    lines: Dict[_Key, Dict[float, List[float]]] = {}
    sampled: Dict[_Key, Dict[str, List[float]]] = {}  # for each line and run, the times of the samples
    for row in series:
        number = _number(row[column])
        time_s = _number(row[1])
        if number is None or time_s is None or row[0] not in table.rows:
            raise PlotError(f"{series_file}: error: this is not the series of the sweep in table.csv: a run is not in "
                            "that table, or a value is not a number")
        time_s = rounded_time_s(time_s)  # earlier versions wrote times without rounding
        key = table.key_of(row[0], names)
        sampled.setdefault(key, {}).setdefault(row[0], []).append(time_s)
        if not math.isnan(number):
            lines.setdefault(key, {}).setdefault(time_s, []).append(number)
    _check_lines(lines, measure, names, table.parameters)
    result: Dict[_Key, List[Tuple[float, List[float]]]] = {}
    for key in sorted(lines, key=_order):
        regular = set(lines[key]) - _stray_ends(list(sampled[key].values()))
        times = sorted(regular or lines[key])  # a line has at least one point
        result[key] = [(time_s, lines[key][time_s]) for time_s in times]
    return measure, names, result


def series_by(folder: _File, measure: Optional[str] = None,
              by: Optional[str] = None) -> Tuple[str, List[str], Dict[_Key, _Points]]:
    """Reads the tables of a sweep and averages a measure over its runs, at each time.

    folder   the folder of the sweep
    measure  name of the measure, with or without its unit; None: the first measure in series.csv
    by       names of parameters, separated by commas; runs with equal values of these parameters are averaged to one
             line. A name that contains a comma is in double quotes, as in CSV, unless it is the only name. An empty
             text: one line averages all runs. None: all parameters that have several values
    returns  the name of the measure, the names of the parameters that distinguish the lines, and a dict from their
             values to the points of a line: a list of (time_s, mean, sample standard deviation, number of runs) in the
             order of time. The deviation has the divisor n - 1; it is 0 for one run. NaN values of the measure are left
             out, and so is the last sample of a run that `stop_when` ended between two samples of another run of the
             line
    errors   PlotError if a table is missing or invalid, if a measure or parameter does not exist, if the measure has no
             value in any run, or if there are more than 12 lines
    """
    measure, names, lines = _series(folder, measure, by)
    return measure, names, {key: [(time_s, *_average(numbers)) for time_s, numbers in points] for key, points in lines.items()}


def _results(folder: _File, over: str, measure: Optional[str], by: Optional[str]
             ) -> Tuple[str, List[str], Dict[_Key, List[Tuple[str, List[float]]]]]:
    """Reads what final_by() averages: for each line, the values of `over` and the results of the runs at each value."""
    table = _Table(folder)
    _known("parameter", over, table.parameters)
    columns = [name for name in table.head[len(table.parameters) + 1:] if name not in OWN_COLUMNS]
    if not measure and not columns:
        raise PlotError(f"{table.file}: error: the table has no measure")
    if measure is not None and _is_fraction(measure):
        numbers = {run: float(stopped) for run, stopped in table.stopped(measure).items()}
    else:
        measure = _column_of(measure, [*columns, "time_s"]) if measure else columns[0]
        numbers = {run: table.number(run, measure) for run, row in table.rows.items() if not row.get("error")}
    names = table.varying(by, without=over)

    lines: Dict[_Key, Dict[_Key, List[float]]] = {}
    for run, number in numbers.items():
        if not math.isnan(number):
            lines.setdefault(table.key_of(run, names), {}).setdefault((table.rows[run][over],), []).append(number)
    _check_lines(lines, measure, names, table.parameters)
    return measure, names, {key: [(value[0], lines[key][value]) for value in sorted(lines[key], key=_order)]
                            for key in sorted(lines, key=_order)}


def _stops(folder: _File, measure: str, by: Optional[str]) -> Tuple[str, List[str], Dict[_Key, _Drawn]]:
    """Reads for each line which fraction of the runs conditions of `stop_when` have ended up to each time. measure: as
    that of _Table.stopped(). A line ends at the first end of a run that no condition ended: from then on, it is unknown
    whether a condition would have ended this run."""
    table = _Table(folder)
    names = table.varying(by)
    stopped = table.stopped(measure)
    lines: Dict[_Key, List[str]] = {}
    for run in stopped:
        lines.setdefault(table.key_of(run, names), []).append(run)
    _check_lines(lines, measure, names, table.parameters)
    ends = {run: table.number(run, "time_s") for run in stopped}
    result: Dict[_Key, _Drawn] = {}
    for key in sorted(lines, key=_order):
        runs = lines[key]
        last = min((ends[run] for run in runs if not table.rows[run]["stopped_by"]), default=max(ends.values()))
        hits = {0.0: 0}  # number of ended runs, from this time on
        for i, end in enumerate(sorted(ends[run] for run in runs if stopped[run] and ends[run] <= last)):
            hits[end] = i + 1
        hits[last] = max(hits.values())
        result[key] = [(time_s, *_fraction(count, len(runs)), len(runs)) for time_s, count in hits.items()]
    return measure, names, result


def final_by(folder: _File, over: str, measure: Optional[str] = None,
             by: Optional[str] = None) -> Tuple[str, List[str], Dict[_Key, List[Tuple[str, float, float, int]]]]:
    """Reads the table of a sweep and averages one of its results over the runs, at each value of a parameter.

    folder   the folder of the sweep
    over     name of the parameter of the x axis
    measure  a column of results in table.csv: a measure, with or without its unit, or a statistic of a measure
             (coverage_mean); also time_s, the simulated time at which a run ended, and stopped_by, which is 1 for a
             run that a condition of `stop_when` ended and 0 for any other run. With stopped_by:CONDITION, only runs
             that the condition with this text ended are 1. None: the first measure
    by       as in series_by(), but without `over`. None: all parameters that have several values in runs with the same
             value of `over`
    returns  the name of the column, the names of the parameters that distinguish the lines, and a dict from their
             values to the points of a line: a list of (value of `over` as in the table, mean, sample standard
             deviation, number of runs). Numbers come first, in ascending order, then other values. Runs that failed
             and runs whose value is NaN are left out
    errors   as those of series_by(); also PlotError if `over` is in `by`
    """
    measure, names, lines = _results(folder, over, measure, by)
    return measure, names, {key: [(value, *_average(numbers)) for value, numbers in points] for key, points in lines.items()}


def _positions(lines: Mapping[_Key, Sequence[Tuple[str, List[float]]]]) -> Tuple[Dict[str, float], bool]:
    """Returns the position on the x axis of each value of a parameter, and whether these are the values themselves:
    values that are not all numbers up to LARGEST are placed side by side, in the order of their lines."""
    values = sorted({(value,) for points in lines.values() for value, _ in points}, key=_order)
    numbers = [_number(value[0]) for value in values]
    if all(number is not None and abs(number) <= LARGEST for number in numbers):
        return {value[0]: number for value, number in zip(values, numbers) if number is not None}, True
    return {value[0]: float(i) for i, value in enumerate(values)}, False


def _finite(lines: Mapping[_Key, _Drawn], measure: str) -> Dict[_Key, _Drawn]:
    """Returns the points whose mean or median is finite, and the lines that have such points. Raises PlotError if there
    are none, or if a point is too large for a plot."""
    finite = {key: [point for point in points if math.isfinite(point[1])] for key, points in lines.items()}
    finite = {key: points for key, points in finite.items() if points}
    if not finite:
        raise PlotError(f'error: the measure "{measure}" has only infinite values, which a plot cannot show')
    if any(abs(center) > LARGEST or abs(center) + max(below, above) > LARGEST
           for points in finite.values() for _, center, below, above, _ in points):
        raise PlotError(f'error: the measure "{measure}" has values above {LARGEST:g}, which a plot cannot show')
    return finite


def _positive(lines: Mapping[_Key, _Drawn], over: Optional[str], measure: str, log: Tuple[bool, bool],
              file: str) -> Dict[_Key, _Drawn]:
    """Returns the points that logarithmic axes can show: those above 0. Warns if others are left out, but not of points
    at the time 0, which each series has. Raises PlotError if there is no such point. over: parameter of the x axis;
    None: the time. log: whether the x and the y axis are logarithmic. file: the table of the points, for the warning"""
    for column, (is_log, option, name) in enumerate(zip(log, ("log-x", "log-y"), (over or "the time", measure))):
        if not is_log:
            continue
        values = [point[column] for points in lines.values() for point in points]
        lines = {key: [point for point in points if point[column] > 0] for key, points in lines.items()}
        lines = {key: points for key, points in lines.items() if points}
        what = f'values of "{name}"'
        if not lines:
            raise PlotError(f"error: all {what if column == 1 or over else 'times'} are 0 or negative, so they cannot be on a "
                            f"logarithmic axis: leave out --{option} (in Python: {option.replace('-', '_')})")
        missing = sum(value <= 0 for value in values)
        if missing and (column == 1 or over):
            warnings.warn(f"{file}: warning: {missing} of {len(values)} points are not in the plot, because their {what} are 0 "
                          "or negative and the axis is logarithmic", RuntimeWarning, stacklevel=3)
    return dict(lines)


def _literal(text: str) -> str:
    """Returns the text for a label in which matplotlib draws dollar signs, instead of a formula between them."""
    return text.replace("$", r"\$")


def _short(text: str) -> str:
    """Returns the text; of a long one its beginning and its end, which often distinguish names of files."""
    half = MOST_OF_NAME // 2
    return text if len(text) <= MOST_OF_NAME else f"{text[:half - 1]}…{text[-half:]}"


def _rounded(value: str) -> str:
    """Returns the value of a parameter, with a fraction rounded to 12 significant digits: equally spaced values have
    rounding errors, as in 0.30000000000000004."""
    number = _number(value)
    return value if number is None or "." not in value else f"{number:.12g}"


def _write(file: str, content: bytes) -> None:
    """Writes a file by way of a temporary file in the same folder. Raises OSError if this fails, for example because
    the disk is full; a file that exists then keeps its content. A device or a pipe is written directly."""
    file = os.path.realpath(file)  # a symbolic link remains
    is_special = os.path.exists(file) and not os.path.isfile(file)
    partial = file if is_special else f"{file}.{os.getpid()}.partial"
    try:
        with open(partial, "wb") as stream:
            stream.write(content)
        if is_special:
            return
        if os.path.exists(file):
            open(file, "ab").close()  # fails if the file is write-protected
            shutil.copymode(file, partial)
        os.replace(partial, file)
    finally:
        if not is_special and os.path.exists(partial):
            os.remove(partial)


def _file_of_plot(folder: _File, out: Optional[_File], measure: str, over: Optional[str]) -> str:
    """Returns the name of the file that draw() writes. Raises PlotError if it may not write a file of this name."""
    default = f"{measure}.png" if over is None else f"{measure}-over-{over}.png"
    file = os.fspath(out) if out else os.path.join(folder, default.replace(os.sep, "-"))
    if os.path.splitext(file)[1] not in (".png", ".svg", ".pdf"):
        raise PlotError(f'error: "{file}" is not the name of a picture: it must end in .png, .svg or .pdf')
    tables = [os.path.join(folder, name) for name in ("table.csv", "series.csv")]
    if any(os.path.exists(file) and os.path.exists(table) and os.path.samefile(file, table) for table in tables):
        raise PlotError(f"{file}: error: cannot be written: it is a table of the sweep: choose another file name")
    return file


def _save(figure: Any, file: str, title: Optional[str]) -> None:
    """Writes a figure with this title into a file. Raises PlotError if this fails."""
    import matplotlib

    picture = io.BytesIO()
    ending = os.path.splitext(file)[1][1:]
    # By default, these formats store the present time, and .svg also random names.
    no_date = {"pdf": {"CreationDate": None}, "svg": {"Date": None}}.get(ending)
    try:
        with matplotlib.rc_context({"svg.hashsalt": "troupe"}):
            figure.savefig(picture, dpi=150, format=ending, metadata=no_date)
        _write(file, picture.getvalue())
    except OSError as error:
        into = os.path.dirname(file)
        reason = f"there is no folder {into}" if into and not os.path.exists(into) else error.strerror
        raise PlotError(f"{file}: error: cannot be written: {reason}") from None
    except ValueError:  # all other texts are literal
        raise PlotError(f'error: the title "{title}" has dollar signs, but matplotlib cannot draw the text between them as a '
                        r"formula: write \$ for a dollar sign") from None


def _lines_to_draw(folder: _File, measure: Optional[str], by: Optional[str], over: Optional[str], bars: Optional[str],
                   log_x: bool) -> Tuple[str, List[str], Dict[_Key, _Drawn], Optional[Dict[str, float]]]:
    """Returns the name of the measure, the names of the parameters that distinguish the lines, the lines and, if the
    values of `over` are not numbers, their positions on the axis. The parameters are those of draw()."""
    _, summary = BARS[_known("kind of bars", "deviation" if bars is None else bars, list(BARS))]
    is_fraction = _is_fraction(measure)
    if is_fraction and bars not in (None, "interval"):
        raise PlotError(f'error: the bars of the measure "{measure}" cannot be "{bars}", because a fraction of runs is drawn '
                        "with its confidence interval: leave out --bars (in Python: bars)")
    lines: Dict[_Key, _Drawn]
    if over is not None:
        measure, names, results = _results(folder, over, measure, by)
        positions, are_numbers = _positions(results)
        if log_x and not are_numbers:
            raise PlotError(f'error: the parameter "{over}" has values that are not numbers or exceed {LARGEST:g}, so they '
                            "cannot be on a logarithmic axis: leave out --log-x (in Python: log_x)")
        if is_fraction:
            summary = _fraction_of
        lines = {key: [(positions[value], *summary(numbers), len(numbers)) for value, numbers in points]
                 for key, points in results.items()}
        return measure, names, lines, None if are_numbers else positions
    if measure is not None and is_fraction:
        return *_stops(folder, measure, by), None
    measure, names, series = _series(folder, measure, by)
    lines = {key: [(time_s, *summary(numbers), len(numbers)) for time_s, numbers in points] for key, points in series.items()}
    return measure, names, lines, None


def _draw_band(axes: Any, points: _Drawn, style: str, in_steps: bool, look: Mapping[str, Any]) -> None:
    """Draws a line over time, and a band around it."""
    at, centers, below, above, _ = zip(*points)
    dot = "o" if len(at) == 1 else None  # a line through one point would be invisible
    axes.plot(at, centers, style, marker=dot, drawstyle="steps-post" if in_steps else "default", **look)
    axes.fill_between(at, [c - b for c, b in zip(centers, below)], [c + a for c, a in zip(centers, above)],
                      color=look["color"], alpha=0.18, linewidth=0, step="post" if in_steps else None)


def _draw_bars(axes: Any, points: _Drawn, style: str, look: Mapping[str, Any]) -> None:
    """Draws points with bars, and a line between them."""
    at, centers, below, above, _ = zip(*points)
    lengths = [below, above] if any(map(math.isfinite, below)) else None  # matplotlib 3.6 fails if all bars are NaN
    axes.errorbar(at, centers, lengths, elinewidth=1.0, capsize=3, marker="o", linestyle=style, **look)


def draw(folder: _File, measure: Optional[str] = None, by: Optional[str] = None, out: Optional[_File] = None,
         title: Optional[str] = None, over: Optional[str] = None, bars: Optional[str] = None, log_x: bool = False,
         log_y: bool = False) -> str:
    """Draws a measure of a sweep into a .png, .svg or .pdf file and returns the name of the file. over: the parameter
    of the x axis, for the results at the end of the runs as final_by() reads them; None: the time, for the series that
    series_by() reads. folder, measure, by: as in these functions. out: name of the file; None: MEASURE.png or
    MEASURE-over-PARAMETER.png in the folder. title: title of the plot, which may contain formulas between dollar signs
    as matplotlib draws them; None: no title. bars: what a point and its band or bar show: "deviation" (or None), the
    mean and one standard deviation; "interval", the mean and its 95 % confidence interval, by Student's t distribution;
    "quartiles", the median, and the first and third quartiles. log_x, log_y: whether the x and the y axis are
    logarithmic; they have only the points above 0, and a RuntimeWarning counts the others, except those at the time 0.

    With the measure "stopped_by" or "stopped_by:CONDITION" (final_by()), draws the fraction of the runs that a
    condition ended, with its 95 % confidence interval by Wilson; without `over`, the fraction of the runs that have
    ended so up to each time, until the first end of a run that no condition ended.

    Points with an infinite mean or median are left out, and so are failed runs, which a RuntimeWarning counts. Points
    of a single run have no band and no bar, except fractions; the legend states how many runs a point summarises.
    Equal results give equal bytes. Raises PlotError in the cases of these functions, if all means are infinite, if a
    value exceeds 1e300, if a logarithmic axis has no point or values that are not numbers, if the name has another
    ending, if a formula in the title is invalid, and if the file cannot be written; raises ImportError if matplotlib is
    missing. After an error, a file that existed is unchanged."""
    measure, names, lines, ticks = _lines_to_draw(folder, measure, by, over, bars, log_x)
    is_fraction = _is_fraction(measure)
    lines = _positive(_finite(lines, measure), over, measure, (log_x, log_y),
                      os.path.join(folder, "series.csv" if over is None and not is_fraction else "table.csv"))
    _warn_of_failed_runs(folder)
    file = _file_of_plot(folder, out, measure, over)
    import matplotlib

    matplotlib.use("Agg")
    from matplotlib import pyplot

    figure, axes = pyplot.subplots(figsize=(6.4, 4.0), constrained_layout=True)
    for i, (key, points) in enumerate(lines.items()):
        parts = ", ".join(f"{_short(name)} = {_short(_rounded(value))}" for name, value in zip(names, key))
        label = _literal(textwrap.fill(parts, TITLE_WIDTH)) or None
        if label and label.startswith("_"):
            label = " " + label  # a legend leaves out labels that begin with an underscore
        look = {"color": COLORS[i % len(COLORS)], "label": label, "linewidth": 1.6, "markersize": 4}
        style = "-" if i < len(COLORS) else "--"
        if over is None:
            _draw_band(axes, points, style, is_fraction, look)
        else:
            _draw_bars(axes, points, style if ticks is None else "none", look)
    counts = [runs for points in lines.values() for *_, runs in points]
    least, most = min(counts), max(counts)
    axes.set_xlabel(_literal(textwrap.fill(over, TITLE_WIDTH)) if over else "time (s)")
    if ticks is not None:
        is_level = sum(map(len, ticks)) <= MOST_LEVEL
        axes.set_xticks(list(ticks.values()), [_literal(textwrap.fill(_short(value), TICK_WIDTH)) for value in ticks],
                        rotation=0 if is_level else 90)
    label = f"{measure}, {BARS[bars or 'deviation'][0]}" if most > 1 else measure
    if is_fraction:
        label = f"fraction of runs ended by {measure.partition(':')[2] or 'stop_when'}, with 95 % confidence interval"
        if not log_y:
            axes.set_ylim(-0.03, 1.03)
    axes.set_ylabel(_literal(textwrap.fill(label, LABEL_WIDTH)))
    # A band or a bar that reaches down to 0 or below ends at the edge of the plot (nonpositive="clip").
    if log_x:
        axes.set_xscale("log")
        values = sorted({point[0] for points in lines.values() for point in points})
        if over is not None and len(values) <= MOST_LINES:  # the powers of ten may be far from the values
            axes.set_xticks(values, [f"{value:.6g}" for value in values])
            axes.set_xticks([], minor=True)
    if log_y:
        axes.set_yscale("log", nonpositive="clip")
    axes.grid(color="0.9")
    axes.set_axisbelow(True)
    title_of_legend = f"{most} runs per {'line' if over is None else 'point'}"
    if least < most:
        title_of_legend = f"{least} to {most} runs per point"
    if names or most > 1:  # without names, the legend consists of its title
        axes.legend(**({} if names else {"handles": []}), frameon=False, title=None if most == 1 else title_of_legend)
    if title:
        axes.set_title("\n".join(textwrap.fill(line, TITLE_WIDTH) for line in title.splitlines()))
    try:
        _save(figure, file, title)
    finally:
        pyplot.close(figure)
    return file


def _print(text: object, stream: Optional[TextIO]) -> str:
    """Prints a line. Returns the reason if this fails, for example because the disk is full, or else an empty text."""
    if stream is None:  # it was closed before Python began
        return os.strerror(errno.EBADF)
    try:
        print(text, file=stream, flush=True)
    except OSError as error:
        # When Python ends, it writes the line again. This must not fail, because the exit code would then be 120.
        nothing = os.open(os.devnull, os.O_WRONLY)
        os.dup2(nothing, stream.fileno())
        os.close(nothing)
        return error.strerror or str(error)
    return ""


def main(arguments: Optional[Sequence[str]] = None) -> int:
    os.environ["MPLBACKEND"] = "Agg"  # the import of matplotlib fails if the variable names an unknown backend
    if isinstance(sys.stdout, io.TextIOWrapper):
        sys.stdout.reconfigure(errors="surrogateescape")  # names of files need not be UTF-8
    parser = argparse.ArgumentParser(prog="troupe plot")
    parser.add_argument("folder")
    parser.add_argument("--measure")
    parser.add_argument("--over")
    parser.add_argument("--by")
    parser.add_argument("--out")
    parser.add_argument("--title")
    parser.add_argument("--bars")
    parser.add_argument("--log-x", action="store_true")
    parser.add_argument("--log-y", action="store_true")
    given = parser.parse_args(arguments)
    try:
        with warnings.catch_warnings(record=True) as caught:
            warnings.simplefilter("always", RuntimeWarning)  # PYTHONWARNINGS may hide warnings, or make them errors
            file = draw(given.folder, given.measure, given.by, given.out, given.title, given.over, given.bars,
                        log_x=given.log_x, log_y=given.log_y)
    except PlotError as error:
        text = str(error)
        _print(text if not text.startswith("error:") else f"troupe plot: {text}", sys.stderr)
        return 2
    except ImportError as error:
        _print(f"troupe plot: error: {sys.executable} cannot import matplotlib: {error} (Debian, Ubuntu: apt install "
               "python3-matplotlib; elsewhere: pip install matplotlib; the environment variable TROUPE_PYTHON selects "
               "another python3)", sys.stderr)
        return 1
    for warning in caught:
        _print(warning.message, sys.stderr)
    reason = _print(file, sys.stdout)
    if reason:
        _print(f"troupe plot: error: cannot write to standard output: {reason}", sys.stderr)
        return 1
    return 0


if __name__ == "__main__":
    if sys.path and sys.path[0] == "":
        del sys.path[0]  # set by python3 -c: do not import modules from the current folder
    sys.exit(main())
