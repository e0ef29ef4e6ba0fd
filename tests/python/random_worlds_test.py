"""Tests of the process in which scripts/prove checks random worlds (scripts/proofs/library_worker.py)."""

import itertools
import json
import os
import pathlib
import shutil
import subprocess
import sys
import unittest
import unittest.mock

from support import ROOM, ROOT, InAFolder

sys.path.insert(0, str(ROOT / "scripts" / "proofs"))
import library_worker  # noqa: E402
from sessions import ACTS  # noqa: E402

PROGRAM = pathlib.Path(os.environ["PYTHONPATH"].split(":")[0]).parents[2] / "bin" / "troupe"
TICKS = 40


@unittest.skipUnless(shutil.which(PROGRAM), "the program is not built")
class Checks(InAFolder):
    def job(self, **changed):
        return library_worker.Job({"world": {**ROOM, **changed}, "folder": str(self.folder), "program": str(PROGRAM), "ticks": TICKS})

    def told(self, seed=1, **changed):
        return self.job(**changed).run([{"check": "session", "seed": seed}])

    def told_of_tables(self):
        return self.job().run([{"check": "tables", "threads": 2, "tile": 0.6, "ranks": 2}])

    def test_a_session_is_recorded_and_repeated(self):
        done, seeds = set(), range(1, 7)
        for seed in seeds:
            told = self.told(seed)
            self.assertEqual(told["failures"], [])
            done |= set(told["acts"])
            lines = [json.loads(line) for line in (self.folder / "session.session.jsonl").read_text().splitlines()]
            self.assertEqual((lines[-1]["do"], lines[-1]["tick"]), ("end", TICKS))
            self.assertGreater(len({line["tick"] for line in lines}), TICKS // 4)
        # The robots of this world have no device with a command.
        self.assertEqual(done, set(ACTS) - {"command"})

    def test_tables_of_the_same_world_are_equal(self):
        self.assertEqual(self.told_of_tables()["failures"], [])

    def test_tables_that_differ_are_a_failure(self):
        made = itertools.count()

        class Counting(library_worker.troupe.Measures):
            def __init__(self, *arguments):
                super().__init__(*arguments)
                self.number = next(made)

            def values(self):
                return [*super().values(), self.number]

        with unittest.mock.patch.object(library_worker.troupe, "Measures", Counting):
            (failure,) = self.told_of_tables()["failures"]
        self.assertEqual(failure["check"]["check"], "tables")
        self.assertRegex(failure["text"], r"the tables differ: expected tick 1: measures .*; got tick 1: measures ")

    def test_a_session_that_is_repeated_otherwise_is_a_failure(self):
        run = subprocess.run

        def run_after_a_change(command, **options):
            if "--session" in command:
                file = pathlib.Path(command[command.index("--session") + 1])
                lines = file.read_text().splitlines()
                at = next(i for i, line in enumerate(lines) if '"hold"' in line)
                lines[at] = json.dumps({**json.loads(lines[at]), "speed": [0.123, 0, 0.5]})
                file.write_text("\n".join(lines) + "\n")
            return run(command, **options)

        with unittest.mock.patch.object(library_worker.subprocess, "run", run_after_a_change):
            (failure,) = self.told()["failures"]
        self.assertEqual(failure["check"]["check"], "session")
        self.assertRegex(failure["text"], "differs from tick [0-9]+ on, in ")

    def test_a_program_that_refuses_a_session_is_a_failure(self):
        failing = unittest.mock.Mock(return_value=subprocess.CompletedProcess([], 2, "", "troupe: error: no"))
        with unittest.mock.patch.object(library_worker.subprocess, "run", failing):
            (failure,) = self.told()["failures"]
        self.assertIn("troupe run --session: exit code 2: troupe: error: no", failure["text"])


if __name__ == "__main__":
    unittest.main()
