#!/usr/bin/env python3
"""Tests that perf_paper reports wrong hashes, and that its output can be read.

    perf_paper_test.py PERF_PAPER
"""

import json
import pathlib
import subprocess
import sys
import tempfile
import unittest

PROGRAM = sys.argv.pop()
ROOT = pathlib.Path(__file__).resolve().parent.parent
HASHES = (ROOT / "perf" / "paper_hashes.txt").read_text(encoding="utf-8")
ROW = "hospital/1"


class Paper(unittest.TestCase):
    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.folder = pathlib.Path(folder.name)

    def run_row(self, *options, hashes=HASHES):
        book = self.folder / "hashes.txt"
        book.write_text(hashes, encoding="utf-8")
        return subprocess.run([PROGRAM, "--quick", "--only", f"^2/{ROW}$", "--hashes", book, *options],
                              capture_output=True, text=True, check=False)

    def test_checked_in_hashes_hold(self):
        run = self.run_row()
        self.assertEqual(run.returncode, 0, run.stderr)
        self.assertIn("Table 2: minibots of 0.2 m in the hospital, 6 s", run.stdout)

    def test_each_number_of_the_paper_is_beside_its_row(self):
        entries = {}
        for row in json.loads((ROOT / "perf" / "paper_reference.json").read_text(encoding="utf-8"))["paper"]["rows"]:
            for robots, run_s in zip(row["robots"], row["run_time_s"]):
                entries[f"{row['world']}/{robots}", row["frames"]] = row["simulated_s"] / run_s
        self.assertEqual(len(entries), 32 + 10 + 3)
        rows = subprocess.run([PROGRAM, "--list"], capture_output=True, text=True, check=True).stdout.split()
        for scene, _ in entries:
            self.assertEqual(len([row for row in rows if row in (f"1/{scene}", f"2/{scene}", f"3/{scene}")]), 1, scene)
        lines = self.run_row().stdout.split("Table 2: ")[1].split("\n\n")[0].splitlines()
        cells = [line.split() for line in lines if line.startswith("hospital ")]
        shown = {row[4] == "-": row[9] for row in cells}
        self.assertEqual(shown[True], "952")  # 600 s in 0.63 s
        if False in shown:  # the machine can draw
            self.assertEqual(shown[False], "353")  # 600 s in 1.70 s

    def test_a_wrong_hash_fails_every_run_of_the_row(self):
        run = self.run_row(hashes=f"{ROW} 60 0123456789abcdef\n")
        self.assertEqual(run.returncode, 1)
        self.assertIn(f"{ROW} at tick 60 (1 thread): WRONG HASH ", run.stderr)
        self.assertIn("expected 0123456789abcdef", run.stderr)

    def test_an_unknown_hash_fails_and_is_recorded_on_purpose_only(self):
        run = self.run_row(hashes="")
        self.assertEqual(run.returncode, 1)
        self.assertIn("has no hash of this scene and tick; --write-hashes records", run.stderr)
        self.assertEqual((self.folder / "hashes.txt").read_text(encoding="utf-8"), "")
        self.assertEqual(self.run_row("--write-hashes", hashes="").returncode, 0)
        recorded = (self.folder / "hashes.txt").read_text(encoding="utf-8").splitlines()
        self.assertIn(recorded[-1], HASHES.splitlines())

    def test_a_broken_book_is_named_with_its_line(self):
        run = self.run_row(hashes="# fine\nhospital/1 sixty\n")
        self.assertEqual(run.returncode, 1)
        self.assertIn("hashes.txt:2: error: expected a scene, a tick and a hash", run.stderr)

    def test_no_such_row_is_an_error(self):
        run = subprocess.run([PROGRAM, "--only", "hospitol"], capture_output=True, text=True, check=False)
        self.assertEqual(run.returncode, 1)
        self.assertIn("no row has a name that matches \"hospitol\"", run.stderr)

    def test_json_holds_what_was_measured(self):
        out = self.folder / "paper.json"
        self.assertEqual(self.run_row("--repeat", "3", "--threads", "1,3", "--out", out).returncode, 0)
        data = json.loads(out.read_text(encoding="utf-8"))
        plain = [row for row in data["rows"] if not row["frames"]]
        self.assertEqual([row["threads"] for row in plain], [1, 3])
        for row in plain:
            speed = row["times_real_time"]
            self.assertEqual((row["scene"], row["robots"], row["ticks"], row["beams_per_tick"]), (ROW, 1, 60, 12))
            self.assertEqual(len(row["wall_s"]), 3)
            self.assertLessEqual(speed["min"], speed["median"])
            self.assertLessEqual(speed["median"], speed["max"])
            self.assertAlmostEqual(speed["max"] * min(row["wall_s"]), 6)
        self.assertEqual([point["threads"] for point in data["scaling"]], [3])

    def run_sets(self, *options):
        return subprocess.run([PROGRAM, "--quick", "--only", "^simd/cave-simple/10$", *options], capture_output=True, text=True,
                              check=False)

    def test_instruction_sets_stand_side_by_side_with_one_hash(self):
        out = self.folder / "paper.json"
        run = self.run_sets("--out", out)
        self.assertEqual(run.returncode, 0, run.stderr)
        data = json.loads(out.read_text(encoding="utf-8"))
        sets = data["machine"]["instruction sets"].split()
        self.assertEqual([row["simd"] for row in data["rows"]], sets)
        self.assertEqual(len({row["state_hash"] for row in data["rows"]}), 1)
        header = next(line for line in run.stdout.splitlines() if line.startswith("world "))
        self.assertEqual(header.split()[5:5 + len(sets)], sets)  # after "world robots beams per tick"
        self.assertIn("Comparison of instruction sets: " + data["machine"].get("processor", ""), run.stdout)

    def test_rows_are_measured_on_the_first_set_that_is_given(self):
        out = self.folder / "paper.json"
        self.assertEqual(self.run_row("--simd", "scalar", "--out", out).returncode, 0)
        data = json.loads(out.read_text(encoding="utf-8"))
        self.assertEqual({row["simd"] for row in data["rows"]}, {"scalar"})
        self.assertEqual(data["machine"]["kernels run on"], "scalar")

    def test_an_unknown_set_is_wrong_usage(self):
        run = self.run_sets("--simd", "scalar,avx9")
        self.assertEqual(run.returncode, 2)
        self.assertIn('"avx9" is not an instruction set that this program is compiled for', run.stderr)

    def test_files_in_no_folder_are_found_before_the_measurement(self):
        for option in ("--out", "--markdown"):
            run = self.run_row(option, self.folder / "none" / "file")
            self.assertEqual((run.returncode, run.stdout), (2, ""))
            self.assertIn(f"{option}: {self.folder}/none/file: there is no folder {self.folder}/none\n", run.stderr)

    def test_tables_land_between_their_marks(self):
        page = self.folder / "page.md"
        page.write_text("before\n<!-- perf_paper: begin -->\nold\n<!-- perf_paper: end -->\nafter\n", encoding="utf-8")
        self.assertEqual(self.run_row("--markdown", page).returncode, 0)
        text = page.read_text(encoding="utf-8")
        self.assertTrue(text.startswith("before\n<!-- perf_paper: begin -->\n"))
        self.assertTrue(text.endswith("\n<!-- perf_paper: end -->\nafter\n"))
        self.assertNotIn("old", text)
        self.assertIn("\n| hospital | 1 | 12 | 1 | - |", text)


if __name__ == "__main__":
    unittest.main()
