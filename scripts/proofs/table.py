"""The table of scripts/prove, and its progress line."""

import sys
import time


def clock(seconds):
    return f"{int(seconds // 60)}:{int(seconds % 60):02d}"


def print_row(cells):
    widths = (52, 47, 5, 9, 16)
    print("  ".join(f"{cell:<{width}}" for cell, width in zip(cells, widths)).rstrip(), flush=True)


class Progress:
    """A progress line on standard error. On a terminal, show() overwrites the line; elsewhere, it prints a new line, but at most
    every 15 s. total: number of runs; the caller must increase `done` with each run."""

    def __init__(self, total):
        self.total, self.done, self.start, self.shown = total, 0.0, time.monotonic(), 0.0
        self.terminal = sys.stderr.isatty()

    def show(self, what):
        now = time.monotonic()
        if not self.terminal and now - self.shown < 15:
            return
        self.shown = now
        elapsed = now - self.start
        left = f", about {clock(elapsed * (self.total - self.done) / self.done)} remain" if self.done else ""
        text = f"  {what}; {clock(elapsed)} minutes passed{left}"
        print(f"\r{text:<120}" if self.terminal else text, end="" if self.terminal else "\n", file=sys.stderr, flush=True)

    def clear(self):
        if self.terminal:
            print(f"\r{'':<120}\r", end="", file=sys.stderr, flush=True)
