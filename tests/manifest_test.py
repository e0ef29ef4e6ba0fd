#!/usr/bin/env python3
"""Tests that every shipped world has a row in worlds/scenes.json with a golden hash, or with the reason why it has none, and
that the reader of this file in Python reports errors. tests/troupe/manifest_test.cpp tests the reader in C++."""

import importlib.machinery
import importlib.util
import json
import pathlib
import subprocess
import sys
import tempfile
import unittest

ROOT = pathlib.Path(__file__).resolve().parent.parent
sys.path.insert(0, str(ROOT / "scripts"))

from proofs.runs import Fault, read_golden  # noqa: E402
from proofs.scenes import Scenes, shipped  # noqa: E402


def script(name):
    spec = importlib.util.spec_from_loader(name, importlib.machinery.SourceFileLoader(name, str(ROOT / "scripts" / name)))
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    return module


class Shipped(unittest.TestCase):
    def test_every_world_has_a_row(self):
        self.assertGreater(len(shipped()), 40)
        self.assertEqual(sorted(row["world"] for row in Scenes().rows), shipped())

    def test_the_golden_file_holds_the_runs_of_the_manifest(self):
        self.assertEqual(sorted(map(str, read_golden())), sorted(map(str, Scenes().golden_runs())))

    def test_proofs_have_golden_hashes_of_both_lengths(self):
        self.assertTrue(Scenes().proved())
        for world in Scenes().proved():
            for ticks in (50, 300):
                self.assertIn((world.key, None, ticks), read_golden())

    def test_the_table_of_the_documentation_is_that_of_the_manifest(self):
        page = (ROOT / "docs" / "worlds.md").read_text(encoding="utf-8")
        gallery = script("gallery")
        self.assertIn(Scenes().table(), page, "scripts/gallery --table writes it")
        self.assertEqual(gallery.with_table(page, Scenes()), page)

    def test_scenes_with_curves_are_shipped(self):
        scenes = script("scenes").SCENES
        self.assertTrue(scenes)
        for scene in scenes.values():
            self.assertIn(scene.world, shipped())


class Scripts(unittest.TestCase):
    def test_only_needs_the_beginning_of_a_name(self):
        for name, known in (("scenes", "known: beeclust, coverage, "), ("gallery", "known: hospital, cave, ")):
            done = subprocess.run([sys.executable, ROOT / "scripts" / name, "--only", "nowhere", "--into", "/dev/null/nothing"],
                                  capture_output=True, text=True)
            self.assertEqual(done.returncode, 2, done.stderr)
            self.assertIn("--only nowhere: the name of no ", done.stderr)
            self.assertIn(known, done.stderr)


class Refused(unittest.TestCase):
    GOOD = {"world": "a.json", "moves": "x", "for": "y", "golden": [{"ticks": 5}]}

    def faults(self, *rows, worlds=("a.json",), text=None):
        with tempfile.TemporaryDirectory() as name:
            folder = pathlib.Path(name)
            for world in worlds:
                (folder / world).write_text("{}")
            (folder / "scenes.json").write_text(json.dumps({"worlds": rows}) if text is None else text)
            try:
                Scenes(folder / "scenes.json")
            except Fault as fault:
                return str(fault).replace(f"{folder}/", "").replace(str(folder), "worlds").split("\n")
        return []

    def test_nothing_of_a_good_one(self):
        self.assertEqual(self.faults(self.GOOD), [])
        excluded = {**self.GOOD, "excluded": "too large"}
        del excluded["golden"]
        self.assertEqual(self.faults(excluded), [])

    def test_each_fault_with_its_place(self):
        for more, expected in [
            ({"soaks": {}}, "/worlds/0/soaks: unknown key; known: excluded, for, gallery, golden, moves, perf, prove, slow, soak, "
                            "tests, world"),
            ({"slow": 1}, "/worlds/0/slow: expected true or false, found 1"),
            ({"prove": [{"wait": 1}]}, "/worlds/0/prove/0/wait: unknown key; known: quick, ranging, weight"),
            ({"golden": [{"ticks": True}]}, "/worlds/0/golden/0/ticks: expected a whole number, found true"),
            ({"golden": [{"ticks": 5, "ranging": "fast"}]}, "/worlds/0/golden/0/ranging: \"fast\"; known: grid"),
            ({"tests": {"same_bits": [{"robots": 5}]}}, "/worlds/0/tests/same_bits/0: the key \"ticks\" is missing"),
            ({"gallery": [{"name": "a", "at_s": 5, "looks": ""}]}, "/worlds/0/gallery/0/looks: unknown key; known: at_s, look, name"),
            ({"soak": {"for": 5}}, "/worlds/0/soak/for: unknown key; known: for_s, resets"),
            ({"world": "b.json"}, "/worlds/0/world: there is no world b.json in worlds"),
            ({"excluded": "too large"}, "/worlds/0: a.json needs a run with a golden hash (prove, tests/same_bits or golden), or the "
                                        "reason why there is none (excluded)"),
            ({"golden": []}, "/worlds/0: a.json needs a run with a golden hash (prove, tests/same_bits or golden), or the reason why "
                             "there is none (excluded)"),
        ]:
            with self.subTest(more=more):
                self.assertIn(f"scenes.json: error: {expected}", self.faults({**self.GOOD, **more}))

    def test_a_world_without_a_row_or_with_two(self):
        self.assertEqual(self.faults(self.GOOD, worlds=("a.json", "b.world")),
                         ["scenes.json: error: /worlds: there is no row for b.world, which is in the folder worlds"])
        self.assertEqual(self.faults(self.GOOD, self.GOOD), ["scenes.json: error: /worlds: a.json has two rows"])

    def test_what_is_no_manifest(self):
        self.assertIn("cannot be read as JSON", self.faults(text="{")[0])
        self.assertEqual(self.faults(text="[]"), ["scenes.json: error: /: expected an object, found []"])
        self.assertEqual(self.faults(text="{}"), ["scenes.json: error: /: the key \"worlds\" is missing"])


if __name__ == "__main__":
    unittest.main()
