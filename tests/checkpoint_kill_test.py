#!/usr/bin/env python3
"""Kills `troupe run --checkpoint` with SIGKILL at random times, N times, and checks that each kill leaves a valid checkpoint.

    checkpoint_kill_test.py PROGRAM [N] [--seed S]

Each run resumes from the previous checkpoint, writes checkpoints and a recording, and does not end by itself. The first run and
every other one are killed only after they have written a checkpoint, however slow the machine is. Every fourth run is killed as
soon as it begins to write one, and at least one kill must hit a write. Each run must leave a checkpoint that `troupe resume`
accepts, not older than the previous one, with the state of an uninterrupted run at that tick. The recording, which every run
continues, must equal that of the uninterrupted run. Prints one line with the last tick and the number of kills during a write.
"""

import argparse
import random
import signal
import subprocess
import sys
import tempfile
import time
from pathlib import Path

WORLD = """interval_sim 100
define wall model ( color "gray" )
wall( name "north" pose [0 4 0 0] size [8 0.2 1] )
wall( name "south" pose [0 -4 0 0] size [8 0.2 1] )
wall( name "east" pose [4 0 0 0] size [0.2 8 1] )
wall( name "west" pose [-4 0 0 0] size [0.2 8 1] )
define bot position ( size [0.4 0.3 0.2] ranger( sensor( fov 180 samples 9 range [0 3] ) ) ctrl "wander" )
""" + "".join(f"bot( pose [{x} {y} 0 {40 * x + 70 * y}] )\n" for x in range(-3, 4) for y in range(-3, 4))

FOREVER = "1e9"
WAIT_S = 240  # longest wait for a checkpoint, on a busy machine


class Runs:
    def __init__(self, program, folder):
        self.program = program
        self.folder = folder
        self.partial = folder / "c.h5.partial"  # exists while a checkpoint is written
        (folder / "room.world").write_text(WORLD)

    def troupe(self, *arguments):
        return subprocess.run([self.program, *arguments, "--quiet"], cwd=self.folder, capture_output=True, text=True)

    def saved(self):
        """Returns when the checkpoint was written. 0: there is none."""
        try:
            return (self.folder / "c.h5").stat().st_mtime_ns
        except FileNotFoundError:
            return 0

    def kill_one(self, after_a_checkpoint, in_a_write, wait_s):
        """Starts or resumes the run and kills it after wait_s seconds, or at that time after its first checkpoint, and then, if
        in_a_write is true, at the beginning of the next write of a checkpoint. Returns whether a checkpoint was being written."""
        self.partial.unlink(missing_ok=True)
        before = self.saved()
        go_on = before > 0
        command = ["resume", "c.h5"] if go_on else ["run", "room.world", "--force"]
        outputs = ["--checkpoint", "c.h5", "--checkpoint-every", "0.2", "--record", "r.h5"]
        process = subprocess.Popen([self.program, *command, "--for", FOREVER, "--quiet", "--threads", "1", *outputs],
                                   cwd=self.folder, stderr=subprocess.PIPE, text=True)
        until = time.monotonic() + WAIT_S
        while after_a_checkpoint and self.saved() == before and process.poll() is None and time.monotonic() < until:
            time.sleep(0.005)
        time.sleep(wait_s)
        while in_a_write and not self.partial.exists() and process.poll() is None and time.monotonic() < until:
            pass  # a sleep could miss the write
        process.send_signal(signal.SIGKILL)
        _, errors = process.communicate()
        if process.returncode != -signal.SIGKILL:
            raise SystemExit(f"the run ended by itself, with {process.returncode}: {errors}")
        if after_a_checkpoint and self.saved() == before:
            raise SystemExit(f"the run wrote no checkpoint within {WAIT_S} s")
        return self.partial.exists()

    def first_line(self):
        """Resumes the checkpoint and returns the first line of the hash log: its tick and state. Fails if it cannot be resumed."""
        log = self.folder / "later.log"
        log.unlink(missing_ok=True)
        done = self.troupe("resume", "c.h5", "--for", FOREVER, "--wall-limit", "1e-6", "--hash-log", log.name)
        if done.returncode != 3:
            raise SystemExit(f"the checkpoint cannot be resumed, exit code {done.returncode}: {done.stderr}")
        return next(line for line in log.read_text().splitlines() if not line.startswith("#"))


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("program", type=Path)
    parser.add_argument("kills", type=int, nargs="?", default=20)
    parser.add_argument("--seed", type=int, default=1, help="seed of the times of kills (which also depend on the machine)")
    options = parser.parse_args()
    moments = random.Random(options.seed)
    lines = []
    in_a_write = 0
    with tempfile.TemporaryDirectory() as name:
        runs = Runs(options.program.resolve(), Path(name))
        while len(lines) < options.kills:
            in_a_write += runs.kill_one(len(lines) % 2 == 0, len(lines) % 4 == 3, moments.uniform(0.02, 0.25))
            line = runs.first_line()
            if lines and int(line.split()[0]) < int(lines[-1].split()[0]):
                raise SystemExit(f"the checkpoint is older than the previous one: {line} after {lines[-1]}")
            lines.append(line)
        last = int(lines[-1].split()[0])
        end = str(last / 10 + 5)
        for command in (["run", "room.world", "--record", "straight.h5", "--hash-log", "straight.log"],
                        ["resume", "c.h5", "--record", "r.h5"]):
            done = runs.troupe(*command, "--for", end)
            if done.returncode != 0:
                raise SystemExit(f"troupe {' '.join(command)} failed: {done.stderr}")
        straight = set((Path(name) / "straight.log").read_text().splitlines())
        for line in lines:
            if line not in straight:
                raise SystemExit(f"the checkpoint has a state that the uninterrupted run never had: {line}")
        same = subprocess.run([runs.program, "diff", "straight.h5", "r.h5"], cwd=name, capture_output=True, text=True)
        if same.returncode != 0:
            raise SystemExit(f"the recording differs from that of the uninterrupted run: {same.stdout}{same.stderr}")
    if options.kills > 3 and in_a_write == 0:
        raise SystemExit(f"none of {options.kills} kills hit a write of a checkpoint, with seed {options.seed}: give more kills")
    print(f"{options.kills} kills, {in_a_write} of them during a write of a checkpoint: each left a valid checkpoint, the last at "
          f"tick {last}; their states and the recording equal those of an uninterrupted run")


if __name__ == "__main__":
    sys.exit(main())
