"""Reads the manifest of the shipped worlds, worlds/scenes.json. It has a row for each world, with the purpose of the world and
the runs in which tests and scripts use the world.

docs/worlds.md describes the keys of a row. tests/support/scenes.cpp reads the same file for the tests in C++ and for perf,
and checks the keys `tests` and `perf`; this module checks all other keys.
"""

import json
import pathlib

from .runs import ROOT, Fault, World

FILE = ROOT / "worlds" / "scenes.json"
TICKS = 300
QUICK_TICKS = 50
SHORT_TICKS = 10

REQUIRED = {"world": str, "moves": str, "for": str}
OPTIONAL = {"excluded": str, "slow": bool, "prove": list, "golden": list, "tests": dict, "perf": list, "gallery": list, "soak": dict}
PROVE = {"weight": (int, float), "ranging": str, "quick": bool}
GOLDEN = {"robots": int, "ticks": int, "ranging": str}
SOAK = {"for_s": int, "resets": bool}
# A picture of one time, or a run that is recorded and drawn in several views.
PICTURE = {"name": str, "at_s": (int, float), "look": str}
RECORDED = {"name": str, "for_s": (int, float), "record": str, "views": dict}


# The types of values, as error messages call them.
TYPES = {str: "a text", bool: "true or false", int: "a whole number", (int, float): "a number", list: "a list",
         dict: "an object"}


def is_world(file):
    return file.suffix in (".json", ".world") and file.name != FILE.name


def shipped(folder=None):
    """Returns the sorted file names of all worlds in the folder; None: the folder worlds/."""
    return sorted(file.name for file in (folder or FILE.parent).iterdir() if is_world(file))


class Scenes:
    """The rows of a manifest. The constructor checks them, and raises Fault, whose text lists all errors."""

    def __init__(self, file=FILE):
        self.file, self.faults = file, []
        try:
            manifest = json.loads(file.read_text(encoding="utf-8"))
        except (OSError, ValueError) as error:
            raise Fault(f"{file}: error: the file cannot be read as JSON: {error}") from error
        self._check("", manifest, {"worlds": list})
        self.rows = manifest.get("worlds", []) if not self.faults else []
        for i, row in enumerate(self.rows):
            self._check_row(f"/worlds/{i}", row)
        names = [row["world"] for row in self.rows] if not self.faults else []
        self.faults += [f"/worlds: {name} has two rows" for name in sorted({name for name in names if names.count(name) > 1})]
        if names:
            self.faults += [f"/worlds: there is no row for {name}, which is in the folder {file.parent}"
                            for name in shipped(file.parent) if name not in names]
        if self.faults:
            raise Fault("\n".join(f"{file}: error: {fault}" for fault in self.faults))

    def _check(self, at, value, required, optional=()):
        """Checks the keys of an object and the types of their values; returns whether they are correct."""
        before = len(self.faults)
        if not isinstance(value, dict):
            self.faults.append(f"{at or '/'}: expected an object, found {json.dumps(value)}")
            return False
        known = {**required, **dict(optional)}
        for key, one in value.items():
            if key not in known:
                self.faults.append(f"{at}/{key}: unknown key; known: {', '.join(sorted(known))}")
            elif not isinstance(one, known[key]) or (isinstance(one, bool) and known[key] is not bool):
                self.faults.append(f"{at}/{key}: expected {TYPES[known[key]]}, found {json.dumps(one)}")
        self.faults += [f"{at or '/'}: the key \"{key}\" is missing" for key in required if key not in value]
        return len(self.faults) == before

    def _check_row(self, at, row):
        if not self._check(at, row, REQUIRED, OPTIONAL):
            return
        if not is_world(file := self.file.parent / row["world"]) or not file.is_file():
            self.faults.append(f"{at}/world: there is no world {row['world']} in {self.file.parent}")
        for i, run in enumerate(row.get("prove", [])):
            self._check(f"{at}/prove/{i}", run, {"weight": PROVE["weight"]}, PROVE)
        for key in ("golden", "tests/same_bits", "tests/same_bits_slow"):
            for i, run in enumerate(of_path(row, key)):
                self._check(f"{at}/{key}/{i}", run, {"ticks": int}, GOLDEN)
        for key in ("prove", "golden", "tests/same_bits", "tests/same_bits_slow"):
            for i, run in enumerate(of_path(row, key)):
                if isinstance(run, dict) and run.get("ranging", "grid") != "grid":
                    self.faults.append(f"{at}/{key}/{i}/ranging: \"{run['ranging']}\"; known: grid")
        for i, picture in enumerate(row.get("gallery", [])):
            is_recorded = isinstance(picture, dict) and "views" in picture
            self._check(f"{at}/gallery/{i}", picture, RECORDED if is_recorded else PICTURE)
        if "soak" in row:
            self._check(f"{at}/soak", row["soak"], {}, SOAK)
        if bool(row.get("excluded")) == bool(golden_runs_of(row)):
            self.faults.append(f"{at}: {row['world']} needs a run with a golden hash (prove, tests/same_bits or golden), or the "
                               "reason why there is none (excluded)")

    def proved(self, quick=False):
        """Returns the worlds that scripts/prove runs. quick: whether to return only those with "quick": true in the
        manifest."""
        return tuple(World(row["world"], weight=run["weight"], ranging=run.get("ranging", ""))
                     for row in self.rows for run in row.get("prove", []) if run.get("quick") or not quick)

    def named(self, names=()):
        """Returns `names`, or the file names of all worlds if `names` is empty. Raises Fault for a name that is not a world of
        the manifest."""
        known = [row["world"] for row in self.rows]
        if unknown := [name for name in names if name not in known]:
            raise Fault(f"{self.file}: there is no world {', '.join(unknown)}; known: {', '.join(known)}")
        return list(names) or known

    def ranked(self, names=()):
        """Returns (world, robots, ticks) of the runs of scripts/prove --ranks: one run of each shipped world, or of those with
        the given names. robots: number of robots; None: the number in the world. Worlds that are excluded from the other
        proofs are run with as few robots as `perf_paper --quick` uses."""
        chosen = self.named(names)
        runs = []
        for row in self.rows:
            if row["world"] not in chosen:
                continue
            if row.get("excluded"):
                perf = row["perf"][0]
                each = perf["quick"][0] // len(perf["populations"])
                world = World(row["world"], populations=tuple(f"{name}={each}" for name in perf["populations"]))
                runs.append((world, None, SHORT_TICKS))
                continue
            run = (of_path(row, "prove") or of_path(row, "tests/same_bits") or of_path(row, "golden"))[0]
            runs.append((World(row["world"], ranging=run.get("ranging", "")), run.get("robots"),
                         run.get("ticks", QUICK_TICKS)))
        return tuple(runs)

    def golden_runs(self):
        """Returns (key, robots, ticks) of the entries of the golden file: first the runs of the proofs, then those of the
        tests, then the short runs for slow builds (sanitizers). robots: number of robots; None: the number in the world."""
        runs = [run for part in (proof_runs, test_runs, slow_runs) for row in self.rows for run in part(row)]
        return tuple(dict.fromkeys(runs))

    def slow(self):
        """Returns the names of the worlds that take minutes to run for a few simulated seconds."""
        return tuple(row["world"] for row in self.rows if row.get("slow"))

    def soaked(self):
        """Returns (world, simulated seconds) of the runs that scripts/soak kills and resumes."""
        return tuple((row["world"], row["soak"]["for_s"]) for row in self.rows if "for_s" in row.get("soak", {}))

    def reset(self):
        """Returns the names of the worlds that scripts/soak resets repeatedly in one process."""
        return tuple(row["world"] for row in self.rows if row.get("soak", {}).get("resets"))

    def pictures(self):
        """Returns (world, picture) of the pictures of docs/gallery.md, those of recorded runs first. A picture is an entry of
        `gallery` in the manifest."""
        all_of_them = [(row["world"], picture) for row in self.rows for picture in row.get("gallery", [])]
        return sorted(all_of_them, key=lambda one: "views" not in one[1])

    def table(self):
        """Returns the table of docs/worlds.md, in Markdown."""
        lines = ["| world | what moves | what for |", "|---|---|---|"]
        return "\n".join(lines + [f"| `{row['world']}` | {row['moves']} | {row['for']} |" for row in self.rows]) + "\n"


def of_path(row, path):
    for key in path.split("/"):
        row = row.get(key, {})
    return row or []


def key_of(row, run):
    """The key of a run's world in the golden file."""
    return World(row["world"], ranging=run.get("ranging", "")).key


def proof_runs(row):
    return [(key_of(row, run), None, ticks) for run in of_path(row, "prove") for ticks in (QUICK_TICKS, TICKS)]


def test_runs(row):
    runs = of_path(row, "tests/same_bits") + of_path(row, "golden")
    return [(key_of(row, run), run.get("robots"), run["ticks"]) for run in runs]


def slow_runs(row):
    return [(key_of(row, run), run.get("robots"), run["ticks"]) for run in of_path(row, "tests/same_bits_slow")]


def golden_runs_of(row):
    return of_path(row, "prove") or of_path(row, "tests/same_bits") or of_path(row, "golden")
