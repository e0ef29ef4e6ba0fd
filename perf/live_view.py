#!/usr/bin/env python3
"""Measures how much a viewer slows a running world (docs/live.md). The program runs on one processor, the viewer on another.

    live_view.py TROUPE

Prints how many pictures of 2,000 robots a viewer receives in a second. Then prints the speed of a world of 100,000 robots with
a viewer, and with a viewer that does not read, relative to the speed without a viewer.
"""

import os
import subprocess
import sys
import tempfile
import time
from pathlib import Path

ROOT = Path(__file__).resolve().parent.parent
sys.path.insert(0, str(ROOT))
from tests.support.websocket import Socket  # noqa: E402

WORLD = ROOT / "worlds" / "hospital-10cm.json"  # has space for 100,000 robots
PROCESSORS = sorted(os.sched_getaffinity(0))


def on(processor):
    return lambda: os.sched_setaffinity(0, {processor})


class View:
    def __init__(self, troupe, folder, robots, *arguments):
        command = [troupe, "view", WORLD, "--robots", str(robots), "--threads", "1", "--out", folder, *map(str, arguments)]
        self.process = subprocess.Popen(command, stdout=subprocess.PIPE, text=True, preexec_fn=on(PROCESSORS[0]))
        address = ""
        while not address:
            line = self.process.stdout.readline()
            if not line:
                sys.exit(f"live_view.py: error: the program ended with {self.process.wait()} before it printed an address")
            if line.startswith("  view "):
                address = line.split()[1]
        self.port, self.token = int(address.split(":")[2].split("/")[0]), address.split("#")[1]

    def open(self):
        viewer = Socket(self.port, timeout=600)
        viewer.send(self.token)
        viewer.receive()
        return viewer


def pictures_per_second(troupe, folder, seconds=10):
    view = View(troupe, folder, 2000, "--rate", 0)
    viewer = view.open()
    count, size, begin = 0, 0, time.monotonic()
    while time.monotonic() < begin + seconds:
        message = viewer.receive()
        if isinstance(message, bytes):
            viewer.send('{"do": "drawn"}')
            count += 1
            size += len(message)
    view.process.kill()
    view.process.wait()
    return count / seconds, size / count


def speed(troupe, folder, world_s, watch):
    """Returns the ticks per second, from the arrival of the viewer to the end of the run, and the result of watch(viewer)."""
    view = View(troupe, folder, 100000, "--rate", 0, "--for", world_s)
    viewer = view.open()
    begin = time.monotonic()
    pictures = watch(viewer)
    view.process.wait()
    return 10 * world_s / (time.monotonic() - begin), pictures


def watched(viewer):
    pictures = []
    try:
        while True:
            message = viewer.receive()
            if isinstance(message, bytes):
                viewer.send('{"do": "drawn"}')
                pictures.append(len(message))
    except (ConnectionError, OSError):
        return pictures[1:]


def main():
    troupe = Path(sys.argv[1]).resolve()
    os.sched_setaffinity(0, {PROCESSORS[-1]})
    with tempfile.TemporaryDirectory() as folder:
        rate, size = pictures_per_second(troupe, folder)
        print(f"2,000 robots: {rate:.1f} pictures a second of {size / 1000:.1f} kB")
        world_s = 10
        alone, _ = speed(troupe, folder, world_s, lambda viewer: viewer.__exit__())
        for name, watch in (("a viewer", watched), ("a viewer that does not read", lambda viewer: [])):
            ticks, pictures = speed(troupe, folder, world_s, watch)
            size = f", {len(pictures)} pictures of {sum(pictures) / len(pictures) / 1000:.0f} kB" if pictures else ""
            print(f"100,000 robots: {ticks:.2f} ticks/s with {name}, {alone:.2f} without: {ticks / alone:.3f}{size}")


if __name__ == "__main__":
    main()
