#!/usr/bin/env python3
"""Loads, runs, resets, saves and resumes worlds, and continues recordings from checkpoints, again and again in one process,
until the process is killed. Prints counts about once a second, as one line of JSON. scripts/soak starts this script.

    soak_worker.py FOLDER WORLD...    FOLDER: folder for the files that the script writes
"""

import json
import pathlib
import sys
import time

import troupe

RESETS = 400  # resets of a world before the next world
TICKS = 12


class Soaker:
    def __init__(self, folder):
        self.folder = pathlib.Path(folder)
        self.counts = {"resets": 0, "saves": 0, "recordings_cut": 0}
        self.differences = []
        self.next_line = 0.0

    def tell(self):
        if time.monotonic() < self.next_line and not self.differences:
            return
        self.next_line = time.monotonic() + 1
        print(json.dumps({**self.counts, "differences": self.differences}), flush=True)
        self.differences = []

    def expect(self, what, expected, simulation):
        if simulation.state_hash() != expected:
            self.differences.append(f"{what}: the state hash at tick {simulation.tick} is {simulation.state_hash():016x}, "
                                    f"expected {expected:016x}")

    def soak(self, world, turn):
        name = pathlib.Path(world).name
        simulation = troupe.Simulation(world, threads=1 + turn % 3)
        measures = troupe.Measures(simulation, ["coverage", "path_length", "stalls"])
        begins = simulation.state_hash()
        simulation.step(TICKS)
        middle = simulation.state_hash()
        simulation.step(TICKS)
        ends = simulation.state_hash()
        for i in range(RESETS):
            simulation.reset()
            self.counts["resets"] += 1
            self.expect(f"{name}, reset", begins, simulation)
            if i % 4 == 0:
                simulation.step(TICKS)
                measures.see()
                self.expect(f"{name}, {TICKS} ticks after a reset", middle, simulation)
            if i % 100 == 0:
                self.save(name, simulation, turn, ends)
            self.tell()

    def save(self, name, simulation, turn, ends):
        """Saves a run after TICKS ticks, resumes it, continues its recording (which removes the frame recorded after the
        checkpoint), and compares the hash of its state after further TICKS ticks with `ends`, the hash of an uninterrupted
        run."""
        checkpoint, recording = self.folder / "checkpoint.h5", self.folder / "recording.h5"
        simulation.reset()
        self.counts["resets"] += 1
        with troupe.Recording(recording, simulation, fields=["all"], replace=True) as frames:
            frames.observe()
            for _ in range(TICKS):
                simulation.step()
                frames.observe()
            simulation.save(checkpoint)
            simulation.step()
            frames.observe()  # after the checkpoint: the resumed run removes it
        resumed = troupe.Simulation.resume(checkpoint, threads=1 + (turn + 1) % 3)
        self.counts["saves"] += 1
        with troupe.Recording.resume(recording, resumed) as frames:
            self.counts["recordings_cut"] += 1
            for _ in range(TICKS):
                resumed.step()
                frames.observe()
        self.expect(f"{name}, resumed", ends, resumed)


def main():
    folder, *worlds = sys.argv[1:]
    soaker = Soaker(folder)
    turn = 0
    while True:
        soaker.soak(worlds[turn % len(worlds)], turn)
        turn += 1


if __name__ == "__main__":
    main()
