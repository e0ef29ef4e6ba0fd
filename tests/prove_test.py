#!/usr/bin/env python3
"""scripts/prove finds what it looks for: stand-ins for the program give other bits in one variant only."""

import contextlib
import importlib.machinery
import importlib.util
import io
import pathlib
import subprocess
import tempfile
import unittest

ROOT = pathlib.Path(__file__).resolve().parent.parent
spec = importlib.util.spec_from_loader("prove", importlib.machinery.SourceFileLoader("prove", str(ROOT / "scripts" / "prove")))
prove = importlib.util.module_from_spec(spec)
spec.loader.exec_module(prove)
from proofs import builds, runs, variants  # noqa: E402  (scripts/prove has put its folder on the path)

WORLD = runs.World("crowd.json")
LOG = [f"{tick} {tick:016x} pose={1:016x} velocity={2:016x} sensor={3:016x} memory={4:016x}" for tick in range(51)]
OTHER = LOG[:-1] + [LOG[-1].replace("pose=0", "pose=1")]
GOLDEN = {("crowd.json", None, 50): f"{50:016x}"}


class Difference(unittest.TestCase):
    def test_equal_logs_have_none(self):
        self.assertEqual(runs.difference(LOG, list(LOG)), "")

    def test_names_the_first_tick_and_its_groups(self):
        other = list(LOG)
        other[7] = other[7].replace(f"sensor={3:016x}", f"sensor={5:016x}").replace(f"memory={4:016x}", "memory=0")
        other[9] = other[9].replace("pose", "pos")
        self.assertTrue(runs.difference(LOG, other).startswith("differs from tick 7 on, in sensor, memory:\n"))
        self.assertIn(f"\n  expected {LOG[7]}\n  got      {other[7]}", runs.difference(LOG, other))


class Given:
    """A variant whose run is known."""

    def __init__(self, label, lines):
        self.label, self._lines = label, lines

    def lines(self, *_):
        return self._lines


class Proofs(unittest.TestCase):
    def hold(self, *proofs, golden=None):
        with contextlib.redirect_stdout(io.StringIO()) as table:
            found = {proof.name: texts for proof, texts in prove.hold(WORLD, list(proofs), 50, None, golden)}
        return found, table.getvalue()

    def test_the_same_bits_everywhere_are_no_fault(self):
        found, table = self.hold(variants.Proof("a", "two", (Given("x", LOG), Given("y", LOG))),
                                 variants.Proof("b", "one", (Given("z", LOG),)), golden=GOLDEN)
        self.assertEqual(found, {"a": [], "b": []})
        self.assertEqual(table.count("same bits"), 2)

    def test_one_variant_that_differs_is_found_in_its_proof(self):
        found, table = self.hold(variants.Proof("a", "one", (Given("x", LOG),)),
                                 variants.Proof("b", "two", (Given("y", LOG), Given("z", OTHER))))
        self.assertEqual(found["a"], [])
        self.assertEqual(len(found["b"]), 1)
        self.assertTrue(found["b"][0].startswith("crowd, b, z: differs from tick 50 on, in pose:"))
        self.assertIn("DIFFERS", table)

    def test_another_golden_hash_is_a_fault(self):
        found, _ = self.hold(variants.Proof("a", "one", (Given("x", LOG),)),
                             golden={("crowd.json", None, 50): "0123456789abcdef"})
        self.assertIn("the golden hash is 0123456789abcdef", found["a"][0])

    def test_no_golden_hash_is_a_fault(self):
        found, _ = self.hold(variants.Proof("a", "one", (Given("x", LOG),)), golden={})
        self.assertIn("no golden hash of tick 50", found["a"][0])

    def test_kernels_of_another_instruction_set_than_asked_for_are_a_fault(self):
        with tempfile.TemporaryDirectory() as name:
            folder = pathlib.Path(name)
            for ran, asked, fault in (("sse4", "sse4", None), ("avx2", "sse4", "must run on sse4, they ran on avx2"),
                                      ("", "sse4", "must run on sse4, they ran on an unknown one")):
                program = folder / "program"
                head = f"# simd: {ran}\n" if ran else ""
                log = "\n".join(LOG)
                program.write_text(f"#!/bin/sh\nprintf '%s\\n' '{head}{log}' > {folder}/run.log\n")
                program.chmod(0o755)
                variant = runs.Variant("x", program, simd=asked)
                with self.subTest(ran=ran):
                    if fault is None:
                        self.assertEqual(variant.lines(WORLD, 50, folder), LOG)
                    else:
                        with self.assertRaisesRegex(runs.Fault, fault):
                            variant.lines(WORLD, 50, folder)


class Planted(unittest.TestCase):
    """The faults that scripts/prove --planted looks for keep up with the sources."""

    def test_faults_apply_to_the_sources(self):
        names = [name for name, _ in builds.planted_faults()]
        self.assertEqual(names, ["address_tie", "float_sum", "libm_sine", "racing_read"])
        for name in names:
            with self.subTest(name=name), tempfile.TemporaryDirectory() as folder:
                patch = builds.PLANTED / f"{name}.patch"
                for file in builds.patched_files(patch):
                    builds.copy_if_changed(ROOT / file, pathlib.Path(folder) / file)
                done = subprocess.run(["patch", "--strip=1", "--fuzz=0", "--input", patch], cwd=folder, capture_output=True,
                                      text=True)
                self.assertEqual(done.returncode, 0, done.stdout + done.stderr)

    def test_faults_say_what_they_do(self):
        for name, about in builds.planted_faults():
            self.assertGreater(len(about), 40, name)


if __name__ == "__main__":
    unittest.main()
