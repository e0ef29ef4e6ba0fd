#!/usr/bin/env python3
"""Tests that each pattern of slow tests matches at least one test of the program: slow_tests_test.py PROGRAM PATTERN..."""

import subprocess
import sys


def main(program, patterns):
    listed = [subprocess.run([program, "--gtest_list_tests", f"--gtest_filter={pattern}"], capture_output=True, text=True,
                             check=True).stdout for pattern in patterns]
    # Names of tests are indented below their suite's.
    stale = [pattern for pattern, names in zip(patterns, listed) if not any(line.startswith("  ") for line in names.splitlines())]
    if stale:
        sys.exit(f"{program}: no test has a name like {', '.join(stale)} (SLOW in tests/CMakeLists.txt)")


if __name__ == "__main__":
    main(sys.argv[1], sys.argv[2:])
