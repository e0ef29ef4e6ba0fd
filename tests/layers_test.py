#!/usr/bin/env python3
"""Checks the rules of docs/architecture.md that a compiler does not check: which folder may include which files.

A folder includes only folders below it, devices access the world only through engine/sensing/sensing_view.hpp, each third-party
library is included by few files, and code below `apps` does not print, read the clock, parse arguments or exit.

    layers_test.py [ROOT]    checks the sources under ROOT (default: this repository), then itself on planted faults
"""

import functools
import re
import sys
import tempfile
import unittest
from pathlib import Path

ROOT = Path(__file__).resolve().parent.parent

# The folders that each folder may include, in addition to itself. `sensors`, `worldio` and `render` do not include one
# another: the engine and the registry connect them. `models` is above `sensors`, because its controllers read sensors.
BELOW = {
    "base": [],
    "partition": ["base"],
    "engine": ["base", "partition"],
    "sensors": ["base", "partition", "engine"],
    "models": ["base", "partition", "engine", "sensors"],
    "worldio": ["base", "partition", "engine"],
    "render": ["base", "partition", "engine"],
    "troupe": ["base", "partition", "engine", "sensors", "models", "worldio", "render"],
}
LIBRARY = list(BELOW)

# Subfolders, and which other subfolders of the same folder each may include. Files of the folder itself may include all
# subfolders, and all subfolders may include them.
ENGINE_ROOMS = ["fields", "kinds", "spec", "sensing", "state", "conflicts", "links", "rows", "interventions", "world",
                "observing", "ranks"]  # each may include those before it
ROOMS = {
    "engine": {room: ENGINE_ROOMS[:i] for i, room in enumerate(ENGINE_ROOMS)},
    "models": {
        "drives": [],
        "devices": ["drives"],
        "controllers": ["drives", "devices"],
        "measures": [],
        "faults": [],
    },
    "worldio": {
        "images": [],
        "json": ["images"],
        "stage": ["images", "json"],
        "results": ["json"],
    },
}
# Files that must not include some headers, neither directly nor through other headers: (files, headers, reason). Devices and
# measures must not depend on the code that moves bodies: they see the world through views.
MECHANICS = ["engine/world/world.hpp", "engine/state/world_state.hpp", "engine/conflicts/movement.hpp",
             "engine/conflicts/conflicts.hpp", "engine/links/links.hpp", "engine/interventions/experiment.hpp"]
APART = [
    (["engine/sensing/sensing_view.hpp", "engine/sensing/sight.hpp", "engine/sensing/visibility_query.hpp",
      "engine/kinds/make_device_kind.hpp"], MECHANICS),
    (["sensors/*", "models/*/*"], MECHANICS),
]
ANYTHING = LIBRARY + ["live", "apps", "python", "tests", "perf"]
# The Python package contains the whole program, because `python3 -m troupe` runs it in the interpreter.
BELOW |= {"live": LIBRARY, "apps": [*LIBRARY, "live"], "python": [*LIBRARY, "live", "apps"], "tests": ANYTHING, "perf": ANYTHING}

# Third-party headers: (pattern, name, glob patterns of the files that may include them).
# Headers of the library are installed, so of all third-party libraries they may include only Eigen.
LIBRARY_SOURCES = [f"{folder}/{files}" for folder in LIBRARY for files in ("*.cpp", "*/*.cpp")]
TOP = ["live/*", "apps/*", "apps/*/*", "python/*", "tests/*", "tests/*/*", "perf/*", "perf/*/*"]
THIRD_PARTY = [
    (r"Eigen/", "Eigen", ["*/*", "*/*/*"]),
    (r"fmt/", "fmt", LIBRARY_SOURCES + TOP),
    (r"hwy/", "Highway", LIBRARY_SOURCES + TOP),
    (r"xxh", "xxHash", ["base/*.cpp"]),
    (r"tbb/|oneapi/", "oneTBB", ["partition/*.cpp"]),
    (r"nlohmann/", "nlohmann-json", ["worldio/json/*.cpp", "worldio/results/*.cpp", *TOP]),
    (r"stb[_/]", "stb", ["worldio/images/*.cpp"]),
    (r"png\.h|zlib\.h|jpeglib\.h|turbojpeg\.h", "libpng, zlib and libjpeg",
     ["worldio/images/*.cpp", "worldio/results/*.cpp", "tests/*/*"]),
    (r"yaml-cpp/", "yaml-cpp", ["worldio/images/*.cpp"]),
    (r"hdf5|H5|highfive/", "HDF5", ["worldio/results/*.cpp", "tests/*/*.cpp"]),
    (r"GL/|EGL/|KHR/", "OpenGL", ["render/*.cpp"]),
    (r"pybind11/|Python\.h|numpy/", "Python", ["python/*"]),
    (r"boost/", "Boost.Beast", ["live/server.cpp"]),
    (r"CLI/", "CLI11", ["apps/*.cpp", "apps/*/*.cpp", "perf/paper.cpp"]),
    (r"gtest/|gmock/|rapidcheck", "the test libraries", ["tests/*", "tests/*/*"]),
    (r"benchmark/", "Google Benchmark", ["perf/*", "perf/*/*"]),
    (r"sanitizer/", "the sanitizers", ["render/offscreen_context.cpp", "tests/worldio/hdf5_torn_test.cpp"]),
    # Headers of the platform: the floating-point environment, dynamic loading, processors, memory and files.
    (r"(dlfcn|fcntl|link|malloc|sched|unistd|cpuid|[a-z]mmintrin|sys/[a-z]+)\.h", "the platform", LIBRARY_SOURCES + TOP),
    (r"pthread\.h", "the C library for threads", ["partition/*.cpp", *TOP]),
    (r"[a-z]+(/[a-z]+)?\.h$", "this C header", TOP),
]

# Standard headers that only some folders may include.
STANDARD = [
    (r"iostream|print", "prints", TOP),
    (r"chrono|ctime", "reads the clock", TOP),
    (r"random", "draws random numbers that differ between implementations; base/random.hpp has ours", TOP),
    (r"thread|future|execution|barrier|latch|semaphore|stop_token", "is parallel; partition has the one loop",
     ["partition/*.cpp", "apps/examples/seeds/seeds.cpp", *TOP]),
]

# Words that no file below `apps` may contain, except in comments and string literals.
WORDS = [
    (r"(v|f|vf|d|w)?printf|puts|fputs|putchar|perror|cout|cerr|clog|fmt::print", "prints"),
    (r"exit|_exit|_Exit|quick_exit|abort|terminate", "ends the process"),
    (r"chrono|clock_gettime|gettimeofday|std::time|std::clock", "reads the clock"),
    (r"getenv|secure_getenv|setenv|environ", "reads the environment"),
    (r"argc|argv", "parses arguments"),
    (r"std::rand|srand|random_device|std::mt19937\w*", "draws random numbers that no seed decides"),
    (r"(Neg)?Mul(Add|Sub)\w*|Approximate\w*", "does not round the same on every processor"),
    (r"hwy::HWY_NAMESPACE", "goes around partition/simd.inl, which lists the operations that kernels may use"),
]
# Parameters are read by name (from_record(), get()), because the index of a field in a record may change.
_VALUE = r"(?:given|boolean|integer|number|text|numbers|records|texts)\(\)"
_PLACE = r"(?:\d+|k_\w+|[^\]\[]*\bsize\(\)[^\]\[]*)"
BY_POSITION = re.compile(rf"\[\s*{_PLACE}\s*\]\s*(?:\.|->)\s*{_VALUE}|\b(?:\w+_)?(?:params|record)\s*\[\s*{_PLACE}\s*\]")

# Limits that several readers of world files check are given once. (pattern of a number, name of the limit)
LIMITS = [(r"(?:(?:100|200)e3|1e5|[12]00'?000)(?:\.0+)?", "base/limits.hpp, k_world_reach_m")]
# Lines in which such a number is another limit.
LIMITS_ALLOWED = r"k_most_|counts_readings|constexpr double k_reach = 100000;"
NAMED_LIMIT = re.compile(r"\bconstexpr\s+[\w:]+\s+(k_(?:most|least|largest|longest|deepest|max|min)\w*)\s*=\s*([^;]+);")

WORDS_ALLOWED = {
    "base/assert.hpp",  # TROUPE_ASSERT prints the violated invariant and ends the process
    # Launchers show themselves only in the environment. A simulation only decides with it whether several ranks are an error.
    "troupe/launcher.cpp",
    # Mesa reads the number of its threads only from the environment.
    "render/offscreen_context.cpp",
}

INCLUDE = re.compile(r'^[ \t]*#[ \t]*include[ \t]*([<"])([^>"]+)[>"]', re.M)
COMMENT_OR_TEXT = re.compile(
    r"""R"([^(\s]*)\(.*?\)\1"|"(?:\\.|[^"\\\n])*"|'(?:\\[^\n']+|[^\\\n'])'|//[^\n]*|/\*.*?\*/""", re.S)


def sources(root):
    for folder in BELOW:
        for path in sorted((root / folder).rglob("*")):
            if path.suffix in (".hpp", ".cpp") and path.is_file():
                yield folder, path.relative_to(root)


def is_in(path, globs):
    """Whether a path matches one of the globs. A glob matches the whole path; `*` matches no slash."""
    return any(len(path.parts) == glob.count("/") + 1 and path.match(glob) for glob in globs)


def without_comments(text, texts_too):
    """Replaces comments, and with texts_too also string literals, by blanks. Line numbers stay the same."""
    def blank(match):
        if not texts_too and not match.group().startswith("/"):
            return match.group()
        return re.sub(r"[^\n]", " ", match.group())
    return COMMENT_OR_TEXT.sub(blank, text)


def room_fault(folder, path, name):
    """Returns the fault of an include of a file in the same folder, or None."""
    if len(path.parts) == 2:
        return None
    rooms = ROOMS.get(folder, {})
    own = "/".join(path.parts[1:-1])
    if own not in rooms:
        return f"{folder}/{own} is unknown: say in tests/layers_test.py what it may include"
    other = "/".join(name.split("/")[1:-1])
    if other and other != own and other not in rooms[own]:
        return f'"{name}": {folder}/{own} must not know {folder}/{other}'
    return None


def include_fault(root, folder, path, quote, name):
    """Returns the fault of an include, or None."""
    first = name.split("/")[0]
    is_ours = first in BELOW and ((root / name).is_file() or (root / f"{name}.in").is_file())  # .in: CMake makes the file
    if quote == '"' or is_ours:
        if not is_ours:
            return f'"{name}" is no file of ours, named from the root'
        if quote == "<" and folder in LIBRARY:
            return f"<{name}> is ours: use quotes"
        faces = [("<", "troupe/troupe.hpp"), ("<", "troupe/plugin.hpp")]
        if path.parts[:2] == ("apps", "examples") and (quote, name) not in faces:
            return f'an example shows the public face: <troupe/troupe.hpp> or <troupe/plugin.hpp>, not "{name}"'
        if first != folder and first not in BELOW[folder]:
            return f'"{name}": {folder} must not know {first}'
        return room_fault(folder, path, name) if first == folder and folder in LIBRARY else None
    for pattern, library, allowed in THIRD_PARTY:
        if re.match(rf"(?:{pattern})", name):
            return None if is_in(path, allowed) else f"<{name}>: {library} is not for this file"
    if not re.fullmatch(r"[a-z0-9_]+", name):
        return f"<{name}> is unknown: say in tests/layers_test.py which files may include it"
    for pattern, what, allowed in STANDARD:
        if re.fullmatch(pattern, name) and not is_in(path, allowed):
            return f"<{name}> {what}"
    return None


def closure_faults(root, paths):
    """Returns violations of APART, as `path:line: text`. The line is the include through which the forbidden header comes."""
    @functools.cache
    def includes(path):
        text = without_comments((root / path).read_text(), texts_too=False)
        return [(text.count("\n", 0, match.start(1)) + 1, match[2]) for match in INCLUDE.finditer(text)
                if (root / match[2]).is_file()]

    def way_to(path, forbidden, seen):
        """Returns a chain of includes from path to a forbidden header, or None. Stops at headers that are checked themselves."""
        if path in forbidden:
            return [path]
        if path in seen or any(is_in(Path(path), files) for files, _ in APART):
            return None
        seen.add(path)
        for _, name in includes(path):
            way = way_to(name, forbidden, seen)
            if way:
                return [path, *way]
        return None

    for files, forbidden in APART:
        for path in paths:
            if not is_in(path, files):
                continue
            for line, name in includes(path.as_posix()):
                way = way_to(name, forbidden, set())
                if way:
                    yield f"{path.as_posix()}:{line}: \"{' -> '.join(way)}\": devices read engine/sensing/sensing_view.hpp"
                    break


def repeated_limits(root):
    """Returns limits that are given twice, as `path:line: text`: numbers of LIMITS outside of base/limits.hpp, and constants of
    the readers of worlds that have the same name and value in two files."""
    seen = {}
    for folder, path in sources(root):
        if folder not in LIBRARY or path.as_posix() == "base/limits.hpp":
            continue
        code = without_comments((root / path).read_text(), texts_too=True)
        for number, line in enumerate(code.split("\n"), 1):
            for pattern, limit in LIMITS:
                match = re.search(rf"(?<![\w.']){pattern}(?![\w.'])", line)
                if match and not re.search(LIMITS_ALLOWED, line):
                    yield f"{path.as_posix()}:{number}: {match[0]} repeats a limit: use {limit}"
        if folder != "worldio":
            continue
        for match in NAMED_LIMIT.finditer(code):
            other = seen.setdefault((match[1], match[2]), path)
            if other != path:
                yield (f"{path.as_posix()}:{code.count(chr(10), 0, match.start()) + 1}: {match[1]} repeats the limit of "
                       f"{other.as_posix()}")


def findings(root):
    """Returns all violations of the rules under root, as `path:line: text`."""
    found = list(closure_faults(root, [path for _, path in sources(root)])) + list(repeated_limits(root))
    tbb_users = []
    for folder, path in sources(root):
        text = (root / path).read_text()

        def report(start, what, text=text, path=path):
            found.append(f"{path.as_posix()}:{text.count(chr(10), 0, start) + 1}: {what}")

        for match in INCLUDE.finditer(without_comments(text, texts_too=False)):
            fault = include_fault(root, folder, path, *match.groups())
            if fault:
                report(match.start(1), fault)
            elif re.match("tbb/|oneapi/", match[2]) and path not in tbb_users:
                tbb_users.append(path)
                if len(tbb_users) == 2:
                    report(match.start(1), f"<{match[2]}>: {tbb_users[0].as_posix()} is the one file that knows oneTBB")
        code = without_comments(text, texts_too=True)
        for match in BY_POSITION.finditer(code):
            report(match.start(), f"`{match[0]}` reads a parameter by its position: describe the parameters "
                                  "(engine/fields/description.hpp), or use engine::get()")
        if folder in LIBRARY and path.as_posix() not in WORDS_ALLOWED:
            code = INCLUDE.sub(lambda match: " " * len(match.group()), code)
            for pattern, what in WORDS:
                for match in re.finditer(rf"(?<![\w.>])(?:std::)?({pattern})\b", code):
                    report(match.start(1), f"`{match[1]}` {what}: below apps nothing does")
    return found


class TheSources(unittest.TestCase):
    def test_there_are_some(self):
        self.assertGreater(len(list(sources(ROOT))), 20, ROOT)

    def test_they_keep_the_rules(self):
        found = findings(ROOT)
        if found:
            self.fail(f"{len(found)} breach(es) of the layers:\n" + "\n".join(found))


def phases(text):
    """The names of the enumerators of `enum class Phase` in the text of engine/state/phase.hpp."""
    return re.findall(r"^ +(\w+),", re.search(r"enum class Phase .*?\{(.*?)\}", text, re.S)[1], re.M)


def drawn(text, style):
    """The names in the boxes of a style (class) in the text of docs/images/architecture.svg, from top to bottom."""
    return re.findall(rf'<rect class="{style}".*?<text class="n"[^>]*>([^<]*)<', text, re.S)


class ThePicture(unittest.TestCase):
    """docs/images/architecture.svg shows the phases of a tick and the layers, as the code has them."""

    PICTURE = ROOT / "docs" / "images" / "architecture.svg"

    def test_it_shows_the_phases(self):
        expected = phases((ROOT / "engine" / "state" / "phase.hpp").read_text())
        self.assertEqual(len(expected), 6)
        self.assertEqual(drawn(self.PICTURE.read_text(), "p"), expected)

    def test_the_page_lists_the_phases(self):
        page = (ROOT / "docs" / "architecture.md").read_text()
        tick = page[page.index("## The tick"):]
        listed = re.findall(r"^    ([a-z]+) {2,}\S", tick[:tick.index("S(k) is the state")], re.M)
        self.assertEqual(listed, [*phases((ROOT / "engine" / "state" / "phase.hpp").read_text()), "observe"])

    def test_it_shows_the_folders(self):
        boxes = {name for style in "abt" for name in drawn(self.PICTURE.read_text(), style)}
        self.assertEqual(boxes, set(BELOW) | {"observe"})

    def test_a_missing_phase_is_found(self):
        text = self.PICTURE.read_text()
        without = re.sub(r' *<rect class="p"[^>]*>\s*<text class="n"[^>]*>actuate<', "", text)
        self.assertNotIn("actuate", drawn(without, "p"))
        self.assertNotEqual(without, text)


class PlantedFaults(unittest.TestCase):
    """Tests the checks with a small source tree that obeys the rules, into which one fault at a time is inserted."""

    GOOD = {
        "base/pose.hpp": "#pragma once\n#include <Eigen/Core>\n#include <cmath>\n",
        "base/assert.hpp": '#include <cstdio>\n#define A std::fprintf(stderr, "no"), std::abort()\n',
        "partition/grid.hpp": '#include "base/pose.hpp"\n',
        "partition/parallel.cpp": "#include <tbb/parallel_for.h>\n#include <thread>\n",
        "engine/world/world.hpp": '#include "engine/links/links.hpp"\n#include "engine/sensing/sensing_view.hpp"\n'
                            '// exit(1), and #include "troupe/troupe.hpp"\n',
        "engine/links/links.hpp": '#include "partition/grid.hpp"\n',
        "engine/shapes.hpp": '#include "partition/grid.hpp"\n',
        "engine/sensing/sensing_view.hpp": '#include "engine/shapes.hpp"\n',
        "sensors/ranger.hpp": '#include "engine/sensing/sensing_view.hpp"\n// params[3].number()\n'
                              "auto x = get(table, params, name); auto y = record[i].given(); auto z = rows[3];\n",
        "models/model_kinds.hpp": '#include "models/drives/drives.hpp"\n',
        "models/drives/drives.hpp": '#include "engine/sensing/sensing_view.hpp"\n',
        "models/devices/lamp.hpp": '#include "models/drives/drives.hpp"\n#include "sensors/ranger.hpp"\n',
        "models/controllers/wander.hpp": '#include "models/devices/lamp.hpp"\n#include "models/model_kinds.hpp"\n',
        "worldio/stage/parser.hpp": '#include "worldio/json/json.hpp"\n',
        "worldio/json/json.hpp": "",
        "worldio/json/json.cpp": '#include <fmt/format.h>\n#include <nlohmann/json.hpp>\nauto s = "printf, exit";\n'
                              "constexpr double k_most_size = 7;\n",
        "render/draw.cpp": "#include <GL/gl.h>\nauto x = a.exit; auto y = b->abort; int snprintf_of;\n",
        "troupe/troupe.hpp": '#include "sensors/ranger.hpp"\n#include "troupe/made.hpp"\n',
        "troupe/made.hpp.in": "",
        "python/bindings.hpp": '#include <pybind11/numpy.h>\n#include "troupe/troupe.hpp"\n',
        "apps/main.cpp": '#include <CLI/CLI.hpp>\n#include <chrono>\n#include "troupe/troupe.hpp"\n',
        "apps/examples/minimal.cpp": "#include <troupe/troupe.hpp>\n#include <iostream>\n",
        "tests/base/pose_test.cpp": '#include <gtest/gtest.h>\n#include "base/pose.hpp"\n',
    }

    def check(self, planted):
        with tempfile.TemporaryDirectory() as folder:
            root = Path(folder)
            for name, text in {**self.GOOD, **planted}.items():
                (root / name).parent.mkdir(parents=True, exist_ok=True)
                (root / name).write_text(text)
            return findings(root)

    def test_a_good_tree_has_none(self):
        self.assertEqual(self.check({}), [])

    def test_each_fault_is_found_where_it_stands(self):
        for name, text, expected in [
            ("base/up.cpp", '\n#include "engine/world/world.hpp"\n', 'base/up.cpp:2: "engine/world/world.hpp": base must not know engine'),
            ("partition/up.hpp", '#include "engine/world/world.hpp"\n', "partition/up.hpp:1: "),
            ("engine/up.hpp", '#include "sensors/ranger.hpp"\n', "engine must not know sensors"),
            ("sensors/up.hpp", '#include "models/drives/drives.hpp"\n', "sensors must not know models"),
            ("sensors/far.cpp", '\n#include "engine/world/world.hpp"\n', 'sensors/far.cpp:2: "engine/world/world.hpp": devices read'),
            ("engine/shapes.hpp", '#include "engine/links/links.hpp"\n', '"engine/shapes.hpp -> engine/links/links.hpp": devices'),
            ("worldio/side.cpp", '#  include "sensors/ranger.hpp"\n', "worldio must not know sensors"),
            ("models/drives/up.hpp", '\n#include "models/devices/lamp.hpp"\n',
             'models/drives/up.hpp:2: "models/devices/lamp.hpp": models/drives must not know models/devices'),
            ("engine/state/rows.hpp", '#include "engine/links/links.hpp"\n', "engine/state must not know engine/links"),
            ("engine/rooms/rows.hpp", '#include "engine/links/links.hpp"\n', "engine/rooms is unknown"),
            ("models/faults/side.cpp", '#include "models/drives/drives.hpp"\n', "models/faults must not know models/drives"),
            ("worldio/json/up.cpp", '#include "worldio/stage/parser.hpp"\n', "worldio/json must not know worldio/stage"),
            ("models/lamps/lamp.cpp", '#include "models/model_kinds.hpp"\n', "models/lamps is unknown"),
            ("render/up.cpp", '#include "troupe/troupe.hpp"\n', "render must not know troupe"),
            ("engine/up.cpp", "#include <troupe/troupe.hpp>\n", "<troupe/troupe.hpp> is ours: use quotes"),
            ("troupe/up.cpp", '#include "apps/main.cpp"\n', "troupe must not know apps"),
            ("base/relative.cpp", '#include "pose.hpp"\n', '"pose.hpp" is no file of ours'),
            ("apps/examples/deep.cpp", '#include "engine/world/world.hpp"\n', "an example shows the public face"),
            ("partition/second.cpp", "#include <oneapi/tbb.h>\n", "partition/parallel.cpp is the one file"),
            ("engine/tasks.cpp", "#include <tbb/task_group.h>\n", "oneTBB is not for this file"),
            ("worldio/json/json.hpp", "#include <nlohmann/json.hpp>\n", "nlohmann-json is not for this file"),
            ("worldio/stage/json.cpp", "#include <nlohmann/json.hpp>\n", "nlohmann-json is not for this file"),
            ("engine/json.cpp", "#include <nlohmann/json.hpp>\n", "nlohmann-json is not for this file"),
            ("worldio/results/hdf5_file.hpp", "#include <hdf5.h>\n", "HDF5 is not for this file"),
            ("troupe/views.cpp", "#include <pybind11/numpy.h>\n", "Python is not for this file"),
            ("troupe/up.hpp", '#include "python/bindings.hpp"\n', '"python/bindings.hpp": troupe must not know python'),
            ("worldio/images/map.hpp", "#include <yaml-cpp/yaml.h>\n", "yaml-cpp is not for this file"),
            ("apps/map.cpp", "#include <yaml-cpp/yaml.h>\n", "yaml-cpp is not for this file"),
            ("apps/record.cpp", "#include <hdf5.h>\n", "HDF5 is not for this file"),
            ("render/context.hpp", "#include <GL/gl.h>\n", "OpenGL is not for this file"),
            ("base/text.hpp", "#include <fmt/core.h>\n", "fmt is not for this file"),
            ("engine/boost.cpp", "#include <boost/any.hpp>\n", "Boost.Beast is not for this file"),
            ("engine/other.cpp", "#include <cereal/cereal.hpp>\n", "<cereal/cereal.hpp> is unknown"),
            ("engine/tasks.cpp", "#include <pthread.h>\n", "the C library for threads is not for this file"),
            ("engine/tty.cpp", "#include <pty.h>\n", "<pty.h>: this C header is not for this file"),
            ("engine/loud.cpp", "#include <iostream>\n", "<iostream> prints"),
            ("engine/loud.cpp", 'void f() { std::printf("x"); }\n', "`printf` prints"),
            ("engine/loud.cpp", '/* x */ void f() { std::fputs("x", stderr); }\n', "engine/loud.cpp:1: `fputs` prints"),
            ("models/stop.cpp", "void f() { std::exit(1); }\n", "`exit` ends the process"),
            ("troupe/clock.cpp", "#include <chrono>\n", "<chrono> reads the clock"),
            ("worldio/home.cpp", 'auto h = getenv("HOME");\n', "`getenv` reads the environment"),
            ("models/dice.cpp", "#include <random>\n", "<random> draws random numbers"),
            ("sensors/own_pool.cpp", "#include <thread>\n", "<thread> is parallel"),
            ("partition/kernel.cpp", "auto f = MulAdd(a, b, c);\n", "`MulAdd` does not round the same"),
            ("sensors/compass.cpp", "\nauto x = Compass{params[0].number()};\n",
             "sensors/compass.cpp:2: `params[0]` reads a parameter by its position"),
            ("models/devices/pack.cpp", "auto x = p[12].text();\n", "`[12].text()` reads a parameter by its position"),
            ("engine/odometry.cpp", "auto x = params[k_kind].text();\n", "`params[k_kind]` reads a parameter by its position"),
            ("apps/examples/far.cpp", "auto x = &params[ranger().params.fields.size()];\n", "by its position"),
            ("tests/base/fan_test.cpp", "auto x = device.params[0];\n", "by its position"),
            ("worldio/stage/size.cpp", "\nconstexpr double k_limit = 100e3;\n",
             "worldio/stage/size.cpp:2: 100e3 repeats a limit: use base/limits.hpp, k_world_reach_m"),
            ("models/far.cpp", "auto x = at_most(100000);\n", "models/far.cpp:1: 100000 repeats a limit"),
            ("worldio/stage/size.cpp", "constexpr double k_most_size = 7;\n", "k_most_size repeats the limit of worldio/json/json.cpp"),
            ("partition/kernel.cpp", "namespace hn = hwy::HWY_NAMESPACE;\n", "goes around partition/simd.inl"),
        ]:
            with self.subTest(text=text, file=name):
                found = self.check({name: text})
                self.assertEqual(len(found), 1, found)
                self.assertIn(expected, found[0])


if __name__ == "__main__":
    if len(sys.argv) > 1:
        ROOT = Path(sys.argv.pop(1)).resolve()
    unittest.main()
