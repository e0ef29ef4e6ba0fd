#!/usr/bin/env python3
"""Tests that the scripts of scripts/ and perf/ print their help, reject wrong arguments, and stop at errors."""

import json
import os
import pathlib
import re
import shutil
import subprocess
import tempfile
import unittest

ROOT = pathlib.Path(__file__).resolve().parent.parent
SCRIPTS = sorted(file for file in (ROOT / "scripts").iterdir() if file.is_file() and os.access(file, os.X_OK))
IN_BASH = [script for script in SCRIPTS if script.read_text(encoding="utf-8").startswith("#!/usr/bin/env bash\n")]
# Without the packages of the system, such as NumPy.
BARE_PYTHON = ("/usr/bin/env", "python3", "-E", "-S")


def call(*command, **options):
    return subprocess.run(list(map(str, command)), capture_output=True, text=True, timeout=120, stdin=subprocess.DEVNULL, **options)


class Help(unittest.TestCase):
    def test_of_scripts(self):
        for script in SCRIPTS:
            with self.subTest(script=script.name):
                done = call(script, "--help", cwd="/")
                self.assertEqual((done.returncode, done.stderr), (0, ""))
                self.assertRegex(done.stdout, rf"(?m)^ +scripts/{script.name}\b")

    def test_of_scripts_in_bash_is_the_comment_at_their_beginning(self):
        self.assertGreater(len(IN_BASH), 10)
        for script in IN_BASH:
            with self.subTest(script=script.name):
                comment = re.match(r"#!.*\n((?:#.*\n)+)", script.read_text(encoding="utf-8"))[1]
                self.assertEqual(call(script, "release", "-h").stdout, re.sub(r"(?m)^# ?", "", comment))

    def test_does_not_depend_on_where_cd_searches(self):
        with tempfile.TemporaryDirectory() as folder:
            (pathlib.Path(folder) / "scripts").mkdir()
            for script in IN_BASH:
                with self.subTest(script=script.name):
                    done = call(f"scripts/{script.name}", "--help", cwd=ROOT, env={**os.environ, "CDPATH": folder})
                    self.assertEqual((done.returncode, done.stderr), (0, ""))
                    self.assertNotIn(folder, done.stdout)

    def test_of_scripts_in_perf_needs_no_packages(self):
        scripts = sorted((ROOT / "perf").glob("*.py"))
        self.assertGreater(len(scripts), 3)
        for script in scripts:
            with self.subTest(script=script.name):
                done = call(*BARE_PYTHON, script, "--help")
                self.assertEqual((done.returncode, done.stderr), (0, ""))
                self.assertIn(f"usage: {script.name} ", done.stdout)


class Errors(unittest.TestCase):
    def folder(self):
        made = tempfile.TemporaryDirectory(prefix="troupe scripts ")
        self.addCleanup(made.cleanup)
        return pathlib.Path(made.name)

    def test_wrong_arguments(self):
        """Also where the tools of the scripts are not installed: arguments are checked first."""
        bare = self.folder()
        for tool in ("bash", "dirname", "env", "git", "python3", "sed", "uname"):
            (bare / tool).symlink_to(shutil.which(tool))
        wrong = {"build": [(), ("--fast",)], "check-package": [("all",)], "format": [("--all",)], "fuzz": [(), ("0",), ("9", "xml")],
                 "reference": [("--all",)], "replay-page": [("all",)], "setup": [("--all",)], "sysroot": [("arm64",)],
                 "wheel": [("--all",)]}
        for script, calls in wrong.items():
            for arguments in calls:
                with self.subTest(script=script, arguments=arguments):
                    done = call(ROOT / "scripts" / script, *arguments, env={**os.environ, "PATH": str(bare)})
                    self.assertEqual((done.returncode, done.stdout), (2, ""))
                    self.assertRegex(done.stderr, rf"^(usage: scripts/{script}|scripts/{script}: error: .*allowed are )")
                    self.assertEqual(done.stderr.count("\n"), 1)

    def test_lint_finds_no_such_file(self):
        done = call(ROOT / "scripts/lint", "CMakeLists.txt", "world.cpp", cwd=ROOT / "engine")
        self.assertEqual((done.returncode, done.stdout, done.stderr), (2, "", "scripts/lint: error: there is no file world.cpp\n"))

    def test_missing_packages_of_scripts_in_perf(self):
        for script, arguments in {"learning.py": ("8",), "learning_vmas.py": (), "plot_paper.py": ("paper.json",)}.items():
            with self.subTest(script=script):
                done = call(*BARE_PYTHON, ROOT / "perf" / script, *arguments)
                self.assertEqual((done.returncode, done.stdout), (1, ""))
                self.assertRegex(done.stderr, rf"^{script}: error: No module named '\w+'; scripts/.*\n$")

    def test_wrong_arguments_of_scripts_in_perf(self):
        for script, arguments, message in (("learning.py", ("8", "0"), "expected a number of copies of at least 1, found 0"),
                                           ("live_view.py", ("none",), "there is no program .*none; scripts/build release builds ")):
            with self.subTest(script=script):
                done = call(*BARE_PYTHON, ROOT / "perf" / script, *arguments)
                self.assertEqual((done.returncode, done.stdout), (2, ""))
                self.assertRegex(done.stderr, message)

    def stub(self, file, text):
        file.parent.mkdir(parents=True, exist_ok=True)
        file.write_text(f"#!/bin/sh\n{text}\n")
        file.chmod(0o755)

    def test_a_program_that_does_not_exist(self):
        for script in ("check-convert", "count-ranks", "gallery", "scenes"):
            with self.subTest(script=script):
                done = call(ROOT / "scripts" / script, "--program", "none")
                self.assertEqual((done.returncode, done.stdout), (2, ""))
                self.assertRegex(done.stderr, "error: there is no program none; build it with scripts/build release, or name another one "
                                              "with --program\n$")

    def test_a_program_that_fails_ends_the_drawing(self):
        for script, only in (("gallery", "cave"), ("scenes", "chain")):  # the curves of the scene need 30 runs
            with self.subTest(script=script):
                folder = self.folder()
                self.stub(folder / "troupe", f'echo . >>"{folder}/runs"; sleep 0.1; exit 4')
                done = call(ROOT / "scripts" / script, "--program", folder / "troupe", "--into", folder / "into", "--only", only)
                self.assertEqual(done.returncode, 2)
                self.assertRegex(done.stderr, rf"^scripts/{script}: error: exit code 4 of '.*troupe' (run|render) .*\n$")
                self.assertLess(len((folder / "runs").read_text()), 2 * (3 + 2 * len(os.sched_getaffinity(0))))
                self.assertEqual(list((folder / "into").iterdir()), [])

    def test_format_says_why_clang_format_fails(self):
        folder = self.folder()
        for name in ("format", "help.sh"):
            (folder / "scripts").mkdir(exist_ok=True)
            shutil.copy(ROOT / "scripts" / name, folder / "scripts")
        environment = {**os.environ, "PATH": f"{folder}/bin:{os.environ['PATH']}"}
        self.stub(folder / "bin/git", r"printf 'a b.cpp\0'")

        def check(version, how):
            self.stub(folder / "bin/clang-format-14", f'if [ "$1" = --version ]; then echo "clang-format version {version}"; exit; fi; {how}')
            return call(folder / "scripts/format", "--check", env=environment)

        done = check("14.0.6", 'echo "a b.cpp:1:1: warning: code should be clang-formatted" >&2')
        self.assertEqual((done.returncode, done.stdout), (1, ""))
        self.assertRegex(done.stderr, r"with the number of places\):\n +1 a b\.cpp\n$")
        done = check("14.0.6", 'echo "error: unknown key Indentation" >&2; exit 1')
        self.assertEqual((done.returncode, done.stdout), (2, ""))
        self.assertEqual(done.stderr, "error: unknown key Indentation\nscripts/format: error: clang-format failed\n")
        done = check("19.1.0", "exit 0")
        self.assertEqual((done.returncode, done.stdout), (2, ""))
        self.assertEqual(done.stderr, "scripts/format: error: clang-format 14 is needed, because other versions format differently; "
                                      "found: clang-format version 19.1.0\n")
        self.assertEqual(check("14.0.6", "exit 0").stdout, "format: clean\n")

    def test_without_apt_no_package_is_installed(self):
        folder = self.folder()
        (folder / "scripts").mkdir()
        (folder / "bin").mkdir()
        for tool in ("bash", "dirname"):
            (folder / "bin" / tool).symlink_to(shutil.which(tool))
        self.stub(folder / "scripts/setup", 'echo "setup $*"')
        self.stub(folder / "scripts/build", "echo build; exit 7")
        shutil.copy(ROOT / "scripts/help.sh", folder / "scripts")
        for installed in ("", "setup"):
            for script in ("test", "quickstart", "bench"):
                with self.subTest(script=script, installed=installed):
                    shutil.copy(ROOT / "scripts" / script, folder / "scripts")
                    done = call(folder / "scripts" / script, env={"PATH": str(folder / "bin")})
                    self.assertEqual((done.returncode, done.stderr), (7, ""))
                    words = [line.split()[0] for line in done.stdout.splitlines() if not line.startswith("==")]
                    self.assertEqual(words, [*filter(None, [installed]), "build"])
            self.stub(folder / "bin/apt-get", "exit 0")

    def test_checks_need_the_tools_of_cpack(self):
        folder = self.folder()
        self.stub(folder / "bin/dpkg-query", "exit 1")  # nothing is installed
        self.stub(folder / "bin/sudo", 'exec "$@"')
        self.stub(folder / "bin/apt-get", 'echo "apt-get $*"')
        done = call(ROOT / "scripts/setup", "--checks", env={**os.environ, "PATH": f"{folder}/bin:{os.environ['PATH']}"})
        self.assertEqual((done.returncode, done.stderr), (0, ""))
        installed = done.stdout.splitlines()[-1].split()
        self.assertEqual(installed[:2], ["apt-get", "install"])
        self.assertLessEqual({"cmake", "dpkg-dev", "file", "mpich", "slurmd"}, set(installed))

    def test_quickstart_builds_the_python_package_and_draws_if_it_can(self):
        picture = " --snapshot out/hospital.png"
        for targets, built, drawn, said in (
                ("troupe troupe_python troupe_render", ["bin/troupe", "troupe_python"], picture, "Picture of the final state: "),
                ("troupe troupe_render", ["bin/troupe"], picture, "The Python package is not built, because pybind11 "),
                ("troupe troupe_python", ["bin/troupe", "troupe_python"], "", "No picture was drawn, because the headers of OpenGL ")):
            with self.subTest(targets=targets):
                folder = self.folder()
                (folder / "scripts").mkdir()
                for name in ("quickstart", "help.sh"):
                    shutil.copy(ROOT / "scripts" / name, folder / "scripts")
                self.stub(folder / "scripts/setup", "exit 0")
                self.stub(folder / "scripts/build", f'echo "build $2"; echo "{targets}" >build/release/build.ninja')
                self.stub(folder / "build/release/bin/troupe", 'echo "troupe $*"')
                done = call(folder / "scripts/quickstart", "--threads", "1")
                self.assertEqual((done.returncode, done.stderr), (0, ""))
                self.assertEqual(re.findall(r"(?m)^build (.*)", done.stdout), built)
                self.assertIn(said, done.stdout)
                self.assertIn(f"troupe run worlds/hospital.json --for 60{drawn} --threads 1\n", done.stdout)

    @unittest.skipUnless(shutil.which("doxygen"), "no Doxygen (scripts/setup --checks installs it)")
    def test_check_of_the_reference_writes_nothing_into_the_clone(self):
        folder = self.folder()
        for name in ("scripts/reference", "scripts/help.sh", "docs/Doxyfile", "docs/reference.md"):
            (folder / name).parent.mkdir(exist_ok=True)
            shutil.copy(ROOT / name, folder / name)
        for name in ("base", "cmake", "engine", "live", "models", "partition", "render", "sensors", "troupe", "worldio"):
            (folder / name).mkdir()
        (folder / "cmake/internal_headers.txt").write_text("base\n!base/number.hpp\n")
        (folder / "base/inner.hpp").write_text("int inner();\n")
        (folder / "base/number.hpp").write_text("/// @file\nint number();  ///< a number\n")
        (folder / "temporary").mkdir()

        def check():
            before = sorted(folder.rglob("*"))
            done = call(folder / "scripts/reference", "--check", env={**os.environ, "TMPDIR": str(folder / "temporary")})
            self.assertEqual(sorted(folder.rglob("*")), before)
            return done

        done = check()
        self.assertEqual((done.returncode, done.stdout, done.stderr), (0, "", ""))
        (folder / "base/number.hpp").write_text("/// @file\nint number();\n")
        done = check()
        self.assertEqual(done.returncode, 1)
        self.assertIn("base/number.hpp:2: error: number has no docstring", done.stderr)

    def test_bench_draws_only_what_it_has_measured(self):
        folder = self.folder()
        (folder / "scripts").mkdir()
        for name in ("bench", "help.sh"):
            shutil.copy(ROOT / "scripts" / name, folder / "scripts")
        for name in ("setup", "build"):
            self.stub(folder / "scripts" / name, "exit 0")
        (folder / "perf").mkdir()
        (folder / "perf/plot_paper.py").write_text('import sys\nprint("draws", open(sys.argv[1]).read())\n')
        (folder / "build/perf").mkdir(parents=True)
        measured = folder / "build/perf/paper.json"
        measured.write_text("old")
        for how, code, drawn, kept in (("exit 2", 2, "", "old"),  # a wrong option
                                       ("exit 0", 0, "", "old"),  # --list
                                       ('printf new >"$2"; exit 1', 1, "draws new\n", "new"),  # a wrong hash
                                       ('printf newer >"$2"', 0, "draws newer\n", "newer")):
            with self.subTest(how=how):
                self.stub(folder / "build/release/bin/perf_paper", how)
                done = call(folder / "scripts/bench")
                self.assertEqual((done.returncode, done.stdout, done.stderr), (code, drawn, ""))
                self.assertEqual(measured.read_text(), kept)
                self.assertEqual([file.name for file in measured.parent.iterdir()], [measured.name])


class Configuration(unittest.TestCase):
    def test_options_and_presets_are_documented(self):
        page = (ROOT / "docs/install.md").read_text(encoding="utf-8")
        options = re.findall(r"(?m)^option\((\w+)", (ROOT / "CMakeLists.txt").read_text(encoding="utf-8"))
        presets = json.loads((ROOT / "CMakePresets.json").read_text(encoding="utf-8"))["configurePresets"]
        names = options + [preset["name"] for preset in presets if not preset.get("hidden")]
        self.assertGreater(len(names), 20)
        self.assertEqual([name for name in names if f"`{name}`" not in page], [])


if __name__ == "__main__":
    unittest.main()
