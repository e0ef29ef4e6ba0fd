"""Functions and classes that the tests of the Python package share."""

import contextlib
import csv
import os
import pathlib
import subprocess
import sys
import tempfile
import unittest

ROOT = pathlib.Path(__file__).resolve().parents[2]
HOSPITAL = ROOT / "worlds" / "hospital.json"

ROOM = {
    "troupe": 1,
    "title": "A room",
    "seed": 5,
    "tick_s": 0.2,
    "types": {
        "wall": {"size_m": [0.2, 20, 1]},
        "bot": {
            "size_m": [0.2, 0.2, 0.2],
            "drive": {"kind": "diff"},
            "sensors": [
                {"name": "eye", "kind": "ranger", "transducers": [{"range_max_m": 3, "fov_deg": 90, "samples": 3}]}
            ],
        },
        "cart": {
            "size_m": [0.4, 0.4, 0.2],
            "drive": {"kind": "omni"},
            "sensors": [
                {"name": "eye", "kind": "ranger", "transducers": [{"range_max_m": 2, "fov_deg": 90, "samples": 5}]}
            ],
        },
    },
    "models": [
        {"name": "east", "type": "wall", "pose": {"x_m": 5}},
        {"name": "cart", "type": "cart", "pose": {"y_m": 4}},
    ],
    "populations": [
        {
            "name": "r",
            "type": "bot",
            "count": 6,
            "reserve": 2,
            "place": {"rule": "uniform", "region_m": [[-4, -4], [4, 3]]},
        }
    ],
}


class InAFolder(unittest.TestCase):
    """A test whose working folder is a new temporary folder."""

    def setUp(self):
        stack = contextlib.ExitStack()
        self.folder = pathlib.Path(stack.enter_context(tempfile.TemporaryDirectory()))
        before = os.getcwd()
        stack.callback(os.chdir, before)
        os.chdir(self.folder)
        self.addCleanup(stack.close)


def train(script, *arguments):
    """Runs a script of python/examples, which writes its results to the folder out, prints its output, and returns the
    completed process."""
    done = subprocess.run([sys.executable, ROOT / "python" / "examples" / script, *map(str, arguments), "--out", "out"],
                          text=True, stdout=subprocess.PIPE, stderr=subprocess.STDOUT)
    print(done.stdout, end="")
    return done


def table(file):
    """Returns the rows of a CSV table as dicts."""
    with open(file, newline="") as stream:
        return list(csv.DictReader(stream))
