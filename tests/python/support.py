"""Functions and classes that the tests of the Python package share."""

import contextlib
import csv
import functools
import os
import pathlib
import shutil
import signal
import subprocess
import sys
import tempfile
import time
import unittest

ROOT = pathlib.Path(__file__).resolve().parents[2]
HOSPITAL = ROOT / "worlds" / "hospital.json"
WAIT_S = 240  # longest wait for another process or thread, on a busy machine

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


def output_when_interrupted(code, *waits_s):
    """Runs a Python program that prints "begun" once for each of waits_s, and then interrupts it (Ctrl-C) after this time, s.
    Returns the rest of what it prints."""
    with subprocess.Popen([sys.executable, "-c", code], stdout=subprocess.PIPE, text=True) as process:
        try:
            for wait_s in waits_s:
                line = process.stdout.readline()
                if line != "begun\n":
                    raise RuntimeError(f'the program printed {line!r}, not "begun"')
                time.sleep(wait_s)
                process.send_signal(signal.SIGINT)
            return process.communicate(timeout=WAIT_S)[0]
        finally:
            process.kill()


def is_lacking(error):
    """Whether a text is the error of a build without HDF5 or without pictures, or of a machine without OSMesa and EGL."""
    return any(text in error for text in ("this build of Troupe has no HDF5", "this build cannot draw pictures",
                                          "neither OSMesa nor EGL is installed"))


@contextlib.contextmanager
def skipped_where_lacking():
    """Skips the test if its block fails as is_lacking() describes. Any other error is a failure."""
    try:
        yield
    except RuntimeError as error:
        if not is_lacking(str(error)):
            raise
        raise unittest.SkipTest(str(error)) from error


@functools.cache
def has_view():
    """Whether this build of Troupe can show a run in a browser (the option TROUPE_VIEW of CMake)."""
    import troupe  # not above: wheel_check.py imports this module before troupe is installed

    with tempfile.TemporaryDirectory() as folder:
        try:
            troupe.Simulation(ROOM, threads=1).view(out=folder).close()
        except RuntimeError as error:
            if "-DTROUPE_VIEW=ON" not in str(error):
                raise
            return False
    return True


def needs_view(test):
    """Decorates a test, or a class of tests, that needs a build with a view."""
    return unittest.skipUnless(has_view(), "this build has no view (TROUPE_VIEW)")(test)


def variables_of_locale(name, folder):
    """Makes a locale in UTF-8, such as tr_TR, in a folder, and returns the environment variables with which a process uses it.
    Skips the test if the machine cannot make it (Debian, Ubuntu: apt install locales)."""
    localedef = shutil.which("localedef")
    made = localedef and subprocess.run([localedef, "-i", name, "-f", "UTF-8", f"{folder}/{name}.utf8"], capture_output=True)
    if not made or made.returncode != 0:
        raise unittest.SkipTest(f"the locale {name} cannot be made")
    return {"LOCPATH": str(folder), "LC_ALL": f"{name}.utf8"}


class InAFolder(unittest.TestCase):
    """A test whose working folder is a new temporary folder."""

    def setUp(self):
        stack = contextlib.ExitStack()
        self.folder = pathlib.Path(stack.enter_context(tempfile.TemporaryDirectory()))
        before = os.getcwd()
        stack.callback(os.chdir, before)
        os.chdir(self.folder)
        self.addCleanup(stack.close)


def calls_of(function):
    """Returns the number of calls of functions in Python and in C that a function makes. Unlike its time, it is the same on every
    machine."""
    calls = 0

    def count(_frame, event, _function):
        nonlocal calls
        calls += event in ("call", "c_call")

    before = sys.getprofile()
    sys.setprofile(count)
    try:
        function()
    finally:
        sys.setprofile(before)
    return calls


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
