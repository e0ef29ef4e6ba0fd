"""Builds of the program with other compilers and optimisation levels, and with a fault planted in a copy of the sources."""

import os
import pathlib
import re
import shutil
import subprocess
import sys

from .runs import ROOT, Fault, available_simd

COMPILERS = ("g++", "clang++")
LEVELS = ("-O0", "-O1", "-O2", "-O3")
PLANTED = ROOT / "tests" / "planted"


def _run(command, **options):
    done = subprocess.run([str(word) for word in command], stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True,
                          **options)
    if done.returncode != 0:
        raise Fault(f"{' '.join(map(str, command))} failed:\n{done.stdout[-4000:]}")


def _build(sources, folder, options, targets):
    print(f"building {folder.relative_to(ROOT)} ...", flush=True)
    launcher = ["-DCMAKE_CXX_COMPILER_LAUNCHER=ccache"] if shutil.which("ccache") else []
    _run(["cmake", "-S", sources, "-B", folder, "-G", "Ninja", *launcher, *options])
    # Otherwise ccache skips sources with a precompiled header.
    _run(["cmake", "--build", folder, "--target", *targets], env={**os.environ, "CCACHE_SLOPPINESS": "pch_defines,time_macros"})
    return folder / "bin" / "troupe"


def compiled(compiler, level):
    """Builds the program with this compiler and optimisation level (such as -O2) in a folder under build/prove. Returns the
    path of the program. Raises Fault if the build fails."""
    folder = ROOT / "build" / "prove" / f"{compiler}{level}"
    options = [f"-DCMAKE_CXX_COMPILER={compiler}", "-DCMAKE_BUILD_TYPE=None", f"-DCMAKE_CXX_FLAGS={level}",
               "-DTROUPE_TESTS=OFF", "-DTROUPE_PERF=OFF", "-DTROUPE_PYTHON=OFF", "-DCMAKE_UNITY_BUILD=ON"]
    return _build(ROOT, folder, options, ["bin/troupe"])


def planted_faults(names=()):
    """Returns (name, description) of the patches in tests/planted with the given names, or of all patches if `names` is empty.
    The description is the text before the diff. Raises Fault for a name that no patch has."""
    faults = {file.stem: file.read_text().split("\ndiff ")[0].strip() for file in sorted(PLANTED.glob("*.patch"))}
    if unknown := [name for name in names if name not in faults]:
        raise Fault(f"--planted: there is no planted fault {', '.join(unknown)}; known: {', '.join(faults)}")
    return [(name, faults[name]) for name in names or faults]


def with_planted(name):
    """Builds the program, its variant with the hostile scheduler (variants.py) and the MPI modules, from sources with the
    planted fault of this name. Returns the path of the program. All faults share one build folder, so each call replaces the
    programs of the previous call, and compiles only the sources that the previous or the new fault changes. Raises Fault if
    the patch does not apply or the build fails."""
    sources = ROOT / "build" / "planted" / "sources"
    files = subprocess.run(["git", "ls-files", "-z", "--cached", "--others", "--exclude-standard"], cwd=ROOT, check=True, capture_output=True, text=True).stdout
    for file in filter(None, files.split("\0")):
        copy_if_changed(ROOT / file, sources / file)  # also undoes the patch of an earlier run
    patch = PLANTED / f"{name}.patch"
    _run(["patch", "--strip=1", "--quiet", "--fuzz=0", "--no-backup-if-mismatch", "--input", patch], cwd=sources)
    return _build(sources, sources / "build" / "release", ["-DCMAKE_BUILD_TYPE=Release", "-DTROUPE_PERF=OFF"],
                  ["bin/troupe", "bin/troupe_shuffled", "troupe_mpi"])


def warns_of_an_instruction_set(program):
    """Whether the program finds that one of its instruction sets computes wrong ranges, and warns that it uses another one."""
    for name in available_simd(program):
        done = subprocess.run([program, "run", ROOT / "worlds" / "hospital.json", "--robots", "10", "--for", "1", "--simd", name],
                              check=True, capture_output=True, text=True)
        if f"the instruction set {name} computes wrong ranges" in done.stdout + done.stderr:
            return True
    return False


def accepts_a_world_of_one(program):
    """Whether the program, which has a planted fault, accepts a wrong MPI module. With the module of another MPI than that of
    the launcher, each of three processes behaves as the only one. Runs the tests in tests/mpi_test.py that expect an error in
    this case, and returns whether they fail."""
    name = "test_a_world_of_one_under_a_launcher_of_three_is_an_error"
    test = [ROOT / "tests" / "mpi_test.py", program, f"OpenMpi.{name}", f"Mpich.{name}"]
    done = subprocess.run([sys.executable, *map(str, test)], capture_output=True, text=True)
    return done.returncode == 1


def patched_files(patch):
    return re.findall(r"^\+\+\+ b/(.+)$", patch.read_text(), re.M)


def copy_if_changed(source, target):
    if not source.exists():
        return
    if target.exists() and target.read_bytes() == source.read_bytes():
        return
    target.parent.mkdir(parents=True, exist_ok=True)
    shutil.copy(source, target)


def calls_libm(program):
    """Whether tests/symbols_test.py finds functions of libm in the libraries from which the program was linked. The library
    `render` is left out, because it does not compute the state."""
    folder = pathlib.Path(program).parent.parent
    libraries = [library for library in sorted(folder.glob("*/libtroupe_*.a")) if library.parent.name != "render"]
    test = [ROOT / "tests" / "symbols_test.py", *libraries]
    done = subprocess.run([sys.executable, *map(str, test)], capture_output=True, text=True)
    return done.returncode != 0
