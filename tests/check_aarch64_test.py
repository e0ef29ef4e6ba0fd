#!/usr/bin/env python3
"""Tests that scripts/check-aarch64 detects faults, for those of its checks that need no cross compiler."""

import pathlib
import sys
import unittest

ROOT = pathlib.Path(__file__).resolve().parent.parent
sys.path.insert(0, str(ROOT / "scripts"))
from proofs import aarch64  # noqa: E402


class FusedInstructions(unittest.TestCase):
    def found(self, instruction):
        return aarch64.fused_instructions(f"0000 <f>:\n   0:\tfadd\td0, d0, d1\n   4:\t{instruction}\n   8:\tret\n")

    def test_are_found(self):
        for instruction in ("fmadd\td0, d0, d1, d2", "fnmsub\ts0, s1, s2, s3", "fmla\tv0.4s, v1.4s, v2.4s",
                            "fmls\tz0.s, p0/m, z1.s, z2.s", "fnmad\tz0.d, p0/m, z1.d, z2.d", "fmlal\tv0.4s, v1.4h, v2.4h"):
            with self.subTest(instruction=instruction):
                self.assertEqual(self.found(instruction), [f"   4:\t{instruction}"])

    def test_others_are_not(self):
        for instruction in ("fmul\td0, d0, d1", "madd\tx0, x1, x2, x3", "mla\tv0.4s, v1.4s, v2.4s", "fsqrt\td0, d1",
                            "bl\t10 <fmadd>", "fmaxnm\td0, d0, d1"):
            with self.subTest(instruction=instruction):
                self.assertEqual(self.found(instruction), [])


class Processors(unittest.TestCase):
    def test_must_run_their_own_kernels(self):
        proof = aarch64.proof_of(aarch64.PROCESSORS[1])
        self.assertEqual([variant.threads for variant in proof.variants], [1, 2])
        self.assertEqual({variant.simd for variant in proof.variants}, {"sve"})
        self.assertIn("a64fx", proof.variants[0].emulator)


if __name__ == "__main__":
    unittest.main()
