#!/usr/bin/env python3
"""Tests of scripts/soak: a short run of it, and that growing memory, descriptors and files are failures.

    soak_test.py BUILD    folder of a build with the program and the Python module; without it, only the tests that run nothing
"""

import importlib.machinery
import importlib.util
import json
import os
import pathlib
import signal
import subprocess
import sys
import tempfile
import time
import unittest

ROOT = pathlib.Path(__file__).resolve().parent.parent
BUILD = pathlib.Path(sys.argv.pop(1)) if len(sys.argv) > 1 else None
spec = importlib.util.spec_from_loader("soak", importlib.machinery.SourceFileLoader("soak", str(ROOT / "scripts" / "soak")))
soak = importlib.util.module_from_spec(spec)
spec.loader.exec_module(soak)


class Process:
    """A stand-in for a process that runs."""

    pid = os.getpid()

    def poll(self):
        return None


class Limits(unittest.TestCase):
    """What the samples of a process that grows lead to."""

    def setUp(self):
        temporary = tempfile.TemporaryDirectory()
        self.addCleanup(temporary.cleanup)
        self.soak = soak.Soak(1, pathlib.Path(temporary.name), 1, ROOT)
        self.addCleanup(self.soak.samples.close)
        taken, told = soak.taken, []
        self.soak.fail = told.append
        self.told = told
        self.addCleanup(setattr, soak, "taken", taken)

    def sample(self, times=1, resident_kb=50_000, descriptors=20, files_kb=1000, warm=True, world=""):
        soak.taken = lambda _: (resident_kb, descriptors)
        for _ in range(times):
            self.soak.sample("run" if world else "reset", world, Process(), warm, files_kb)

    def test_what_stays_within_its_bounds_is_no_failure(self):
        self.sample(soak.LEAST_SAMPLES, warm=False)
        self.sample(5, resident_kb=60_000, descriptors=24, files_kb=1500)
        self.assertEqual(self.told, [])

    def test_growing_memory_descriptors_and_files_are_failures(self):
        for name, grown in (("resident_kb", 90_000), ("descriptors", 60), ("files_kb", 9000)):
            with self.subTest(name):
                self.sample(soak.LEAST_SAMPLES, warm=False)
                self.sample(**{name: grown})
                self.assertEqual(len(self.told), 1)
                self.assertIn(f"reset: {name} is {grown}, above its bound of ", self.told.pop())

    def test_a_value_of_the_warm_up_is_no_failure_and_raises_the_bound(self):
        self.sample(soak.LEAST_SAMPLES, warm=False, resident_kb=200_000)
        self.sample(resident_kb=220_000)
        self.assertEqual(self.told, [])

    def test_files_of_a_run_are_bounded_by_those_of_the_uninterrupted_run(self):
        (self.soak.out / "straight-crowd.h5").write_bytes(bytes(1 << 20))
        self.sample(files_kb=5000, world="crowd.json")
        self.assertEqual(self.told, [])
        self.sample(files_kb=6000, world="crowd.json")
        self.assertEqual(self.told, ["run crowd.json: its files take 6000 kB, those of the uninterrupted run 1024 kB"])


@unittest.skipIf(BUILD is None, "no build is given")
class ShortRun(unittest.TestCase):
    def test_it_kills_resumes_and_resets_and_adds_to_the_history(self):
        with tempfile.TemporaryDirectory() as name:
            folder = pathlib.Path(name)
            call = subprocess.Popen([sys.executable, ROOT / "scripts" / "soak", "1", "--out", folder, "--build", BUILD, "--history",
                                     folder / "history.md"], stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True)
            try:
                # Ends as soon as each activity has been sampled. This takes seconds, or longer on a busy machine.
                while call.poll() is None and not self.has_run(folder):
                    time.sleep(0.2)
                call.send_signal(signal.SIGTERM)
                output = call.communicate(timeout=600)[0]
            finally:
                call.kill()
                call.wait()
            if call.returncode == 2:
                self.skipTest(output)
            self.assertEqual(call.returncode, 0, output)
            self.assertIn(" 0 differences, 0 failures", output)
            counts = json.loads((folder / "state.json").read_text())["counts"]
            series = soak.read_samples(folder)
            self.assertGreater(counts["resets"], 0)
            self.assertGreater(max(memory for _, memory, _, _ in series["reset"]), 1)
            row = [cell.strip() for cell in (folder / "history.md").read_text().strip().split("|")[1:-1]]
            table = (ROOT / "tests" / "soak" / "HISTORY.md").read_text().splitlines()
            head = [cell.strip() for cell in next(line for line in table if line.startswith("| date")).split("|")[1:-1]]
            self.assertEqual(len(row), len(head))
            self.assertEqual((row[head.index("resets")], row[-1]), (str(counts["resets"]), "0"))

    @staticmethod
    def has_run(folder):
        """Whether both activities have been sampled, and a run has been killed."""
        try:
            counts = json.loads((folder / "state.json").read_text())["counts"]
            series = soak.read_samples(folder)
        except (OSError, ValueError):
            return False
        # The first samples may come before the new process has loaded anything.
        loaded = any(memory > 1 for _, memory, _, _ in series.get("reset", ()))
        return counts["resets"] > 0 and counts["kills"] > 0 and loaded and len(series) > 1


if __name__ == "__main__":
    unittest.main()
