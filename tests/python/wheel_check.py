"""Tests a wheel as a user of pip gets it. Run by `scripts/wheel --check`, in an empty virtual environment, with the
environment variable TROUPE_WHEEL set to the wheel. Downloads NumPy, h5py, Gymnasium and PettingZoo from PyPI; needs cmake and a C++ compiler."""

import importlib.metadata
import importlib.util
import json
import os
import pathlib
import shutil
import subprocess
import sys
import time
import unittest

from support import ROOT, InAFolder

WHEEL = pathlib.Path(os.environ["TROUPE_WHEEL"])
PROGRAM = pathlib.Path(sys.prefix) / "bin" / "troupe"
# As on a machine without packages of Troupe: only the virtual environment and the base system.
ENVIRONMENT = {
    **{name: value for name, value in os.environ.items() if name.startswith(("PIP_", "SSL_")) or name.endswith("_proxy")},
    "PATH": f"{PROGRAM.parent}:/usr/bin:/bin",
    "HOME": os.environ.get("HOME", "/"),
}
# The libraries of the system that the policy manylinux_2_34 allows, as far as they are used.
ALLOWED = ("ld-linux-x86-64.so.2", "libc.so.6", "libm.so.6", "libdl.so.2", "libpthread.so.0", "librt.so.1", "libgcc_s.so.1",
           "libstdc++.so.6", "libz.so.1")
SECONDS_TO_FIRST_PICTURE = 60


def run(*command, **options):
    done = subprocess.run([str(word) for word in command], env=ENVIRONMENT, stdout=subprocess.PIPE,
                          stderr=subprocess.STDOUT, text=True, **options)
    if done.returncode != 0:
        raise AssertionError(f"{' '.join(map(str, command))} ended with {done.returncode}:\n{done.stdout}")
    return done.stdout


def python(code):
    return run(sys.executable, "-c", code)


def pip_install(*packages):
    run(sys.executable, "-m", "pip", "install", "--quiet", "--disable-pip-version-check", *packages)


class Clock:
    """The wall time, and the processor time of all commands so far."""

    def __init__(self):
        self.wall = time.monotonic()
        times = os.times()
        self.processor = times.children_user + times.children_system

    def since(self, earlier):
        return f"{self.wall - earlier.wall:.1f} s ({self.processor - earlier.processor:.1f} s of processor time)"


def worlds():
    return pathlib.Path(python("import troupe; print(troupe.worlds_dir())").strip())


def setUpModule():
    if importlib.util.find_spec("troupe"):
        raise AssertionError("the virtual environment already contains troupe, so it is not fresh")
    begin = Clock()
    pip_install(WHEEL)
    installed = Clock()
    picture = pathlib.Path(sys.prefix) / "first.svg"
    run(PROGRAM, "run", worlds() / "hospital.json", "--for", 1, "--snapshot", picture)
    drawn = Clock()
    print(f"pip install: {installed.since(begin)}; first picture, of hospital.json after 1 s: {drawn.since(installed)}",
          flush=True)
    if drawn.processor - begin.processor > SECONDS_TO_FIRST_PICTURE:  # wall time also depends on other programs
        raise AssertionError(f"it took more than {SECONDS_TO_FIRST_PICTURE} s to the first picture")
    if "<svg" not in picture.read_text() or picture.stat().st_size < 20_000:
        raise AssertionError(f"{picture} is no picture of a hospital")


class TheWheel(InAFolder):
    def test_contents(self):
        files = [str(file) for file in importlib.metadata.files("troupe-sim")]
        for file in ("troupe/py.typed", "troupe/_core.pyi", "troupe/envs/__init__.py", "troupe/include/troupe/troupe/plugin.hpp",
                     "troupe/lib/cmake/troupe/troupe-config.cmake", "troupe/share/troupe/worlds/hospital.json"):
            self.assertIn(file, files)
        licenses = [file.rsplit("/", 1)[1] for file in files if ".dist-info/licenses/third-party/" in file]
        # A licence for each library beside the module, whose names auditwheel has made: libfmt-0a1b2c3d.so.9.1.0.
        for library in (file.split("/")[1] for file in files if file.startswith("troupe_sim.libs/lib")):
            name = library.split("-")[0]
            self.assertTrue([text for text in licenses if text.startswith(name.rstrip("16"))], f"{library}: {licenses}")
        for name in ("hdf5.txt", "libeigen3-dev.txt", "pybind11.txt"):
            self.assertIn(name, licenses)

    def test_the_command_is_the_program(self):
        version = importlib.metadata.version("troupe-sim")
        self.assertTrue(run(PROGRAM, "--version").startswith(f"troupe {version} ("))
        self.assertEqual(run(sys.executable, "-m", "troupe", "--version"), run(PROGRAM, "--version"))

    def test_loads_no_other_libraries_of_the_system(self):
        loaded = json.loads(python(f"""
import bz2, hashlib, json, lzma, numpy, pathlib, ssl, sys  # modules of Python that load libraries of the system
def loaded(): return {{line.split()[-1] for line in open("/proc/self/maps") if ".so" in line}}
before = loaded()
import troupe
world = troupe.Simulation(troupe.worlds_dir() / "hospital.json", robots=20)
world.record("run.h5"); world.step(5); world.stop_recording(); world.snapshot("picture.svg")
print(json.dumps(sorted(loaded() - before)))"""))
        foreign = [file for file in loaded if not file.startswith((sys.prefix, sys.base_prefix))]
        foreign = [file for file in foreign if pathlib.Path(file).name not in ALLOWED
                   and not file.startswith("/usr/lib/x86_64-linux-gnu/libstdc++.so.6")]
        self.assertEqual(foreign, [])

    def test_golden_hashes(self):
        lines = [line.split() for line in (ROOT / "worlds" / "golden_hashes.txt").read_text().splitlines()]
        golden = [(world, state) for world, robots, tick, state in (line for line in lines if line[0] != "#")
                  if (robots, tick) == ("-", "50") and ":" not in world]
        self.assertGreater(len(golden), 10)
        for world, state in golden:
            with self.subTest(world):
                code = f"import troupe; w = troupe.Simulation(troupe.worlds_dir() / {world!r}); w.step(50); print(f'{{w.state_hash():016x}}')"
                self.assertEqual(python(code).strip(), state)


class BesideH5py(InAFolder):
    def test_in_either_order(self):
        pip_install("h5py")
        for first, second in (("troupe", "h5py"), ("h5py", "troupe")):
            with self.subTest(first=first):
                code = f"""
import {first}, {second}, numpy
world = troupe.Simulation(troupe.worlds_dir() / "hospital.json", robots=20)
world.record("{first}.h5"); world.step(30); world.stop_recording()
with h5py.File("{first}.h5") as ours, h5py.File("{first}_copy.h5", "w", userblock_size=ours.userblock_size) as copy:
    for name, value in ours.attrs.items(): copy.attrs[name] = value
    for name in ours: ours.copy(name, copy)
    numbers = []
    ours.visititems(lambda name, item: numbers.append(item[()].size) if isinstance(item, h5py.Dataset) else None)
    print(sum(numbers))
world.step(1)
print(h5py.version.hdf5_version)"""
                values, version = python(code).split()
                self.assertGreater(int(values), 20 * 3)
                described = run(PROGRAM, "info", f"{first}.h5")
                self.assertIn("20", described)
                copied = run(PROGRAM, "info", f"{first}_copy.h5")
                self.assertEqual(copied.replace("_copy", "").splitlines()[1:3], described.splitlines()[1:3], version)


class WithGymnasium(InAFolder):
    def test_an_environment_passes_its_checker(self):
        pip_install("gymnasium==1.4.0", "pettingzoo==1.27.0")  # the versions of packages.py
        said = python("""
import ctypes, warnings
import gymnasium, numpy, troupe.envs
from gymnasium.utils.env_checker import check_env
warnings.filterwarnings("ignore", message=".*Box.*(infinity|low|high).*")
env = gymnasium.make("troupe/Navigation-v0", robots=3)
check_env(env.unwrapped)
envs = gymnasium.make_vec("troupe/Navigation-v0", num_envs=4, vectorization_mode="vector_entry_point", robots=3)
first, _ = envs.reset(seed=1)
again, _ = envs.reset(seed=1)
assert first.shape == (4, 18) and numpy.array_equal(first, again)
try:  # pictures need OSMesa or EGL of the system, which are not in the wheel
    drawn = gymnasium.make("troupe/Navigation-v0", render_mode="rgb_array", render_size=(64, 48))
    drawn.reset(seed=1)
    print(drawn.render().shape)
except RuntimeError as error:
    print(error)
""")
        last = said.splitlines()[-1]
        self.assertTrue(last == "(48, 64, 3)" or "apt install libosmesa6" in last, said)


@unittest.skipUnless(shutil.which("cmake") and shutil.which("c++"), "plug-ins need cmake and a C++ compiler")
class PlugIns(InAFolder):
    def build(self, name, source):
        folder = self.folder / name
        if source.is_dir():
            shutil.copytree(source, folder)
        else:
            folder.mkdir()
            shutil.copy(source, folder)
            (folder / "CMakeLists.txt").write_text(
                f"cmake_minimum_required(VERSION 3.25)\nproject({name} LANGUAGES CXX)\nfind_package(troupe REQUIRED)\n"
                f"troupe_add_plugin({name} {source.name})\n")
        cmake_dir = python("import troupe; print(troupe.cmake_dir())").strip()
        run("cmake", "-S", folder, "-B", folder / "build", f"-Dtroupe_DIR={cmake_dir}", "-DCMAKE_BUILD_TYPE=Release",
            "-DCMAKE_EXPORT_COMPILE_COMMANDS=ON")
        run("cmake", "--build", folder / "build")
        return folder

    def test_examples(self):
        for name, source in (("follow_wall", "plugin"), ("beam_ranger", "sensor_plugin")):
            with self.subTest(name):
                folder = self.build(name, ROOT / "apps" / "examples" / source)
                commands = (folder / "build" / "compile_commands.json").read_text()
                self.assertIn("include/eigen3", commands)
                self.assertNotIn("/usr/include", commands)
                needed = run("ldd", folder / "build" / f"{name}.so")
                self.assertNotRegex(needed, r"/usr/\S*lib(fmt|hwy|tbb)")
                summary = run(PROGRAM, "run", folder / "room.json", "--for", 10, "--plugin-path", folder / "build",
                              "--quiet", "--json", cwd=folder)
                again = run(PROGRAM, "run", folder / "room.json", "--for", 10, "--plugin-path", folder / "build",
                            "--quiet", "--json", "--threads", 1, cwd=folder)
                self.assertEqual(json.loads(summary)["state_hash"], json.loads(again)["state_hash"])

    def test_controllers_that_command_devices(self):
        self.build("talker", ROOT / "tests" / "plugins" / "talker.cpp")  # includes headers of models and sensors

    def test_exceptions_reach_the_program(self):
        folder = self.build("thrower", ROOT / "tests" / "plugins" / "thrower.cpp")
        world = {"troupe": 1, "tick_s": 0.1, "types": {"bot": {"size_m": [0.2, 0.2, 0.2], "drive": {"kind": "diff"},
                                                              "controller": {"kind": "thrower:says"}}},
                 "populations": [{"name": "r", "type": "bot", "count": 9,
                                  "place": {"rule": "uniform", "region_m": [[-4, -4], [4, 4]]}}]}
        code = f"""
import json, troupe
world = troupe.Simulation(json.loads({json.dumps(world)!r}), plugin_path=[{str(folder / "build")!r}])
try: world.step(10)
except troupe.StepError as error: print(error)"""
        self.assertIn("tick 3: controller \"thrower:says\" of \"r4\" threw: the map is missing", python(code))


if __name__ == "__main__":
    unittest.main(verbosity=2)
