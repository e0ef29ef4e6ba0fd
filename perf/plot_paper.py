#!/usr/bin/env python3
"""Draws figures 7 and 8 of the paper on Stage (perf/paper.cpp) with the measurements that `perf_paper --out` wrote, and with
values of other simulators from paper_reference.json. The figures show the speed, in multiples of real time, over the number
of robots. Also draws the speed-up on several threads over the number of robots.

    perf/plot_paper.py build/perf/paper.json [--images docs/images]

Needs matplotlib: scripts/setup --plots.
"""

import argparse
import json
import os
import sys

HERE = os.path.dirname(os.path.abspath(__file__))


def arguments():
    parser = argparse.ArgumentParser(description=__doc__.split("\n\n")[0])
    parser.add_argument("measured", help="output of perf_paper --out")
    parser.add_argument("--images", default=os.path.join(os.path.dirname(HERE), "docs", "images"),
                        help="folder for the pictures")
    return parser.parse_args()


try:
    import matplotlib
    matplotlib.use("svg")
    import matplotlib.pyplot as plt
except ImportError as error:
    arguments()  # --help and wrong arguments need no libraries
    sys.exit(f"plot_paper.py: error: {error}; scripts/setup --plots installs matplotlib for Debian's /usr/bin/python3")

COLORS = {"blue": "#1f6fb2", "orange": "#d9730d", "green": "#2f8f4e", "purple": "#7b4ba8", "gray": "#777777"}
# Scenes of a figure: name without the population, label, colour.
CAVE = (("cave-simple", "simple bodies, 16 sonars", "blue"), ("cave-complex", "complex bodies, 16 sonars", "green"),
        ("cave-simple-laser", "simple bodies, sonars and laser", "orange"),
        ("cave-complex-laser", "complex bodies, sonars and laser", "purple"))
HOSPITAL = (("hospital", "minibots of 0.2 m", "blue"), ("hospital-10cm", "minibots of 0.1 m", "green"),
            ("campus", "minibots of 0.1 m, 16 hospitals", "purple"))
MARKERS = ("s", "D", "^", "v")


def style():
    matplotlib.rcParams.update({
        "svg.fonttype": "none", "svg.hashsalt": "troupe", "font.family": "sans-serif", "font.size": 10,
        "axes.spines.top": False, "axes.spines.right": False, "axes.grid": True, "grid.color": "#dddddd",
        "grid.linewidth": 0.6, "legend.frameon": False, "figure.figsize": (8, 5), "figure.facecolor": "white"})


def save(figure, folder, name):
    path = os.path.join(folder, name)
    figure.tight_layout()
    figure.savefig(path, metadata={"Date": None})
    plt.close(figure)
    print(path)


def series(rows, world, threads, frames):
    """Returns (robots, least, median, greatest speed) for each measured number of robots of a world, in ascending order.

    Speeds are multiples of real time. frames: whether to return the runs with pictures or those without. The list is
    empty if the world was not measured in this way.
    """
    points = {row["robots"]: row["times_real_time"] for row in rows
              if row["scene"].rsplit("/", 1)[0] == world and row["threads"] == threads and row["frames"] == frames
              and row["table"] in ("1", "2", "3", "campus")}
    return [(robots, speed["min"], speed["median"], speed["max"]) for robots, speed in sorted(points.items())]


def draw_populations(data, reference, number, worlds, title, name, folder):
    figure, axes = plt.subplots(figsize=(10.5, 5.5))
    most = max(row["threads"] for row in data["rows"])
    drawn = False
    for world, label, color in worlds:
        kinds = [(1, False, "-", "o", "")]
        if most > 1:
            kinds.append((most, False, "--", "o", f", {most} threads"))
        kinds.append((1, True, ":", "x", ", with pictures"))
        for threads, frames, line, marker, what in kinds:
            points = series(data["rows"], world, threads, frames)
            if not points:
                continue
            drawn = True
            robots, least, middle, greatest = zip(*points)
            axes.plot(robots, middle, line, marker=marker, ms=4, color=COLORS[color], label=label + what,
                      markerfacecolor="white" if threads > 1 else COLORS[color])
            if len(data["rows"][0]["wall_s"]) > 1 and not frames:
                axes.fill_between(robots, least, greatest, color=COLORS[color], alpha=0.15, lw=0)
    if not drawn:
        plt.close(figure)
        return
    labels = {world: label for world, label, _ in worlds}
    colors = {world: COLORS[color] for world, _, color in worlds}
    for row in reference["paper"]["rows"]:
        if row["figure"] == number:
            axes.plot(row["robots"], [row["simulated_s"] / run_s for run_s in row["run_time_s"]], "-." if row["frames"] else "-",
                      lw=0.7, marker="+", ms=6, color=colors[row["world"]],
                      label=f"the paper: {labels[row['world']]}{', with graphics' if row['frames'] else ''}")
    for i, other in enumerate(reference["series"]):
        points = [p for p in other["points"] if p["figure"] == number]
        if points:
            axes.plot([p["robots"] for p in points], [p["times_real_time"] for p in points],
                      marker=MARKERS[i % len(MARKERS)], ms=7, ls="" if len(points) < 3 else "-", lw=0.8,
                      color=COLORS["gray"], markerfacecolor="white", label=other["name"])
    axes.axhline(1, color="black", lw=0.8)
    axes.text(0.99, 1.06, "real time", transform=axes.get_yaxis_transform(), ha="right", va="bottom", fontsize=9)
    axes.set(xscale="log", yscale="log", xlabel="robots", ylabel="times real time", title=title)
    for axis in (axes.xaxis, axes.yaxis):
        axis.set_major_formatter(lambda value, _: f"{value:,.10g}")
    axes.legend(fontsize=7, loc="center left", bbox_to_anchor=(1, 0.5))
    save(figure, folder, name)


def draw_threads(data, folder):
    scaling = data["scaling"]
    if not scaling:
        return
    figure, axes = plt.subplots()
    counts = sorted({point["threads"] for point in scaling})
    for count, color in zip(counts, list(COLORS)[:4] * len(counts)):
        points = sorted((p["robots"], p["speedup"], p["probe"]) for p in scaling if p["threads"] == count)
        robots, speedup, probe = zip(*points)
        axes.plot(robots, speedup, "o-", ms=4, color=COLORS[color], label=f"{count} threads against one")
        axes.plot(robots, probe, "--", lw=1, color=COLORS[color], label=f"{count} threads that share nothing")
    axes.axhline(1, color="black", lw=0.8)
    axes.set(xscale="log", xlabel="robots", ylabel="speed-up", title="Threads", ylim=(0, None))
    axes.xaxis.set_major_formatter(lambda value, _: f"{value:,.10g}")
    axes.legend(fontsize=8)
    save(figure, folder, "perf-threads.svg")


def main():
    options = arguments()
    with open(options.measured, encoding="utf-8") as file:
        data = json.load(file)
    with open(os.path.join(HERE, "paper_reference.json"), encoding="utf-8") as file:
        reference = json.load(file)
    style()
    os.makedirs(options.images, exist_ok=True)
    draw_populations(data, reference, 7, CAVE, "Pioneers in the cave (the paper's figure 7)", "perf-cave.svg",
                     options.images)
    draw_populations(data, reference, 8, HOSPITAL, "Minibots in the hospital (the paper's figure 8)",
                     "perf-hospital.svg", options.images)
    draw_threads(data, options.images)


if __name__ == "__main__":
    main()
