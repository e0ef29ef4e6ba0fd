#!/usr/bin/env python3
"""scripts/prove finds what it looks for: a stand-in for the program gives other bits in one variant only."""

import importlib.machinery
import importlib.util
import pathlib
import tempfile
import unittest

SCRIPT = str(pathlib.Path(__file__).resolve().parent.parent / "scripts" / "prove")
spec = importlib.util.spec_from_loader("prove", importlib.machinery.SourceFileLoader("prove", SCRIPT))
prove = importlib.util.module_from_spec(spec)
spec.loader.exec_module(prove)

LOG = [f"{tick} {tick:016x} pose={1:016x} velocity={2:016x} sensor={3:016x} memory={4:016x}" for tick in range(51)]


class Difference(unittest.TestCase):
    def test_equal_logs_have_none(self):
        self.assertEqual(prove.difference(LOG, list(LOG)), "")

    def test_names_the_first_tick_and_its_groups(self):
        other = list(LOG)
        other[7] = other[7].replace(f"sensor={3:016x}", f"sensor={5:016x}").replace(f"memory={4:016x}", "memory=0")
        other[9] = other[9].replace("pose", "pos")
        self.assertTrue(prove.difference(LOG, other).startswith("differs from tick 7 on, in sensor, memory:\n"))
        self.assertIn(f"\n  expected {LOG[7]}\n  got      {other[7]}", prove.difference(LOG, other))


class Proof(unittest.TestCase):
    def faults(self, lines_of, golden):
        prove.run = lambda program, world, threads, tile_m, *rest: lines_of(threads, tile_m)
        prove.read_golden = lambda: golden
        with tempfile.TemporaryDirectory() as folder:
            return prove.prove([prove.World("crowd.json")], ["release"], (1, 2), (1.7, 45.1), 50, pathlib.Path(folder))

    def test_the_same_bits_everywhere_are_no_fault(self):
        self.assertEqual(self.faults(lambda n, tile: LOG, {("crowd.json", None, 50): f"{50:016x}"}), [])

    def test_one_variant_that_differs_is_found(self):
        other = LOG[:-1] + [LOG[-1].replace("pose=0", "pose=1")]
        found = self.faults(lambda n, tile: other if (n, tile) == (2, 45.1) else LOG,
                            {("crowd.json", None, 50): f"{50:016x}"})
        self.assertEqual(len(found), 1)
        self.assertTrue(found[0].startswith("crowd, release, 2 threads, tiles of 45.1 m: differs from tick 50 on, in pose:"))

    def test_another_golden_hash_is_a_fault(self):
        found = self.faults(lambda n, tile: LOG, {("crowd.json", None, 50): "0123456789abcdef"})
        self.assertEqual(len(found), 1)
        self.assertIn("the golden hash is 0123456789abcdef", found[0])

    def test_no_golden_hash_is_a_fault(self):
        self.assertIn("no golden hash of tick 50", self.faults(lambda n, tile: LOG, {})[0])


if __name__ == "__main__":
    unittest.main()
