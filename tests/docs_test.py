#!/usr/bin/env python3
"""Runs the documentation: every command and every listing of README.md and docs/*.md.

    docs_test.py TROUPE BUILD [PAGE...] [--verbose] [--keep DIR]

Each page is processed from top to bottom in a temporary folder, which contains the same folders as the source tree
(worlds, apps/examples, build/release). The program is on the path, and ~ is the temporary folder. The rules for pages:

- Code is in blocks, which are indented by four spaces or fenced. A block whose first line begins with a program
  (`troupe`, `cmake`, `cd`, ...) contains commands, which are run one after another in one shell. Each must end with
  exit code 0, and the files that its options name must exist afterwards.
- A block with lines that begin with `$ ` shows commands and their output. A command that prints an error must not end
  with 0.
- Any other block is a shown text: a command further up on the page must have printed it, or it must be in a file that
  such a command has written, or be the list of these files. In a fence with the language `text` it may look like JSON.
  A line `...` stands for any lines, `...` in a line for any text. Numbers must be equal, except wall times, amounts of
  memory and versions.
- JSON, C++, Python, CMake and Stage's `world` are in fences with that language (JSON also indented). A world must load,
  and a fragment must parse. C++ must compile, or be a part of a file of apps/examples. Python must run, all listings of
  a page in one interpreter. If the paragraph before a listing names a file, as "save this as `swarm.json`:", the
  listing is saved in this file for the commands that follow.
- Links to files and headings must have targets, and inline code that begins with `troupe` must have existing options.

docs_rules.py lists the exceptions with their reasons. Exit codes: 0 no fault found, 1 faults, 77 skipped.
"""

import argparse
import ast
import concurrent.futures
import json
import os
import pathlib
import re
import shlex
import shutil
import subprocess
import sys
import tempfile
import time

import docs_rules as rules

ROOT = pathlib.Path(__file__).resolve().parent.parent
PROGRAMS = (r"(troupe|cmake|ctest|cd|cp|sed|mkdir|export|source|man|sudo|apptainer|cat|head|tail|ls|git|h5dump|h5repack|"
            r"for|python3|pip|c?g?\+\+|xdg-open|sbatch|srun|mpirun|mpicc|PYTHONPATH=\S+|\./\S+|scripts/\S+|build/\S+|python/\S+|perf/\S+)")
COMMAND = re.compile(PROGRAMS + r"(\s|$)(?!\d+\.\d)")
LANGUAGES = {"cpp": ".cpp", "c++": ".cpp", "python": ".py", "json": ".json", "cmake": ".txt", "world": ".world"}
DECLARES = (r"^(struct |class |namespace |template|TROUPE_CONTROLLER|TROUPE_DEVICE|"
            r"(?!(?:if|for|while|switch|else|do|return)\b)[\w:]+[\w:<>&* ]* \w+\([^;{]*\) (const )?\{$)")
OUTPUTS = {"--snapshot", "--record", "--hash-log", "--measures", "--events", "--checkpoint", "--profile", "--camera-png", "-o",
           "--output", "--film"}
INTERPRETER = """
import os, sys, traceback
known = {"__name__": "__main__"}
for line in sys.stdin:
    folder, path = line.rstrip().split("\\t")
    os.chdir(folder)
    wrong = 0
    try:
        exec(compile(open(path).read(), path, "exec"), known)
    except SystemExit as end:
        wrong = int(bool(end.code))
    except BaseException:
        traceback.print_exc()
        wrong = 1
    sys.stdout.flush()
    print("\\0", wrong, sep="", flush=True)
"""
MODULES = ("h5py", "pandas", "matplotlib", "numpy", "gymnasium", "pettingzoo", "troupe")  # that listings may need
COMMAND_LIMIT_S = 900  # for a busy machine; a command normally takes less than half a minute


# --- pages -----------------------------------------------------------------------------------------------------------


class Block:
    """A block of code on a page: its first line, its language (if it is fenced), its lines, and the paragraph before it."""

    def __init__(self, page, line, language, lines, before):
        self.page, self.line, self.language, self.before = page, line, language, before
        self.lines = lines
        self.text = "\n".join(lines) + "\n"

    def __str__(self):
        return f"{self.page}:{self.line}"

    def file_name(self):
        """Returns the file name that the paragraph before the listing gives, if any."""
        names = re.findall(r"`([\w./-]+)`", self.before)
        suffix = LANGUAGES.get(self.language or self.kind())
        found = [name for name in names if suffix and name.endswith(suffix)]
        return found[-1] if found and re.search(r"\b[Ss]ave|\bfile `", self.before) else None

    def kind(self):
        if self.language in LANGUAGES:
            return "cpp" if self.language == "c++" else self.language
        if self.language == "text":
            return "shown"
        if any(line.startswith("$ ") for line in self.lines):
            return "session"
        if COMMAND.match(self.lines[0]):
            return "commands"
        if re.match(r'\s*(\{|\[\s*[\[{"]|"[^"]+"\s*:)', self.lines[0]):
            return "json"
        return "shown"


def blocks_of(page):
    lines = (ROOT / page).read_text().split("\n")
    blocks, i, paragraph = [], 0, []
    before = ""
    while i < len(lines):
        fence = re.match(r"```([\w+]*)\s*$", lines[i])
        if fence:
            end = next(k for k in range(i + 1, len(lines)) if lines[k].startswith("```"))
            blocks.append(Block(page, i + 2, fence[1], lines[i + 1:end], " ".join(paragraph) or before))
            i, paragraph, before = end + 1, [], ""
        elif lines[i].startswith("    ") and lines[i].strip() and not paragraph:
            end = i
            while end < len(lines) and (lines[end].startswith("    ") or not lines[end].strip()):
                end += 1
            body = [line[4:] for line in lines[i:end]]
            while not body[-1].strip():
                body.pop()
            blocks.append(Block(page, i + 1, "", body, before))
            i, before = end, ""
        else:
            if lines[i].strip():
                paragraph.append(lines[i].strip())
            elif paragraph:
                before, paragraph = " ".join(paragraph), []
            i += 1
    return blocks


def commands_of(lines):
    """Returns the commands of a block: a line that ends with a backslash is joined with the next line."""
    joined = []
    for line in lines:
        if joined and joined[-1].endswith("\\"):
            joined[-1] = joined[-1][:-1] + " " + line.strip()
        elif line.strip() and not line.lstrip().startswith("#"):
            joined.append(line)
    return [re.sub(r"\s+#\s.*$", "", line).rstrip() for line in joined]


# --- what the program knows ------------------------------------------------------------------------------------------


class Program:
    def __init__(self, path):
        self.path = path
        top = self.ask("--help")
        self.subcommands = set(re.findall(r"^  ([a-z]+) {2,}", top.split("Subcommands:")[1], re.M))
        self.options = {sub: set(re.findall(r"(?:^  |,)(--?[a-z][\w-]*)", self.ask(sub, "--help"), re.M))
                        for sub in self.subcommands}

    def ask(self, *words):
        return subprocess.run([self.path, *words], capture_output=True, text=True, check=True).stdout

    def unknown(self, command):
        """Returns the first subcommand or option of a `troupe` command line that the program does not have, or None."""
        words = re.split(r"\s+", re.split(r"[|;&<>]", command)[0].strip())
        if words[1:2] == ["help"]:
            del words[1]  # `troupe help COMMAND`
        if len(words) < 2 or words[1].startswith("-"):
            return None
        if not re.fullmatch(r"[a-z]+", words[1]):
            return None  # `troupe SUBCOMMAND`
        if words[1] not in self.subcommands:
            return words[1]
        for word in words[2:]:
            option = re.match(r"--?[a-z][\w-]*", word)
            if option and option[0] not in self.options[words[1]] | {"-h", "--help"}:
                return option[0]
        return None


# --- shown texts and printed texts ---------------------------------------------------------------------------------


def line_pattern(line):
    """Returns a regular expression for the lines that a shown line may stand for."""
    varies = re.search(rules.VARYING, line)
    out = []
    for part in re.split(r"(\.\.\.|\s+|(?<![\w.])[-+]?\d[\d,]*(?:\.\d+)?(?:e[-+]?\d+)?)", line.strip()):
        if part == "...":
            out.append(".*")
        elif part.isspace():
            out.append(r"\s+")
        elif part and varies and re.fullmatch(r"[-+]?\d[\d,]*(?:\.\d+)?(?:e[-+]?\d+)?", part):
            out.append(r"[-+]?\d[\d,]*(?:\.\d+)?(?:e[-+]?\d+)?")
        else:
            out.append(re.escape(part))
    return re.compile("".join(out) + r"\s*$")


def first_missing(shown, there):
    """Returns the first shown line that is missing in `there`; None if all lines occur, adjacent except at `...`."""
    wanted = [line for line in shown if line.strip()]
    if all(line.strip() == "..." for line in wanted):
        return None
    lines = [line.strip() for line in there.replace("\r", "\n").split("\n") if line.strip()]
    best = wanted[0]
    for start in range(len(lines)):
        k, free = start, False
        for line in wanted:
            if line.strip() == "...":
                free = True
                continue
            pattern = line_pattern(line)
            if free:
                while k < len(lines) and not pattern.match(lines[k]):
                    k += 1
                free = False
            if k == len(lines) or not pattern.match(lines[k]):
                if line is not wanted[0]:
                    best = line
                break
            k += 1
        else:
            return None
    return best


# --- one page --------------------------------------------------------------------------------------------------------


class Page:
    def __init__(self, test, name):
        self.test, self.name = test, name
        self.blocks = blocks_of(name)
        self.faults, self.left_out = [], []
        self.ran = self.wanted = 0
        self.skipped = []
        self.bound, self.unbound = set(), set()  # names of Python listings that were run; of those left out alone
        self.interpreter = None
        self.printed = []  # output of each command, in order
        self.folder = test.scratch / name.replace("/", "_").removesuffix(".md")
        self.home = self.folder / "home"

    def fault(self, where, text):
        self.faults.append(f"{where}: {text}")

    def prepare(self):
        self.home.mkdir(parents=True)
        shutil.copytree(ROOT / "worlds", self.folder / "worlds", ignore=shutil.ignore_patterns("__pycache__"))
        shutil.copytree(ROOT / "apps/examples", self.folder / "apps/examples")
        (self.folder / "docs").symlink_to(ROOT / "docs")
        if (ROOT / "python").exists():
            (self.folder / "python").symlink_to(ROOT / "python")
        (self.folder / "build").mkdir()
        (self.folder / "build/release").symlink_to(self.test.build)
        (self.home / "opt").mkdir()
        (self.home / "opt" / "troupe").symlink_to(self.test.installed)
        (self.folder / ".cwd").write_text(str(self.folder))
        (self.folder / ".env").write_text("")

    def cwd(self):
        return pathlib.Path((self.folder / ".cwd").read_text().strip())

    def shell(self, command):
        """Runs a command in the shell of the page, which keeps its working folder and variables between commands."""
        keep = self.folder
        script = (f'source "{keep}/.env"\ncd "$(cat "{keep}/.cwd")"\n{command}\ncode=$?\n'
                  f'pwd > "{keep}/.cwd"\nexport -p > "{keep}/.env"\nexit $code\n')
        try:
            return subprocess.run(["bash", "-c", script], env=self.environment(), stdin=subprocess.DEVNULL,
                                  stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True, errors="replace",
                                  timeout=COMMAND_LIMIT_S)
        except subprocess.TimeoutExpired as error:
            return subprocess.CompletedProcess(command, 124, (error.stdout or b"").decode(errors="replace") +
                                               f"\nstill running after {COMMAND_LIMIT_S} s")

    def environment(self):
        environment = {"HOME": str(self.home), "PATH": f"{self.test.bin}:{os.environ['PATH']}", "LC_ALL": "C.UTF-8",
                       "MPLBACKEND": "Agg", "TERM": "dumb", "CMAKE_BUILD_PARALLEL_LEVEL": "2",
                       "PYTHONDONTWRITEBYTECODE": "1",
                       "PYTHONPATH": str(self.test.build / "lib/python3/dist-packages"),
                       "TMPDIR": os.environ.get("TMPDIR", "/tmp")}
        for name in ("CMAKE_CXX_COMPILER_LAUNCHER", "CCACHE_DIR", "CXX"):
            if name in os.environ:
                environment[name] = os.environ[name]
        return environment

    def why_not(self, command):
        for pattern, reason in rules.NOT_RUN:
            if re.search(pattern, command):
                return reason
        for pattern, program in rules.NEEDS:
            if re.search(pattern, command) and not shutil.which(program) and not (self.folder / program).exists():
                return f"there is no {program}"
        if command.startswith("troupe "):
            unknown = self.test.program.unknown(command)
            if unknown in rules.WAITING:
                return f"waits until the program knows {unknown}"
        return None

    def run_command(self, command, where, shown=()):
        """Runs a command and returns its output; None if a rule excludes it. A command that shows an error must fail."""
        self.wanted += 1
        reason = self.why_not(command)
        if reason:
            self.left_out.append(f"{where}: {command}: {reason}")
            return None
        for pattern, replacement, _ in rules.INSTEAD:
            command = re.sub(pattern, replacement, command)
        began = time.monotonic()
        result = self.shell(command)
        self.test.tell(f"{where}: {time.monotonic() - began:5.1f} s  {command}")
        self.printed.append(result.stdout)
        self.ran += 1
        codes = next((codes for pattern, codes in rules.ENDS if re.search(pattern, command)), {0})
        if any(re.search(r"\berror: ", line) for line in shown):
            codes = {1, 2}
        if result.returncode not in codes:
            self.fault(where, f"{command}\n    ended with {result.returncode}:\n" +
                       "\n".join("    " + line for line in result.stdout.strip().split("\n")[-15:]))
            return result.stdout
        if command.startswith("troupe"):
            words = shlex.split(command)
            for option, value in zip(words, words[1:]):
                if option in OUTPUTS and result.returncode in (0, 3):
                    name = re.sub(r"\{\w+\}|%\d*d", "*", os.path.expanduser(value.replace("~", str(self.home))))
                    if not list(self.cwd().glob(name) if not name.startswith("/") else [name]):
                        self.fault(where, f"{command}\n    there is no {value} afterwards")
        return result.stdout

    def commands(self, block):
        for command in commands_of(block.lines):
            self.run_command(command, block)

    def session(self, block):
        parts, current = [], None
        for line in block.lines:
            if line.startswith("$ "):
                current = (line[2:], [])
                parts.append(current)
            elif current:
                current[1].append(line)
        for command, shown in parts:
            printed = self.run_command(commands_of([command])[0], block, shown)
            if printed is not None and any(line.strip() for line in shown):
                missing = first_missing(shown, printed)
                if missing is not None:
                    self.fault(block, f"{command} does not print the line\n    {missing}\n  but\n" +
                               "\n".join("    " + line for line in printed.split("\n")[:40]))

    def shown(self, block):
        for page, start, _ in rules.SHOWN_ONLY:
            if page == self.name and block.lines[0].strip().startswith(start):
                self.test.used.add((page, start))
                return
        places = list(reversed(self.printed))
        written = [path for path in self.folder.rglob("*")
                   if path.is_file() and not path.is_symlink() and not path.name.startswith(".")
                   and path.stat().st_mtime >= self.began and path.stat().st_size < 20_000_000]
        places.append("\n".join(sorted(path.name for path in written)))
        places += [path.read_text(errors="replace") for path in sorted(written, key=lambda path: -path.stat().st_mtime)
                   if path.suffix in (".csv", ".log", ".txt", ".json", ".world")]
        missing = [first_missing(block.lines, place) for place in places]
        if not places or None not in missing:
            self.fault(block, f"nothing that was printed or written on this page has these lines, the first of which is\n    "
                       f"{block.lines[0]}\n  (nearest miss: {missing[0] if missing else ''})")

    def save(self, block):
        """Saves a listing in the file that the paragraph before it names. Returns the path; None if it names no file."""
        name = block.file_name()
        if name is None:
            return None
        path = self.cwd() / name
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_text(block.text)
        return path

    def load(self, block, path):
        if (self.name, path.name) in rules.NOT_LOADED:
            return
        result = self.shell(f"troupe lint {path}")
        self.printed.append(result.stdout)
        if result.returncode not in (0, 1):
            self.fault(block, f"this world does not load:\n{result.stdout}")

    def world(self, block):
        path = self.save(block)
        if path is None:
            path = self.folder / "worlds" / "listing.world"
            path.write_text(block.text)
        self.load(block, path)

    def json(self, block):
        path = self.save(block)
        fragment = block.text
        for text in (fragment, "{" + fragment.rstrip().rstrip(",") + "}", "[" + fragment.rstrip().rstrip(",") + "]"):
            try:
                value = json.loads(text)
                break
            except ValueError as error:
                value, wrong = None, error
        if value is None:
            self.fault(block, f"this is no JSON: {wrong}")
            return
        if isinstance(value, dict) and "troupe" in value and "types" in value:
            if path is None:
                path = self.folder / "worlds" / "listing.json"
                path.write_text(block.text)
            self.load(block, path)

    def cpp(self, block):
        self.save(block)
        self.test.add_cpp(self, block)

    def cmake(self, block):
        if self.save(block):
            return
        squeezed = re.sub(r"\s+", " ", block.text.strip())
        if not any(squeezed in re.sub(r"\s+", " ", path.read_text()) for path in
                   [*ROOT.glob("apps/**/CMakeLists.txt"), *ROOT.glob("tests/install/*"), *self.folder.rglob("CMakeLists.txt")]
                   if path.is_file()):
            self.fault(block, "no CMakeLists.txt of apps, tests/install or this page has these lines")

    def python(self, block):
        self.wanted += 1
        modules = set(re.findall(rf"^\s*(?:import|from) ({'|'.join(MODULES)})\b", block.text, re.M))
        modules |= {module for pattern, module in rules.NEEDS_MODULE if re.search(pattern, block.text)}
        lacking = sorted(modules - self.test.modules)
        bound, used = names_in(block.text)
        if lacking or used & self.unbound - bound:
            self.unbound |= bound - self.bound
            self.skipped.append(block)
            why = (f"there is no {' and '.join(lacking)} for {self.test.python}" if lacking else
                   f"it needs {', '.join(sorted(used & self.unbound - bound))} of a listing that was left out")
            self.left_out.append(f"{block}: Python listing: {why}")
            return
        self.bound |= bound
        self.unbound -= bound
        path = self.save(block)
        if path is None:
            path = self.cwd() / ".listing.py"
            path.write_text(block.text)
        began = time.monotonic()
        printed, is_right = self.interpret(path)
        self.test.tell(f"{block}: {time.monotonic() - began:5.1f} s  Python listing")
        self.printed.append(printed)
        self.ran += 1
        if not is_right:
            self.fault(block, "Python says\n" + "\n".join("    " + line for line in printed.strip().split("\n")[-8:]))

    def interpret(self, path):
        """Runs a listing in the Python interpreter of the page, which keeps the definitions of earlier listings."""
        if self.interpreter is None:
            self.interpreter = subprocess.Popen([self.test.python, "-u", "-c", INTERPRETER], env=self.environment(), text=True,
                                                stdin=subprocess.PIPE, stdout=subprocess.PIPE, stderr=subprocess.STDOUT)
        self.interpreter.stdin.write(f"{self.cwd()}\t{path}\n")
        self.interpreter.stdin.flush()
        printed = []
        for line in self.interpreter.stdout:
            if "\0" in line:
                printed.append(line.split("\0")[0])
                return "".join(printed), line.split("\0")[1].strip() == "0"
            printed.append(line)
        return "".join(printed), False

    def inline(self):
        """Checks that links have targets, and that inline code that begins with `troupe` has existing options."""
        text = (ROOT / self.name).read_text()
        text = re.sub(r"^```.*?^```", lambda m: "\n" * m[0].count("\n"), text, flags=re.M | re.S)
        for match in re.finditer(r"\]\(([^)\s]+)\)", text):
            where = f"{self.name}:{text.count(chr(10), 0, match.start()) + 1}"
            link, _, heading = match[1].partition("#")
            if re.match(r"\w+:", link):
                continue
            target = ((ROOT / self.name).parent / link).resolve() if link else ROOT / self.name
            if target.name in rules.WAITING_PAGES and not target.exists():
                self.left_out.append(f"{where}: the link to {target.name}: waits for the page")
            elif not target.exists():
                self.fault(where, f"the link leads to {link}, which is not there")
            elif heading and heading not in headings(target):
                self.fault(where, f"{link or self.name} has no heading #{heading}")
        prose = re.sub(r"`[^`\n]*`|^    .*$|\]\([^)]*\)", lambda m: " " * len(m[0]), text, flags=re.M)
        for match in re.finditer(r"\b[A-Z]+_[A-Z_]+\b", prose):
            self.fault(f"{self.name}:{text.count(chr(10), 0, match.start()) + 1}", f"{match[0]} stands for something else")
        for match in re.finditer(r"`(troupe [a-z][^`]*)`", text):
            where = f"{self.name}:{text.count(chr(10), 0, match.start()) + 1}"
            unknown = self.test.program.unknown(match[1])
            if unknown and unknown not in rules.WAITING:
                self.fault(where, f"`{match[1]}`: the program has no {unknown}")

    def walk(self):
        self.inline()
        if not self.blocks:
            return self
        self.prepare()
        self.began = time.time() - 1
        for command in rules.BEFORE.get(self.name, []):
            result = self.shell(command)
            if result.returncode:
                self.fault(self.name, f"{command} (before the page) ended with {result.returncode}: {result.stdout}")
        try:
            for block, before in zip(self.blocks, [None, *self.blocks]):
                if not (before is not None and before.kind() == "python" and before in self.skipped and block.kind() == "shown"):
                    getattr(self, block.kind())(block)
        finally:
            if self.interpreter:
                self.interpreter.stdin.close()
                self.interpreter.wait()
        if self.wanted and not self.ran:
            self.fault(self.name, "none of its commands is run")
        return self


def headings(page):
    """Returns the anchors that GitHub gives the headings of a page."""
    text = re.sub(r"^```.*?^```", "", page.read_text(), flags=re.M | re.S)
    return {re.sub(r"\s", "-", re.sub(r"[^\w\s-]", "", re.sub(r"[`*]", "", title).strip().lower()))
            for title in re.findall(r"^#+ (.*)$", text, re.M)}


# --- all of them -----------------------------------------------------------------------------------------------------


class Test:
    def __init__(self, program, build, scratch, verbose):
        self.scratch, self.build, self.verbose = scratch, build, verbose
        self.program = Program(program)
        self.bin = scratch / "bin"
        self.bin.mkdir(parents=True)
        (self.bin / "troupe").symlink_to(program)
        self.installed = scratch / "installed"
        subprocess.run(["cmake", "--install", build, "--prefix", self.installed], check=True, stdout=subprocess.DEVNULL)
        self.python, self.modules = python_with_modules(build)
        (self.bin / "python3").symlink_to(self.python)
        self.cpp = []
        self.used = set()

    def tell(self, text):
        if self.verbose:
            print(text, flush=True)

    def add_cpp(self, page, block):
        if any(block.text in path.read_text() for path in (ROOT / "apps/examples").rglob("*.cpp")):
            return
        for name, start, _ in rules.CPP_NOT_COMPILED:
            if name == page.name and block.lines[0].startswith(start):
                self.used.add((name, start))
                return
        self.cpp.append((page.name, block))

    def compile_cpp(self):
        """Compiles all C++ listings as one translation unit, each in its own namespace. Returns the compiler errors."""
        includes = ["<troupe/troupe.hpp>", "<troupe/plugin.hpp>", "<algorithm>", "<iostream>", "<thread>", "<vector>"]
        lines = []
        for number, (page, block) in enumerate(self.cpp):
            lines += [f"namespace listing_{number} {{", "using namespace troupe;", *rules.CPP_BEFORE.get(page, "").split("\n")]
            declares = re.search(DECLARES, block.text, re.M)
            lines += [f'#line {block.line} "{page}"', *(["void run() {"] if not declares else [])]
            lines += [f'#line {block.line} "{page}"',
                      *(re.sub(r"^TROUPE_CONTROLLER\(.*", "", line) for line in block.lines), "}" if declares else "}}"]
        own = [line.strip() for line in lines if line.strip().startswith("#include")]
        lines = ["" if line.strip().startswith("#include") else line for line in lines]
        lines = [*dict.fromkeys([f"#include {name}" for name in includes] + own), *lines]
        source = self.scratch / "listings.cpp"
        source.write_text("\n".join(lines) + "\n")
        eigen = next((path for path in ("/usr/include/eigen3", "/usr/local/include/eigen3") if os.path.exists(path)),
                     "/usr/include")
        command = [os.environ.get("CXX", "c++"), "-std=c++20", "-fsyntax-only", "-ffp-contract=off", "-DEIGEN_DONT_VECTORIZE",
                   "-DEIGEN_MAX_ALIGN_BYTES=16", f"-I{self.installed}/include/troupe",
                   "-isystem", eigen, source]
        result = subprocess.run(command, capture_output=True, text=True)
        if result.returncode == 0:
            return []
        return [line for line in result.stderr.split("\n") if "error:" in line] or [result.stderr]


def names_in(text):
    """Returns the names that a Python listing binds, and those that it uses; none if the listing has a syntax error."""
    try:
        nodes = list(ast.walk(ast.parse(text)))
    except SyntaxError:
        return set(), set()
    bound = {alias.asname or alias.name.split(".")[0] for node in nodes if isinstance(node, (ast.Import, ast.ImportFrom))
             for alias in node.names}
    bound |= {node.name for node in nodes if isinstance(node, (ast.FunctionDef, ast.ClassDef))}
    bound |= {node.id for node in nodes if isinstance(node, ast.Name) and isinstance(node.ctx, ast.Store)}
    return bound, {node.id for node in nodes if isinstance(node, ast.Name) and isinstance(node.ctx, ast.Load)}


def python_with_modules(build):
    """Returns the Python interpreter that has most of the modules that listings import, and these modules. It is this one,
    Debian's, or one of them with the packages of tests/python/packages.py, which are installed if that is possible."""
    package = build / "lib/python3/dist-packages"
    environment = {**os.environ, "PYTHONPATH": str(package)}

    def run(python, *arguments):
        return subprocess.run([python, *arguments], capture_output=True, text=True, env=environment)

    def modules_of(python):
        return set(run(python, "-c", f"import importlib.util as u\nprint(*[m for m in {MODULES} if u.find_spec(m)])").stdout.split())

    found = {python: modules_of(python) for python in (sys.executable, "/usr/bin/python3") if os.path.exists(python)}
    if (package / "troupe").exists():
        made = run(max(found, key=lambda python: len(found[python])), ROOT / "tests/python/packages.py")
        if made.returncode == 0:
            python = made.stdout.strip()
            found[python] = modules_of(python)
    return max(found.items(), key=lambda each: len(each[1]))


def main():
    parser = argparse.ArgumentParser(description=__doc__.split("\n")[0])
    parser.add_argument("troupe", type=pathlib.Path)
    parser.add_argument("build", type=pathlib.Path)
    parser.add_argument("pages", nargs="*")
    parser.add_argument("--verbose", action="store_true", help="tell each command and how long it took")
    parser.add_argument("--keep", type=pathlib.Path, help="the scratch folder, which is kept")
    arguments = parser.parse_args()

    if not shutil.which("bash") or not shutil.which("cmake"):
        print("SKIPPED: no bash or no cmake: the documentation was not run")
        return 77
    pages = arguments.pages or ["README.md", *sorted(f"docs/{path.name}" for path in (ROOT / "docs").glob("*.md"))]
    scratch = arguments.keep or pathlib.Path(tempfile.mkdtemp(prefix="troupe_docs_"))
    if arguments.keep:
        shutil.rmtree(scratch, ignore_errors=True)
    try:
        test = Test(arguments.troupe.resolve(), arguments.build.resolve(), scratch.resolve(), arguments.verbose)
        with concurrent.futures.ThreadPoolExecutor(2) as pool:
            walked = list(pool.map(lambda name: Page(test, name).walk(), pages))
        faults = [fault for page in walked for fault in page.faults] + test.compile_cpp()
    finally:
        if not arguments.keep:
            shutil.rmtree(scratch, ignore_errors=True)

    for page in walked:
        for text in page.left_out:
            print("left out:", text)
    for page, start, _ in rules.SHOWN_ONLY + rules.CPP_NOT_COMPILED:
        if not arguments.pages and (page, start) not in test.used:
            faults.append(f"tests/docs_rules.py: {page} shows no text that begins with {start!r}")
    for fault in faults:
        print("\n" + fault)
    blocks = sum(len(page.blocks) for page in walked)
    print(f"\n{len(walked)} pages, {blocks} blocks: {sum(page.ran for page in walked)} commands and listings run, "
          f"{sum(len(page.left_out) for page in walked)} left out, {len(test.cpp)} listings compiled, {len(faults)} faults")
    return 1 if faults else 0


if __name__ == "__main__":
    sys.exit(main())
