"""The program on 64-bit Arm: cross-built, and run under qemu's emulation of various processors."""

import re
import shutil
import subprocess
from dataclasses import dataclass, replace

from .runs import ROOT, Fault, Variant, program_of
from .variants import Proof

SYSROOT = ROOT / "build" / "aarch64-sysroot"
PACKAGES = SYSROOT / "packages.txt"  # written by scripts/sysroot
FOLDER = ROOT / "build" / "aarch64"
TOOLS = ("aarch64-linux-gnu-g++", "qemu-aarch64")


@dataclass(frozen=True)
class Processor:
    cpu: str  # the value of qemu's -cpu
    about: str
    kernels: str  # the instruction set to which kernels must be dispatched
    # Time of a tick of the first world under emulation on Zen 4, for the estimate.
    tick_s: float


# Ordered by usefulness: shorter checks use only the first processors. `max` is not a real processor: it has all features that
# qemu can emulate.
PROCESSORS = (
    Processor("cortex-a57", "no SVE", "neon", 0.3),
    Processor("a64fx", "SVE of 512 bits", "sve", 0.5),
    Processor("max,sve-default-vector-length=16", "SVE2 of 128 bits", "sve2_128", 0.5),
    Processor("max,sve-default-vector-length=32", "SVE2 of 256 bits", "sve_256", 0.4),
    Processor("max,sve-default-vector-length=256", "SVE2 of 2048 bits", "sve2", 1.4),
)


def check_tools():
    missing = [tool for tool in TOOLS if not shutil.which(tool)]
    if not PACKAGES.exists():
        missing.append(str(SYSROOT.relative_to(ROOT)))
    if missing:
        raise Fault(f"missing: {', '.join(missing)}; scripts/setup --aarch64 installs them")


def versions():
    """Returns one text for each tool and Arm library on which the result may depend, with its version."""
    packages = dict(line.split()[:2] for line in PACKAGES.read_text().splitlines()[1:])
    first_lines = [subprocess.run([tool, "--version"], capture_output=True, text=True).stdout.splitlines()[0] for tool in TOOLS]
    return [*first_lines, *(f"{name} {packages[name]}" for name in ("libc6", "libstdc++6", "libhwy1", "libtbb12"))]


@dataclass(frozen=True)
class Moved(Variant):
    """A run that begins on this machine's processor, with the release build. It is saved in a checkpoint, and the Arm program
    resumes it under the emulator."""

    def _call(self, arguments):
        begins = arguments[0] == "run"
        Variant._call(replace(self, program=program_of("release"), emulator=()) if begins else self, arguments)


def emulated(processor, threads, kind=Variant):
    """Returns a variant that runs the Arm program under the emulator of a processor. The program itself selects the
    instruction set for range finding, which must be the best one of the processor (Processor.kernels). kind: Variant or Moved."""
    return kind(f"{threads} thread{'s' if threads > 1 else ''}", FOLDER / "bin" / "troupe", threads,
                emulator=("qemu-aarch64", "-L", SYSROOT, "-cpu", processor.cpu), simd=processor.kernels)


def proof_of(processor):
    variants = tuple(emulated(processor, threads) for threads in (1, 2))
    return Proof(f"T2 aarch64, {processor.cpu.partition(',')[0]} ({processor.kernels})",
                 f"{processor.about}; 1 and 2 threads", variants)


def move_of(processor, ticks):
    # simd is not checked, because the first part of the run, on this machine, wrote the header of the hash log.
    variant = replace(emulated(processor, 2, Moved), restarts=(ticks // 2,), simd="")
    return Proof(f"T2 resumed on aarch64, {processor.cpu.partition(',')[0]}", "saved by x86-64 in the middle; 2 threads",
                 (variant,))


# Fused multiply-add instructions: scalar, NEON, SVE, and those for complex numbers and matrices.
FUSED = re.compile(r"\t(fn?m(add|sub|ad|sb|la|ls)|fml[as]l[2bt]?|fcmla|fmmla)\t")


def fused_instructions(text):
    """Returns the lines of `text`, the output of objdump, that contain a fused multiply-add."""
    return [line for line in text.splitlines() if FUSED.search(line)]


def disassembled():
    libraries = sorted(FOLDER.glob("*/libtroupe_*.a"))
    done = subprocess.run(["aarch64-linux-gnu-objdump", "--disassemble", "--no-show-raw-insn", *map(str, libraries)],
                          capture_output=True, text=True)
    if done.returncode != 0 or not libraries:
        raise Fault(f"{FOLDER}: cannot disassemble the libraries: {done.stderr.strip() or 'there are none'}")
    return done.stdout
