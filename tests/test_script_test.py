#!/usr/bin/env python3
"""Tests that scripts/test accepts the arguments in its --help, rejects others before it does anything, and builds what it runs.

    test_script_test.py BUILD    BUILD: the folder of a build
"""

import collections
import json
import pathlib
import re
import subprocess
import sys
import tempfile
import unittest

ROOT = pathlib.Path(__file__).resolve().parent.parent
BUILD = pathlib.Path(sys.argv.pop(1))


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
            self.assertEqual(done.stderr, f'scripts/test: error: unknown argument "{wrong}"; allowed are --all, --long, --bare, '
                                          f"--folders=NAME,..., --times, --help, and the presets {allowed}\n")

    def test_folders_without_tests_are_errors(self):
        done = call("--folders=base,docs", "dev")
        self.assertEqual((done.returncode, done.stdout), (2, ""))
        self.assertEqual(done.stderr, "scripts/test: error: tests/docs has no test program, in --folders=base,docs\n")

    def test_the_test_program_of_a_folder_needs_all_that_the_tests_of_the_folder_need(self):
        if not (BUILD / "build.ninja").exists():
            self.skipTest("needs a build with Ninja")
        with tempfile.TemporaryDirectory() as folder:  # ctest replaces its logs in the folder of a build even if it only lists
            (pathlib.Path(folder) / "CTestTestfile.cmake").write_text(f'subdirs("{BUILD}")\n')
            listed = subprocess.run(["ctest", "--show-only=json-v1"], cwd=folder, capture_output=True, text=True, check=True).stdout
        needed = collections.defaultdict(set)
        for test in json.loads(listed)["tests"]:
            folder, dot, _ = test["name"].partition(".")
            if dot and list(ROOT.glob(f"tests/{folder}/*_test.cpp")):
                needed[folder].update(re.findall(rf"{re.escape(str(BUILD))}/([^\s=;]+)", " ".join(test.get("command", ()))))
        self.assertIn("bin/base_test", needed["base"])
        for folder, files in needed.items():
            built = subprocess.run(["ninja", "-t", "commands", f"{folder}_test"], cwd=BUILD, capture_output=True, text=True,
                                   check=True).stdout
            self.assertEqual([file for file in sorted(files) if file not in built], [], f"scripts/test --folders={folder}")

    def test_ci_tests_what_is_shipped_wholly_and_with_sanitizers(self):
        self.assertIn("\nscripts/test --all release\n"
                      "scripts/test --bare release\n"
                      "scripts/test --folders=base,partition,engine,sensors,models,worldio,fuzz dev\n",
                      (ROOT / ".ci/run").read_text())


if __name__ == "__main__":
    unittest.main()
