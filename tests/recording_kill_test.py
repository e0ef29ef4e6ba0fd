#!/usr/bin/env python3
"""Kills runs that write a recording at random moments, and reads the recordings with h5py.

    recording_kill_test.py TROUPE [KILLS] [SEED]    KILLS: default 20; the long test uses 200

Each recording must contain every frame that had been flushed, readable with swmr=True and equal to the frame of an
uninterrupted run. After `troupe repair`, h5py must read the same frames without swmr. The hash log of the same run shows
how many ticks the run had completed. The times of the kills are measured from a random number of ticks, so that a slow machine
kills as many runs with frames as a fast one. One more recording is read while its run goes on.
"""

import os
import random
import signal
import subprocess
import sys
import tempfile
import time
from pathlib import Path

SKIPPED = 77  # ctest's SKIP_RETURN_CODE

try:
    import h5py
    import numpy as np
except ImportError:
    system = "/usr/bin/python3"  # has Debian's h5py, even if another Python is first on the path
    if os.path.exists(system) and os.environ.get("TROUPE_SYSTEM_PYTHON") is None:
        os.execve(system, [system, *sys.argv], {**os.environ, "TROUPE_SYSTEM_PYTHON": "1"})
    print("SKIPPED: no h5py (scripts/setup --checks installs python3-h5py): "
          "what a killed recording leaves was not checked")
    sys.exit(SKIPPED)

TROUPE = Path(sys.argv[1]).resolve()
KILLS = int(sys.argv[2]) if len(sys.argv) > 2 else 20
SEED = int(sys.argv[3]) if len(sys.argv) > 3 else 1
LONGEST_S = 0.4  # longest time from the start of a run, or from a tick of it, to its kill
MOST_TICKS = 2000
WAIT_S = 240  # longest wait for a tick, on a busy machine

WORLD = """
interval_sim 100
define wall model ( color "gray" )
wall( pose [0 4 0 0] size [8 0.2 1] )
wall( pose [0 -4 0 0] size [8 0.2 1] )
wall( pose [4 0 0 0] size [0.2 8 1] )
wall( pose [-4 0 0 0] size [0.2 8 1] )
define bot position ( size [0.4 0.3 0.2]
  ranger( pose [0 0 -0.15 0] sensor( fov 180 samples 9 range [0 3] ) ) ctrl "wander" )
""" + "".join(f"bot( pose [{x} {y} 0 {40 * x + 10 * y}] )\n" for x in (-2, 0, 2) for y in (-2, 0, 2))

FIELDS = ["pose", "all"]  # both flush every 256 frames; "all" has seven times as many arrays


def arrays(group, path=""):
    """Returns the arrays that have one row per frame, by path."""
    for name, item in group.items():
        if isinstance(item, h5py.Group):
            yield from arrays(item, f"{path}{name}/")
        else:
            yield f"{path}{name}", item


def framed(file):
    for top in ("frames", "state", "sensors"):
        if top in file:
            yield from arrays(file[top], f"{top}/")


def whole_frames(file):
    tick = file["frames/tick"][:]
    return int(np.argmax(tick == 2**64 - 1)) if (tick == 2**64 - 1).any() else len(tick)


def run(arguments, **options):
    return subprocess.Popen([TROUPE, "run", "room.world", "--quiet", *arguments], cwd=FOLDER, **options)


class Reference:
    """An uninterrupted run that is at least as long as all killed runs so far."""

    def __init__(self, fields):
        self.fields = fields
        self.frames = 0
        self.arrays = {}

    def covers(self, frames):
        if frames <= self.frames:
            return
        self.frames = 2 * frames
        self.file = FOLDER / f"whole-{self.fields}.h5"
        code = run(["--for", f"{(self.frames - 1) / 10}", "--record", self.file, "--record-fields", self.fields,
                    "--force"]).wait()
        assert code == 0, f"the undisturbed run ended with {code}"
        with h5py.File(self.file) as file:
            self.arrays = {path: array[:] for path, array in framed(file)}

    def compare(self, path, array):
        expected = self.arrays[path][:len(array)]
        assert np.array_equal(expected.view(np.uint8), array.view(np.uint8)), f"{path} is not that of the whole run"


def check(file, reference, frames, exactly):
    reference.covers(frames)
    seen = 0
    for path, array in framed(file):
        assert len(array) == frames if exactly else len(array) >= frames, f"{path} has {len(array)} of {frames} frames"
        if frames:
            reference.compare(path, array[:frames])
        seen += 1
    assert frames == 0 or seen == len(reference.arrays), f"{seen} arrays"


def logged(log):
    """Returns the number of the last tick in a hash log."""
    return max(0, sum(not line.startswith("#") for line in log.read_text().split("\n")[:-1]) - 1) if log.exists() else 0


def kill_one(number, rng, reference):
    recording, log = FOLDER / f"run{number}.h5", FOLDER / f"run{number}.log"
    process = run(["--for", "1e9", "--record", recording, "--record-fields", reference.fields, "--hash-log", log])
    # Every fourth run is killed at any time after its start.
    least = 0 if number % 4 == 3 else rng.randrange(MOST_TICKS)
    until = time.monotonic() + WAIT_S
    while logged(log) < least and process.poll() is None and time.monotonic() < until:
        time.sleep(0.01)
    time.sleep(rng.uniform(0, LONGEST_S))
    process.send_signal(signal.SIGKILL)
    assert process.wait() == -signal.SIGKILL, "the run had ended by itself"

    # The last tick in the log may be one that was logged but not yet recorded.
    ticks = logged(log)
    try:
        with h5py.File(recording, "r", swmr=True) as file:
            batch = file["state/pose/x"].chunks[0]
            frames = whole_frames(file)
            # The last complete batch may not have been flushed yet.
            assert frames >= (ticks // batch - 1) * batch, f"{frames} frames of {ticks} ticks, {batch} a batch"
            check(file, reference, frames, exactly=False)
    except OSError as fault:  # killed before the header of the file was written
        assert ticks == 0, f"{ticks} ticks, and the file cannot be read: {fault}"
        return None

    repair = subprocess.run([TROUPE, "repair", recording], capture_output=True, text=True)
    assert repair.returncode == 0, repair.stderr
    assert repair.stdout.endswith(f": repaired: {frames} frame{'s' * (frames != 1)}\n"), repair.stdout
    with h5py.File(recording, "r") as file:
        check(file, reference, frames, exactly=True)
    recording.unlink()
    log.unlink(missing_ok=True)  # it is opened after the recording
    return frames


def read_while_it_runs(reference):
    recording = FOLDER / "live.h5"
    process = run(["--for", "1e9", "--record", recording, "--record-fields", reference.fields])
    frames = 0
    deadline = time.monotonic() + WAIT_S
    while frames < 1000 and time.monotonic() < deadline:
        time.sleep(0.05)
        try:
            with h5py.File(recording, "r", swmr=True) as file:
                frames = whole_frames(file)
                check(file, reference, frames, exactly=False)
        except OSError:
            continue
        refused = subprocess.run([TROUPE, "repair", recording], capture_output=True, text=True)
        assert refused.returncode == 2 and "is still writing the file" in refused.stderr, refused
    process.terminate()
    assert process.wait() == 3
    assert frames >= 1000, "nothing to be read while it ran"
    with h5py.File(recording, "r") as file:
        check(file, reference, len(file["frames/tick"]), exactly=True)


def main():
    rng = random.Random(SEED)
    (FOLDER / "room.world").write_text(WORLD)
    references = [Reference(fields) for fields in FIELDS]
    read_while_it_runs(references[1])
    kept = []
    for number in range(KILLS):
        try:
            kept.append(kill_one(number, rng, references[number % len(references)]))
        except AssertionError as fault:
            print(f"FAILED: kill {number} of {KILLS} with seed {SEED}: {fault}")
            return 1
    frames = [n for n in kept if n]
    if len(frames) < KILLS // 4:
        print(f"FAILED: only {len(frames)} of {KILLS} killed runs left frames, with seed {SEED}")
        return 1
    print(f"{KILLS} kills: {len(frames)} recordings of {min(frames, default=0)} to {max(frames, default=0)} frames, every "
          f"flushed row read back; {kept.count(0)} without a batch, {kept.count(None)} before the file began")
    return 0


if __name__ == "__main__":
    with tempfile.TemporaryDirectory(prefix="troupe_kill_") as name:
        FOLDER = Path(name)
        sys.exit(main())
