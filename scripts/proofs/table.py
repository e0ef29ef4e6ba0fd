"""The table of scripts/prove, and its progress line."""

import sys
import threading
import time


def clock(seconds):
    return f"{int(seconds // 60)}:{int(seconds % 60):02d}"


def print_row(cells):
    widths = (52, 47, 5, 9, 16)
    print("  ".join(f"{cell:<{width}}" for cell, width in zip(cells, widths)).rstrip(), flush=True)


class Progress:
    """A progress line on standard error. On a terminal, show() overwrites the line; elsewhere, it prints a new line, but at most
    every 15 s. Several threads may use it. total: number of runs."""

    def __init__(self, total):
        self.total, self.started, self.start, self.shown = total, 0, time.monotonic(), 0.0
        self.terminal = sys.stderr.isatty()
        self.lock = threading.Lock()

    def show(self, what):
        """Counts one more started run, `what`."""
        with self.lock:
            self.started += 1
            now = time.monotonic()
            if not self.terminal and now - self.shown < 15:
                return
            self.shown = now
            elapsed, done = now - self.start, self.started - 1
            left = f", about {clock(elapsed * (self.total - done) / done)} remain" if done else ""
            text = f"  {what}; {clock(elapsed)} minutes passed{left}"
            print(f"\r{text:<120}" if self.terminal else text, end="" if self.terminal else "\n", file=sys.stderr, flush=True)

    def clear(self):
        if self.terminal:
            print(f"\r{'':<120}\r", end="", file=sys.stderr, flush=True)
