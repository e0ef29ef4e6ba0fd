"""The proofs of scripts/prove. A proof is a list of variants of a run, for example with other numbers of threads. A variant must
not change any bit of the state. T0, T1 and T2 in the names of proofs are tiers of docs/determinism.md. They say what the runs
have in common: T0 the machine and the program, T1 the program, T2 only the sources."""

import os
import pathlib
import shutil
import subprocess
import sys
from dataclasses import dataclass, replace

from .runs import ROOT, Variant, available_simd

# Instruction sets of kernels, with the names of --simd, and the flags of /proc/cpuinfo for them.
INSTRUCTION_SETS = (("scalar", None), ("ssse3", "ssse3"), ("sse4", "sse4_2"), ("avx2", "avx2"), ("avx512", "avx512bw"))

# Processor features by which glibc selects its code; glibc ignores unknown names.
GLIBC_MASKS = ("-AVX512F,-AVX512VL,-AVX2,-FMA,-FMA4,-AVX,-ERMS", "-AVX512F,-AVX512VL", "-FMA,-FMA4")


@dataclass(frozen=True)
class Proof:
    name: str
    about: str  # description of its variants
    variants: tuple


def hostile(name):
    """Returns the path of the library NAME.so, which the preset release builds from tests/hostile."""
    return ROOT / "build" / "release" / "hostile" / f"{name}.so"


def threads_and_tiles(program, threads, tiles):
    variants = tuple(Variant(f"{n} thread{'s' if n > 1 else ''}, {f'tiles of {tile} m' if tile else 'default tiles'}",
                             program, n, tile) for tile in tiles for n in threads)
    return Proof("T0 threads and tiles", f"{len(threads)} thread counts x {len(tiles)} tile sizes", variants)


def ranks(base, teams):
    """Several ranks in one process. A rank is a group of threads that computes some of the robots, and exchanges messages with
    the other ranks. Messages are delayed and shuffled, and robots are moved to other ranks at random. teams:
    (number of ranks, threads per rank, seed of the delays) of each variant."""
    variants = tuple(replace(base, label=f"{n} ranks, {threads} threads, seed {seed}", threads=threads,
                             options=("--ranks", n, "--rank-seed", seed)) for n, threads, seed in teams)
    return Proof("T0 ranks", "late, shuffled messages; robots change their ranks", variants)


def distributed_ranks(base, teams):
    """Like ranks(), but each rank has only its own robots and those near them, if the world allows it."""
    variants = tuple(replace(base, label=f"{n} ranks, distributed, {threads} threads, seed {seed}", threads=threads,
                             options=("--ranks", n, "--rank-seed", seed, "--distribute")) for n, threads, seed in teams)
    return Proof("T0 distributed ranks", "late, shuffled messages; random regions", variants)


# The launcher of each MPI, and options that let ranks share the processors of a small computer.
LAUNCHERS = {"openmpi": ("--oversubscribe", "--bind-to", "none"), "mpich": ()}
# Runs a command with scalar kernels and the preloaded library $0, except on rank 0.
MIXED = 'if [ "${OMPI_COMM_WORLD_RANK:-$PMI_RANK}" != 0 ]; then export TROUPE_SIMD=scalar LD_PRELOAD="$0"; fi; exec "$@"'


def processes(base, numbers):
    """Several processes of the mpirun of each installed MPI: one variant for each number of processes in `numbers`, and three
    processes, two of which have another instruction set and the preloaded library of surroundings(). Prints a line for each MPI
    that is not installed, and returns None if no MPI is installed."""
    variants = []
    for mpi, options in LAUNCHERS.items():
        launcher, module = shutil.which(f"mpirun.{mpi}"), base.program.with_name(f"libtroupe_mpi_{mpi}.so")
        if launcher is None or not module.exists():
            print(f"NOT PROVED: processes of {mpi}, because mpirun.{mpi} or {module} is missing (scripts/setup --mpi installs "
                  "MPI, the target troupe_mpi builds the module)")
            continue
        for n in (*numbers, "mixed"):
            how = ("-n", 3, "sh", "-c", MIXED, hostile("surroundings")) if n == "mixed" else ("-n", n)
            about = ", two of them scalar, in hostile surroundings" if n == "mixed" else ""
            label = f"{3 if n == 'mixed' else n} processes of {mpi}{about}"
            variants.append(replace(base, label=label, emulator=(launcher, *options, *how), threads=1 if n == 3 else 2,
                                    environment={"OMPI_ALLOW_RUN_AS_ROOT": "1", "OMPI_ALLOW_RUN_AS_ROOT_CONFIRM": "1"}))
    return Proof("T0 processes", f"mpirun -n {','.join(map(str, numbers)) or 3}; other instruction sets",
                 tuple(variants)) if variants else None


def scheduler(base):
    """The program with a parallel loop that shuffles its tasks and sleeps in them (tests/hostile/parallel_shuffled.cpp)."""
    program = base.program.with_name("troupe_shuffled")
    variants = tuple(replace(base, label=f"shuffled tasks, {n} threads", program=program, threads=n, tile_m=tile)
                     for n, tile in ((1, 0), (2, 0), (3, 1.7), (8, 0)))
    return Proof("T0 hostile scheduler", "shuffled tasks, random sleeps, new threads", variants)


def allocator(base):
    variants = tuple(
        replace(base, label=f"{order} addresses, {n} threads", threads=n,
                environment={"LD_PRELOAD": str(hostile("allocator")), "TROUPE_ALLOCATOR": order})
        for order in ("descending", "shuffled") for n in (1, 2))
    return Proof("T0 hostile allocator", "descending, shuffled addresses; junk", variants)


LOCALE = "de_DE.UTF-8"  # has decimal commas


def locales(folder):
    """Makes the locale LOCALE in `folder`, unless it is there. Returns an environment in which it is used. If it cannot be made,
    prints that it is not proved, and returns an empty environment."""
    environment = {"LOCPATH": str(folder), "LC_ALL": LOCALE}
    if not (folder / LOCALE).exists():
        subprocess.run(["localedef", "-i", "de_DE", "-f", "UTF-8", folder / LOCALE], capture_output=True)
    use = "import locale; locale.setlocale(locale.LC_ALL, '')"  # localedef makes a useless one of incomplete sources
    made = subprocess.run([sys.executable, "-c", use], env={**os.environ, **environment}, capture_output=True)
    if made.returncode == 0:
        return {**environment, "TROUPE_LOCALE": LOCALE}
    print(f"NOT PROVED: a locale with decimal commas, because {LOCALE} cannot be made (scripts/setup --checks installs Debian's "
          "package locales)")
    return {}


def surroundings(base, locales):
    """A process with the floating-point mode of -ffast-math, and with another rounding mode, locale and working directory
    than usual (tests/hostile/surroundings.cpp). locales: the result of locales()."""
    environment = {"LD_PRELOAD": str(hostile("surroundings")), **locales}
    variants = tuple(replace(base, label=f"hostile surroundings, {n} threads", threads=n, environment=environment,
                             folder=pathlib.Path("/")) for n in (1, 2))
    return Proof("T0 hostile surroundings", "fast-math mode, rounding up, locale, folder", variants)


def plugin(base):
    """A plug-in that was linked with -ffast-math (tests/plugins). Only a type that no robot has uses this plug-in, so its only
    effect is that loading it makes the processor treat denormal numbers as 0."""
    idle = '{"size_m": [0.1, 0.1, 0.1], "drive": {"kind": "diff"}, "controller": {"kind": "walker"}}'
    options = ("--set", f"/types/plugged={idle}", "--plugin-path", ROOT / "build" / "release" / "plugins" / "fast")
    variants = tuple(replace(base, label=f"plug-in linked with -ffast-math, {n} threads", threads=n, options=options) for n in (1, 2))
    return Proof("T0 hostile plug-in", "linked with -ffast-math, loaded with the world", variants)


def observers(base, folder):
    """Runs that write all outputs, into `folder`; each variant replaces the files of the variant before."""
    options = ("--record", folder / "all.h5", "--record-every", 0.1, "--record-fields", "all", "--force",
               "--measures", folder / "all.csv", "--measure-every", 0.1, "--events", folder / "events.csv",
               "--profile", folder / "profile.json", "--snapshot", folder / "last.png",
               "--film", folder / "film-%06d.png", "--fps", 5, "--film-speed", 4, "--size", "320x180",
               "--camera", "perspective", "--color-by", "pose.heading", "--layers",
               "scans,beams,sights,blobs,grips,links,trails,names,energy,footprints,coverage,density,tiles,cells,speed")
    variants = tuple(replace(base, label=f"observed, {n} threads", threads=n, options=options) for n in (1, 2))
    return Proof("T0 observers", "recording, tables, profile, pictures, film", variants)


def restarts(base, ticks):
    half = ticks // 2
    variants = (replace(base, label="resumed in the middle, 2 threads after 1", restarts=(half,), threads=2),
                replace(base, label="resumed at tick 1", restarts=(1,), threads=3, tile_m=1.7),
                replace(base, label="resumed five times", threads=2,
                        restarts=tuple(ticks * i // 6 for i in range(1, 6))))
    return Proof("T0 checkpoint and resume", "in the middle, after a tick, five times", variants)


def repetitions(base, ticks, count):
    """The last 50 ticks, repeated `count` times from a checkpoint, to find races between threads. Runs on two threads find
    races that runs on eight threads do not find."""
    start = max(1, ticks - 50)
    variants = tuple(replace(base, label=f"stepped again, {i + 1}", threads=2, restarts=(start,)) for i in range(count))
    return Proof("T0 the same ticks again", f"{count} x {ticks - start} ticks from a checkpoint, 2 threads", variants)


def instruction_sets(base):
    """One run on each instruction set of this machine's processor: those of INSTRUCTION_SETS, and those that later versions of
    Highway add. A run that uses another instruction set than requested is a Fault."""
    flags = set()
    for line in pathlib.Path("/proc/cpuinfo").read_text().splitlines():
        if line.startswith("flags"):
            flags = set(line.split(":")[1].split())
    names = [name for name, flag in INSTRUCTION_SETS if flag is None or flag in flags]
    names += [name for name in available_simd(base.program) if name not in names]
    variants = tuple(replace(base, label=f"kernels of {name}", threads=2, environment={"TROUPE_SIMD": name}, simd=name)
                     for name in names)
    return Proof("T1 instruction sets", " ".join(names), variants)


def glibc(base):
    variants = tuple(replace(base, label=f"glibc.cpu.hwcaps={mask}",
                             environment={"GLIBC_TUNABLES": f"glibc.cpu.hwcaps={mask}"}) for mask in GLIBC_MASKS)
    return Proof("T1 glibc for other processors", "GLIBC_TUNABLES: old processors, no FMA", variants)


def another_build(label, program):
    variants = tuple(Variant(f"{label}, {n} threads", program, n, tile) for n, tile in ((1, 0), (2, 1.7)))
    return Proof(f"T2 {label}", "1 and 2 threads", variants)
