#!/usr/bin/env python3
"""Kills `troupe sweep` with SIGKILL at random moments, continues it, and compares its table with that of an uninterrupted
sweep. Then removes the results of a sweep while it runs, which must be an error.

    sweep_kill_test.py PROGRAM [KILLS] [SEED]    KILLS: default 3

The study is apps/examples/study/coverage.json, with 64 runs. Every kill happens before the sweep ends by itself. Runs
whose results had been written must not be repeated.
"""

import contextlib
import os
import random
import shutil
import signal
import subprocess
import sys
import tempfile
import time
from pathlib import Path

ROOT = Path(__file__).resolve().parent.parent
STUDY = ROOT / "apps/examples/study/coverage.json"
PROGRAM = Path(sys.argv[1]).resolve()
KILLS = int(sys.argv[2]) if len(sys.argv) > 2 else 3
SEED = int(sys.argv[3]) if len(sys.argv) > 3 else 1


def noted(folder):
    return sum(len(file.read_text().splitlines()) - 1 for file in folder.glob("runs-*.jsonl") if file.stat().st_size)


def loses_results(folder):
    """Removes the results of a sweep before its last runs. Returns a text that says what is wrong, empty if the sweep reports the
    missing results and writes no table; None if the sweep ended before its results could be removed."""
    process = subprocess.Popen([PROGRAM, "sweep", STUDY, "-o", folder, "--threads", "1", "--quiet"], stderr=subprocess.PIPE, text=True)
    while process.poll() is None and not (folder.exists() and noted(folder) > 0):
        time.sleep(0.01)
    process.send_signal(signal.SIGSTOP)
    with contextlib.suppress(ChildProcessError):  # it has ended, and poll() has noticed it
        os.waitid(os.P_PID, process.pid, os.WSTOPPED | os.WEXITED | os.WNOWAIT)
    if noted(folder) == 64:
        process.kill()
        process.communicate()
        return None
    (folder / "runs-1-of-1.jsonl").unlink()
    process.send_signal(signal.SIGCONT)
    errors = process.communicate()[1]
    text = f"{folder}: error: the results of 64 finished runs are missing, so there is no table: "
    if process.returncode != 1 or not errors.startswith(text) or (folder / "table.csv").exists():
        return f"the results of runs were removed, but the sweep ended with {process.returncode}: {errors}"
    return ""


def main():
    draws = random.Random(SEED)
    with tempfile.TemporaryDirectory(prefix="troupe-sweep-") as name:
        whole, killed = Path(name) / "whole", Path(name) / "killed"
        start = time.monotonic()
        subprocess.run([PROGRAM, "sweep", STUDY, "-o", whole, "--threads", "1", "--quiet"], check=True)
        takes_s = time.monotonic() - start
        kills = 0
        for _ in range(100 * KILLS):
            if kills == KILLS:
                break
            process = subprocess.Popen([PROGRAM, "sweep", STUDY, "-o", killed, "--threads", "2", "--quiet"])
            time.sleep(draws.uniform(0, takes_s / KILLS))
            process.send_signal(signal.SIGKILL)
            if process.wait() == -signal.SIGKILL:
                kills += 1
            else:  # the sweep had already ended: begin again
                shutil.rmtree(killed)
                kills = 0
        before = noted(killed) if killed.exists() else 0
        subprocess.run([PROGRAM, "sweep", STUDY, "-o", killed, "--threads", "2", "--quiet"], check=True)
        print(f"{kills} kills (seed {SEED}), {before} of 64 runs noted before the last call")
        if kills < KILLS or noted(killed) != 64:
            print(f"{noted(killed)} runs are noted, after {kills} kills")
            return 1
        for table in ("table.csv", "table.h5", "series.csv"):
            if (whole / table).exists() and (whole / table).read_bytes() != (killed / table).read_bytes():
                print(f"{table} is another one than without kills")
                return 1
        faults = (loses_results(Path(name) / f"lost-{i}") for i in range(100))
        if fault := next((fault for fault in faults if fault is not None), "the results of no sweep could be removed"):
            print(fault)
            return 1
        return 0 if (whole / "table.csv").exists() else 1


if __name__ == "__main__":
    sys.exit(main())
