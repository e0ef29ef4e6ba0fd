#!/usr/bin/env python3
"""Tests of scripts/count-ranks.

    count_ranks_test.py PROGRAM     PROGRAM: the program troupe
"""

import importlib.machinery
import importlib.util
import math
import pathlib
import subprocess
import sys
import unittest

ROOT = pathlib.Path(__file__).resolve().parent.parent
SCRIPT = ROOT / "scripts" / "count-ranks"
spec = importlib.util.spec_from_loader("count_ranks", importlib.machinery.SourceFileLoader("count_ranks", str(SCRIPT)))
count_ranks = importlib.util.module_from_spec(spec)
spec.loader.exec_module(count_ranks)
PROGRAM = sys.argv.pop(1)


class Formula(unittest.TestCase):
    def test_ghosts_surround_a_square(self):
        # 100 robots on 25 m2, within 2 m: four strips of 5 m x 2 m, and four quarters of a circle
        self.assertAlmostEqual(count_ranks.ghosts_of_square(100, 4, 2), 4 * (40 + 4 * math.pi))

    def test_bytes_are_fitted_to_ghosts_and_ranks(self):
        rows = [{"ranks": ranks, "ranks_ghosts_mean": ghosts, "ranks_bytes_mean": 30 * ghosts + 70 * (ranks - 1)}
                for ranks, ghosts in ((2, 500), (4, 400), (8, 250))]
        per_ghost, per_rank = count_ranks.fitted(rows)
        self.assertAlmostEqual(per_ghost, 30)
        self.assertAlmostEqual(per_rank, 70)


class Tables(unittest.TestCase):
    def call(self, *arguments):
        return subprocess.run([sys.executable, SCRIPT, "--program", PROGRAM, *arguments], capture_output=True, text=True)

    def test_both_tables_are_printed_and_are_the_same_again(self):
        options = ("--robots", "300", "--ranks", "3,2", "--for", "0.4")
        done = self.call(*options)
        self.assertEqual((done.returncode, done.stderr), (0, ""))
        rows = [line.split(" | ") for line in done.stdout.splitlines() if line.startswith("| ")]
        self.assertEqual([row[0] for row in rows[:3]], ["| ranks", "| 2", "| 3"])
        self.assertEqual([row[1] for row in rows[1:3]], ["150", "100"])
        self.assertIn("counted, 300 robots, per rank and tick:", done.stdout)
        self.assertIn("computed from counts, per rank and tick:", done.stdout)
        self.assertEqual(len(rows), 3 + 1 + len(count_ranks.COMPUTED))
        self.assertEqual(self.call(*options).stdout, done.stdout)

    def test_the_documentation_has_the_counts(self):
        version = subprocess.run([PROGRAM, "--version"], capture_output=True, text=True).stdout
        if "Release" not in version:
            self.skipTest("slow in other builds")
        rows = [line for line in self.call("--ranks", "2,4").stdout.splitlines() if line.startswith(("| 2 |", "| 4 |"))]
        page = (ROOT / "docs" / "cluster.md").read_text(encoding="utf-8")
        self.assertEqual(len(rows), 2)
        for row in rows:
            self.assertIn(row, page, "scripts/count-ranks prints both tables")

    def test_errors_say_what_is_expected(self):
        for arguments, text in ((("--ranks", "4"), "expected two or more numbers of ranks"),
                                (("--ranks", "1,2"), "each at least 2"),
                                (("--ranks", "2,x"), "expected two or more numbers of ranks"),
                                (("--robots", "0"), "--robots 0: expected"),
                                (("--program", "none"), "there is no program none; build it with scripts/build release")):
            done = self.call(*arguments)
            self.assertEqual(done.returncode, 2, arguments)
            self.assertIn(text, done.stderr)


if __name__ == "__main__":
    unittest.main()
