"""Runs of the program and their hash logs."""

import os
import pathlib
import re
import shlex
import subprocess
import sys
from dataclasses import dataclass, field

ROOT = pathlib.Path(__file__).resolve().parent.parent.parent
GOLDEN = ROOT / "worlds" / "golden_hashes.txt"


class Fault(Exception):
    """Raised if runs cannot be compared, because something that they need is missing or invalid, or because a program failed."""


@dataclass(frozen=True)
class World:
    file: str
    tick_s: float = 0.1
    # Cost of a tick relative to the first world, per thread; for the estimate of the remaining time.
    weight: float = 1.0
    # Ranging engine, if not the world's own.
    ranging: str = ""
    # Sizes of populations, NAME=N, if not those of the world.
    populations: tuple = ()

    @property
    def key(self):
        """The key of this world in the golden file (worlds/golden_hashes.txt): FILE, or FILE:RANGING for another ranging
        engine."""
        return f"{self.file}:{self.ranging}" if self.ranging else self.file

    @property
    def name(self):
        return "-".join(filter(None, (pathlib.Path(self.file).stem, self.ranging)))

    @property
    def arguments(self):
        sizes = [word for size in self.populations for word in ("--robots", size)]
        return [ROOT / "worlds" / self.file, *(["--raytracer", self.ranging] if self.ranging else []), *sizes]


def available_simd(program):
    """Returns the names of the instruction sets on which the kernels of the program can run on this machine."""
    version = subprocess.run([program, "--version"], check=True, capture_output=True, text=True).stdout
    return re.search(r"\(available: (.*)\)", version)[1].split()


@dataclass(frozen=True)
class Variant:
    """A way to run a world. All variants must give the same results."""

    label: str
    program: pathlib.Path
    threads: int = 1
    tile_m: float = 0
    options: tuple = ()  # further options of the program
    environment: dict = field(default_factory=dict)
    folder: pathlib.Path = None  # working folder
    restarts: tuple = ()  # ticks at which the run is saved and resumed by another process
    emulator: tuple = ()  # command that runs the program
    simd: str = ""  # instruction set on which its kernels must run

    def lines(self, world, ticks, folder, robots=None):
        """Runs the world and returns the lines of the hash log, one per tick, from tick 0. The header of the log is omitted,
        because it may differ between variants. folder: folder for the files of the run. robots: number of robots; None: the
        number in the world. Raises Fault if the program fails or uses another instruction set than `simd`."""
        log = folder / "run.log"
        source = ["run", *world.arguments, *(["--robots", robots] if robots is not None else [])]
        for end in (*self.restarts, ticks):
            checkpoint = folder / f"tick-{end}.h5"
            save = ["--checkpoint", checkpoint, "--force"] if end != ticks else []
            self._call([*source, "--for", f"{end * world.tick_s:.9g}", "--hash-log", log, *save])
            source = ["resume", checkpoint]  # also continues the log
        if self.simd and self.simd != (ran := simd_of(log)):
            raise Fault(f"{self.label}: kernels must run on {self.simd}, but ran on {ran}, according to {log.name}")
        lines = read_log(log)
        if len(lines) != ticks + 1:
            raise Fault(f"{world.file}: expected {ticks + 1} lines in the hash log (tick 0 and {ticks} ticks), "
                        f"found {len(lines)}")
        return lines

    def _call(self, arguments):
        command = [*self.emulator, self.program, *arguments, "--threads", self.threads, "--quiet", *self.options]
        if self.tile_m:
            command += ["--tile-size", self.tile_m]
        command = [str(word) for word in command]
        done = subprocess.run(command, capture_output=True, text=True, cwd=self.folder, env={**os.environ, **self.environment})
        if done.returncode != 0:
            raise Fault(f"{self.label}: {' '.join(command)}\nexit code {done.returncode}: {done.stderr.strip()}")
        # The dynamic linker then runs the program without the library. The paths in LD_PRELOAD must not contain spaces.
        if missed := [line for line in done.stderr.splitlines() if "cannot be preloaded" in line]:
            raise Fault(f"{self.label}: {missed[0]}")


def read_log(log):
    return [line for line in pathlib.Path(log).read_text().splitlines() if not line.startswith("#")]


def simd_of(log):
    """Returns the name of the instruction set in the header of a hash log."""
    head = (line for line in pathlib.Path(log).read_text().splitlines() if line.startswith("# simd: "))
    return next(head, "# simd: an unknown instruction set").removeprefix("# simd: ")


def state_of(line):
    return line.split()[1]


def difference(expected, got):
    """Returns a text with the first difference between two hash logs, which are lists of lines. The text is empty if there is
    no difference; surplus lines of the longer log are ignored."""
    for a, b in zip(expected, got):
        if a == b:
            continue
        tick = a.split()[0]
        groups = [x.split("=")[0] for x, y in zip(a.split()[2:], b.split()[2:]) if x != y]
        return (f"differs from tick {tick} on, in {', '.join(groups) or 'the format of the line'}:\n  expected {a}\n"
                f"  got      {b}")
    return ""


def read_golden():
    golden = {}
    if not GOLDEN.exists():
        return golden
    for line in GOLDEN.read_text().splitlines():
        if line.strip() and not line.startswith("#"):
            world, robots, tick, state = line.split()
            golden[world, None if robots == "-" else int(robots), int(tick)] = state
    return golden


def program_of(preset):
    return ROOT / "build" / preset / "bin" / "troupe"


def add_program_option(parser):
    parser.add_argument("--program", type=pathlib.Path, default=program_of("release"), metavar="FILE")


def checked_program(parser, options):
    """Returns the absolute path of the program that --program gives. Without such a file, the script ends with an error."""
    if not options.program.is_file():
        parser.error(f"there is no program {options.program}; build it with scripts/build release, or name another one with --program")
    return options.program.resolve()


def end_with(main):
    """Ends the script with the exit code that main() returns. A Fault, a command that fails, and Ctrl-C end it with other exit
    codes and without a traceback."""
    name = f"scripts/{pathlib.Path(sys.argv[0]).name}"
    try:
        sys.exit(main())
    except Fault as fault:
        print(f"{name}: error: {fault}", file=sys.stderr)
        sys.exit(2)
    except subprocess.CalledProcessError as failed:
        print(f"{name}: error: exit code {failed.returncode} of {shlex.join(map(str, failed.cmd))}", file=sys.stderr)
        sys.exit(2)
    except KeyboardInterrupt:
        sys.exit(130)


def build(preset, *targets):
    print(f"building {preset} ...", flush=True)
    done = subprocess.run([ROOT / "scripts" / "build", preset, *targets], stdout=subprocess.PIPE, stderr=subprocess.STDOUT,
                          text=True)
    if done.returncode != 0:
        raise Fault(f"{done.stdout}scripts/build {preset} failed")
