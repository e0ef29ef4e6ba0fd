#!/usr/bin/env python3
"""Tests that scripts/test accepts the arguments in its --help, and rejects others before it does anything."""

import json
import pathlib
import subprocess
import unittest

ROOT = pathlib.Path(__file__).resolve().parent.parent


def call(*arguments):
    return subprocess.run([ROOT / "scripts/test", *arguments], capture_output=True, text=True, timeout=60)


class Arguments(unittest.TestCase):
    def presets(self):
        """Returns the presets of ctest, except aarch64, which needs an emulator and is run by scripts/check-aarch64."""
        listed = json.loads((ROOT / "CMakePresets.json").read_text())["testPresets"]
        return [preset["name"] for preset in listed if not preset.get("hidden") and preset["name"] != "aarch64"]

    def test_help(self):
        for option in ("--help", "-h"):
            done = call(option)
            self.assertEqual((done.returncode, done.stderr), (0, ""))
            self.assertIn("\n  scripts/test --all ", done.stdout)
            self.assertIn(f"PRESET...   other presets: {', '.join(self.presets())}\n", done.stdout)
            self.assertNotIn("set -", done.stdout)

    def test_unknown_arguments_are_errors(self):
        presets = self.presets()
        allowed = f"{', '.join(presets[:-1])} and {presets[-1]}"
        for arguments in (["--everything"], ["--all", "relase"], ["release", "--quick"], [""], ["aarch64"]):
            done = call(*arguments)
            self.assertEqual((done.returncode, done.stdout), (2, ""))
            wrong = next(argument for argument in arguments if argument not in ("--all", "release"))
            self.assertEqual(done.stderr, f'scripts/test: error: unknown argument "{wrong}"; allowed are --all, '
                                          f"--folders=NAME,..., --help, and the presets {allowed}\n")

    def test_folders_without_tests_are_errors(self):
        done = call("--folders=base,docs", "dev")
        self.assertEqual((done.returncode, done.stdout), (2, ""))
        self.assertEqual(done.stderr, "scripts/test: error: tests/docs has no test program, in --folders=base,docs\n")

    def test_ci_tests_what_is_shipped_wholly_and_with_sanitizers(self):
        self.assertIn("\nscripts/test --all release\n"
                      "scripts/test --folders=base,partition,engine,sensors,models,worldio,fuzz dev\n",
                      (ROOT / ".ci/run").read_text())


if __name__ == "__main__":
    unittest.main()
