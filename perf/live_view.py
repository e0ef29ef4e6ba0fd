#!/usr/bin/env python3
"""Measures how much a viewer slows a running world (docs/live.md). The program runs on one processor, the viewer on another.

    perf/live_view.py TROUPE

TROUPE is the path of the program. The script prints

- how many pictures of 2,000 robots a viewer receives in a second;
- the speed of a world of 100,000 robots with a viewer, and with a viewer that does not read its connection, relative to the
  speed without a viewer;
- by how much the resident memory of the program grows while a viewer reads nothing for a minute;
- if Chromium is installed: how long the scripts of the page run for each picture of 10,000 robots, and how many pictures the
  page draws in a second. Chromium draws without a GPU.
"""

import argparse
import os
import subprocess
import sys
import tempfile
import time
from pathlib import Path

ROOT = Path(__file__).resolve().parent.parent
sys.path.insert(0, str(ROOT))
from tests.support.chromium import Page, find  # noqa: E402
from tests.support.websocket import Socket  # noqa: E402

WORLD = ROOT / "worlds" / "hospital-10cm.json"  # has space for 100,000 robots
PROCESSORS = sorted(os.sched_getaffinity(0))


def on(processor):
    return lambda: os.sched_setaffinity(0, {processor})


class View:
    """A running `troupe view`, which the end of a `with` statement kills."""

    def __init__(self, troupe, folder, robots, *arguments):
        command = [troupe, "view", WORLD, "--robots", str(robots), "--threads", "1", "--out", folder, *map(str, arguments)]
        self.process = subprocess.Popen(command, stdout=subprocess.PIPE, text=True, preexec_fn=on(PROCESSORS[0]))
        self.address = ""
        while not self.address:
            line = self.process.stdout.readline()
            if not line:
                sys.exit(f"live_view.py: error: {troupe} ended with exit code {self.process.wait()} before it printed the "
                         "address of the view")
            if line.startswith("  view "):
                self.address = line.split()[1]
        self.port, self.token = int(self.address.split(":")[2].split("/")[0]), self.address.split("#")[1]

    def __enter__(self):
        return self

    def __exit__(self, *_):
        self.process.kill()
        self.process.wait()

    def open(self):
        viewer = Socket(self.port, timeout=600)
        viewer.send(self.token)
        viewer.receive()
        return viewer

    def memory(self):
        """Returns the resident memory, bytes."""
        pages = int(Path(f"/proc/{self.process.pid}/statm").read_text().split()[1])
        return pages * os.sysconf("SC_PAGE_SIZE")


def pictures_per_second(troupe, folder, seconds=10):
    with View(troupe, folder, 2000, "--rate", 0) as view:
        viewer = view.open()
        count, size, begin = 0, 0, time.monotonic()
        while time.monotonic() < begin + seconds:
            message = viewer.receive()
            if isinstance(message, bytes):
                viewer.send('{"do": "drawn"}')
                count += 1
                size += len(message)
    return count / seconds, size / count


def growth(troupe, folder, seconds=60):
    """Returns by how much the memory grows while a viewer does not read, bytes."""
    with View(troupe, folder, 2000, "--rate", 0) as view, view.open():
        time.sleep(5)  # until all memory that every run needs is allocated
        before = view.memory()
        time.sleep(seconds)
        after = view.memory()
    return after - before


def in_browser(troupe, folder, seconds=20):
    """Returns how long the scripts of the page run per picture, s, and how many pictures the page draws per second."""
    with View(troupe, folder, 10000) as view, Page(find()) as page:
        # The page confirms each picture that it has drawn.
        page.call("Page.addScriptToEvaluateOnNewDocument", source="""
            window.drawn = 0;
            const send = WebSocket.prototype.send;
            WebSocket.prototype.send = function (text) {
              if (text.startsWith('{"do":"drawn"')) window.drawn += 1;
              return send.call(this, text);
            };""")
        page.open_address(view.address)
        page.wait("window.drawn > 20")
        page.call("Performance.enable")

        def metrics():
            found = {each["name"]: each["value"] for each in page.call("Performance.getMetrics")["metrics"]}
            return found["Timestamp"], found["ScriptDuration"], page.run("window.drawn")

        before = metrics()
        time.sleep(seconds)
        passed, scripts, drawn = (after - start for after, start in zip(metrics(), before))
    return scripts / drawn, drawn / passed


def speed(troupe, folder, world_s, watch):
    """Returns the ticks per second, from the arrival of the viewer to the end of the run, and the result of watch(viewer)."""
    with View(troupe, folder, 100000, "--rate", 0, "--for", world_s) as view:
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
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("troupe", type=Path, metavar="TROUPE")
    troupe = parser.parse_args().troupe.resolve()
    if not troupe.is_file():
        parser.error(f"there is no program {troupe}; scripts/build release builds build/release/bin/troupe")
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
        print(f"2,000 robots: {growth(troupe, folder) / 1e6:.2f} MB more memory after a minute with a viewer that does not read")
        if not find():
            print("10,000 robots in Chromium: NOT MEASURED, because Chromium is not installed")
            return
        script_s, rate = in_browser(troupe, folder)
        print(f"10,000 robots in Chromium: {1000 * script_s:.2f} ms of scripts per picture, {rate:.1f} pictures a second")


if __name__ == "__main__":
    main()
