"""Checks random worlds: makes worlds (random_worlds.py), runs them in many ways (checks.py), counts what occurs in them
(coverage.py), and shrinks (shrink.py) and keeps worlds that fail."""

import json
import os
import pathlib
import resource
import select
import shlex
import shutil
import subprocess
import sys
import time
from collections import Counter

from . import checks as check_plans
from .coverage import Coverage
from .kinds import kinds_of
from .random_worlds import PLAN, make_world, pairs_of, plan_image
from .runs import ROOT, Fault, read_log
from .shrink import Shrinker
from .table import clock

KEPT = ROOT / "build" / "prove" / "random"
WORKER = pathlib.Path(__file__).resolve().parent / "library_worker.py"
# In a proof of at least this many worlds, every kind and event must occur; otherwise the generator has a fault.
COMPLETE_AT = 2000
# At least this fraction of the worlds must be valid.
LEAST_VALID = 0.9
# A check counts as hanging after this much processor time, or after this much wall time on a busy machine.
TIMEOUT_CPU_S = 60
TIMEOUT_S = 900
MOST_KEPT = 10


def processor_s():
    """Returns the processor time of this process and of its children that have ended, s. On a busy machine, processor time
    varies less between runs than wall time does."""
    own, children = resource.getrusage(resource.RUSAGE_SELF), resource.getrusage(resource.RUSAGE_CHILDREN)
    return own.ru_utime + own.ru_stime + children.ru_utime + children.ru_stime


def module_folder(preset):
    return ROOT / "build" / preset / "lib" / "python3" / "dist-packages"


def interpreter_of(folder):
    """Returns the path of a Python interpreter that can load the module `troupe` in this folder, or None if there is none."""
    for interpreter in (sys.executable, "/usr/bin/python3"):
        if not os.path.exists(interpreter) or not folder.is_dir():
            continue
        done = subprocess.run([interpreter, "-c", "import troupe; troupe.Simulation"], capture_output=True, cwd="/",
                              env={**os.environ, "PYTHONPATH": str(folder)})
        if done.returncode == 0:
            return interpreter
    return None


class Library:
    """Runs checks in a process with the Python module (library_worker.py), and restarts the process if a world crashes it.
    program: path of `troupe`; folder: folder for files; module: folder of the Python module. Raises Fault if no interpreter
    can load the module."""

    program_only = False

    def __init__(self, program, folder, module):
        self.program, self.folder, self.module = program, folder, module
        self.interpreter = interpreter_of(module)
        if self.interpreter is None:
            raise Fault(f"{module}: there is no Python module of Troupe that can be loaded; build the target troupe_python")
        self._process = None

    def _start(self):
        # MALLOC_PERTURB_ fills allocated memory, so that reads of uninitialised values change results.
        environment = {**os.environ, "PYTHONPATH": str(self.module), "MALLOC_PERTURB_": "165"}
        self._process = subprocess.Popen([self.interpreter, WORKER], stdin=subprocess.PIPE, stdout=subprocess.PIPE,
                                         stderr=open(self.folder / "worker.log", "w"), cwd=self.folder, env=environment)
        self._pending = b""
        self._answer()

    def _cpu_s(self):
        """Returns the processor time of the worker process, s; 0 if the process has ended."""
        try:
            fields = pathlib.Path(f"/proc/{self._process.pid}/stat").read_text().rsplit(")", 1)[1].split()
        except OSError:
            return 0.0
        return (int(fields[11]) + int(fields[12])) / os.sysconf("SC_CLK_TCK")

    def _answer(self):
        """Returns ("told", the next answer of the process), or ("crash" or "hangs", a text with the reason) if the process has
        crashed or gives no answer in time."""
        end, cpu_end = time.monotonic() + TIMEOUT_S, self._cpu_s() + TIMEOUT_CPU_S
        output = self._process.stdout.fileno()
        while b"\n" not in self._pending:
            if not select.select([output], [], [], 1)[0]:
                if time.monotonic() > end or self._cpu_s() > cpu_end:
                    return "hangs", f"not finished after {TIMEOUT_CPU_S} s of processor time or {TIMEOUT_S} s of wall time"
                continue
            got = os.read(output, 1 << 20)
            if not got:
                code = self._process.wait()
                return "crash", (f"the process ended with code {code}: "
                                 f"{(self.folder / 'worker.log').read_text()[-1500:].strip()}")
            self._pending += got
        line, self._pending = self._pending.split(b"\n", 1)
        return "told", json.loads(line)

    def run(self, world, ticks, checks, cover=False):
        if self._process is None or self._process.poll() is not None:
            self._start()
        request = {"world": world, "folder": str(self.folder), "program": str(self.program), "ticks": ticks, "checks": checks,
                   "cover": cover}
        self._process.stdin.write(json.dumps(request).encode() + b"\n")
        self._process.stdin.flush()
        how, told = self._answer()
        if how == "told":
            return told
        self.close()
        if len(checks) > 1:  # find the check that fails
            told = {"failures": [], "events": [], "refused": [], "resumed": [], "ticks": ticks, "stopped": ""}
            for check in checks:
                one = self.run(world, ticks, [check])
                told["failures"] += one.get("failures", [])
            return told
        return {"failures": [{"check": checks[0], "tick": None, "text": f"{how}: {told}"}], "events": [], "refused": [],
                "resumed": [], "ticks": ticks, "stopped": ""}

    def close(self):
        if self._process is not None:
            self._process.kill()
            self._process.wait()
            self._process = None


class Program:
    """Runs checks without the Python module: with `troupe check`, and with runs of `troupe` that are saved and resumed.
    program: path of `troupe`; folder: folder for files."""

    program_only = True

    def __init__(self, program, folder):
        self.program, self.folder = program, folder

    def _call(self, *arguments):
        command = [str(self.program), *map(str, arguments)]
        return subprocess.run(command, capture_output=True, text=True, cwd=self.folder, timeout=600)

    def _log(self, *arguments):
        log = self.folder / "run.log"
        done = self._call(*arguments, "--quiet", "--hash-log", log)
        if done.returncode != 0:
            raise Fault(f"troupe {arguments[0]}: exit code {done.returncode}: {done.stderr.strip()[:4000]}")
        return read_log(log)

    def _chain(self, world, end_s, check):
        tick_s = world.get("tick_s", 0.1)
        (self.folder / "run.log").unlink(missing_ok=True)
        expected = self._log("run", self.folder / "world.json", "--for", end_s, "--threads", 1)
        (self.folder / "run.log").unlink(missing_ok=True)
        source, file = ["run", self.folder / "world.json"], self.folder / "chain.h5"
        for i, tick in enumerate([*check["at"], None]):
            until = end_s if tick is None else repr(tick * tick_s)
            save = [] if tick is None else ["--checkpoint", file, "--force"]
            tile = check["tiles"][i]
            lines = self._log(*source, "--for", until, "--threads", check["threads"][i], *save,
                              *(["--tile-size", tile] if tile else []))
            source = ["resume", file]
        return check_plans.difference(expected, lines)

    def run(self, world, ticks, checks, cover=False):
        file = self.folder / "world.json"
        file.write_text(json.dumps(world, indent=1) + "\n")
        end_s = repr(ticks * world.get("tick_s", 0.1))
        told = {"failures": [], "events": [], "refused": [], "resumed": [], "ticks": ticks, "stopped": ""}
        for check in checks:
            if check["check"] == "reach" and world.get("ranging") == "grid":
                continue  # needs the exact engine
            try:
                if check["check"] == "program_checkpoints":
                    found = self._chain(world, end_s, check)
                    if found:
                        told["failures"].append({"check": check, "tick": found[0], "text": found[1]})
                    continue
                options = check_plans.options_of(check)
                done = self._call("check", file, "--for", end_s, "--threads", ",".join(map(str, check.get("threads", [1]))),
                                  "--tile-size", ",".join(str(tile) if tile else "auto" for tile in check.get("tiles", [0])), *options)
            except (Fault, subprocess.TimeoutExpired) as fault:
                told["failures"].append({"check": check, "tick": None, "text": str(fault)})
                continue
            if done.returncode == 2:
                return {"invalid": done.stderr.strip()}
            if done.returncode != 0:
                text = done.stdout[max(0, done.stdout.find("differs at")):] + done.stderr
                told["failures"].append({"check": check, "tick": None, "text": f"exit code {done.returncode}: {text.strip()[:4000]}"})
        return told

    def close(self):
        pass


class RandomProof:
    """Makes and checks random worlds, until `count` worlds have been made or `seconds` have passed (None: no limit), or until
    MOST_KEPT worlds differ. A world differs if one of its checks fails, for example because a run gives other hashes than the
    run on one thread. runner: a Library or Program; first: index of the first world; kept: folder for worlds that differ."""

    def __init__(self, runner, seed, count=None, seconds=None, controllers=False, first=0, kept=KEPT, shrink=True, say=print,
                 kinds=None, sound=None, plan=check_plans.plan, now=time.monotonic):
        self.runner, self.seed, self.count, self.seconds, self.first = runner, seed, count, seconds, first
        self.plan = plan  # what is checked, such as checks.plan()
        self.now = now  # the clock of `seconds`, in s
        self.controllers, self.kept, self.shrink, self.say = controllers, kept, shrink, say
        # If given, a runner of a program without the planted fault: worlds that fail with this program too are not counted.
        self.sound = sound
        self.kinds = kinds or kinds_of(runner.program)
        self.coverage = Coverage(self.kinds)
        self.made = self.valid = self.checks = self.stopped = self.differing = 0
        self.refusals, self.invalid, self.failed = Counter(), Counter(), []
        (runner.folder / PLAN).write_bytes(plan_image())

    def run(self, stop_at_first=False):
        """Runs the proof, and returns one text for each error found. stop_at_first: stop after the first world that differs."""
        pairs, start = pairs_of(self.kinds), self.now()
        begun = shown = time.monotonic()
        while (self.count is None or self.made < self.count) and (self.seconds is None or self.now() - start < self.seconds):
            index = self.first + self.made
            self.made += 1
            world, ticks, focus = make_world(self.kinds, self.seed, index, pairs)
            checks = self.plan(self.seed, index, ticks, self.runner.program_only, self.controllers)
            told = self.runner.run(world, ticks, checks, cover=True)
            if "invalid" in told:
                self.invalid[told["invalid"].splitlines()[0].split(": ", 1)[-1][:160]] += 1
                continue
            self.valid += 1
            self.checks += len(checks)
            self.stopped += bool(told["stopped"])
            self.refusals.update(told["refused"])
            self.coverage.add(world, told)
            failures = told["failures"]
            if failures and self.sound is not None:
                failures = [] if self.sound.run(world, ticks, [failures[0]["check"]])["failures"] else failures
            if failures:
                self._found(index, world, ticks, failures)
                if stop_at_first:
                    break
            if self.differing >= MOST_KEPT:
                self.failed.append(f"random worlds: stopped after {MOST_KEPT} worlds that differ")
                break
            if time.monotonic() - shown > 60:
                shown = time.monotonic()
                self.say(f"  random worlds: {self.made} made, {self.differing} of them differ, {clock(shown - begun)} minutes "
                         "passed")
        self.took_s = self.now() - start
        if self.made >= 20 and self.valid < LEAST_VALID * self.made:
            self.failed.append(f"random worlds: only {self.valid} of {self.made} could be loaded; the most frequent errors: "
                               + "; ".join(text for text, _ in self.invalid.most_common(5)))
        if self.count is not None and self.count >= COMPLETE_AT and not self.runner.program_only:
            missing = self.coverage.missing()
            if missing:
                self.failed.append(f"random worlds: these kinds or events never occurred: {', '.join(missing)}")
        return self.failed

    def report(self):
        """Yields lines with the number of worlds, the seed, and what occurred in the worlds. Call it after run()."""
        yield (f"random worlds: {self.made} of seed {self.seed}"
               f"{f', from world {self.first} on' if self.first else ''}; {self.valid} could be loaded "
               f"({100 * self.valid / max(1, self.made):.1f} %), with {self.checks} checks; {self.differing} worlds differ; "
               f"{clock(self.took_s)} minutes")
        if not self.runner.program_only:
            missing = self.coverage.missing()
            yield f"  occurred: {self.coverage.summary()}" + (f"; missing: {', '.join(missing[:12])}"
                                                              f"{' ...' if len(missing) > 12 else ''}" if missing else "")
        for text, times in self.invalid.most_common(5):
            yield f"  could not be loaded ({times} x): {text}"

    def _found(self, index, world, ticks, failures):
        """Writes a world that differs into a folder in `kept`, shrunk for the first check in which it differs, and adds a text
        about the failure to `failed`."""
        self.differing += 1
        failure = failures[0]
        others = "".join(f"; also differs in the check {other['check']['check']}" for other in failures[1:])
        folder = self.kept / f"{self.seed}-{index}-{failure['check']['check']}"
        shutil.rmtree(folder, ignore_errors=True)
        folder.mkdir(parents=True)
        (folder / PLAN).write_bytes(plan_image())
        (folder / "original.json").write_text(json.dumps(world, indent=1) + "\n")
        case = {"world": world, "ticks": ticks, "check": failure["check"]}
        trials = 0
        if self.shrink:
            self.say(f"  world {index} differs in the check {failure['check']['check']}; making the world smaller ...")
            case, trials = shrunk(self.runner, case, failure["tick"])
            again = self.runner.run(case["world"], case["ticks"], [case["check"]])
            failure = (again.get("failures") or [failure])[0]
        (folder / "world.json").write_text(json.dumps(case["world"], indent=1) + "\n")
        (folder / "case.json").write_text(json.dumps({"ticks": case["ticks"], "check": case["check"],
                                                      "found": failure["text"]}, indent=1) + "\n")
        where = folder.relative_to(ROOT) if folder.is_relative_to(ROOT) else folder
        command = f"scripts/prove --random-again {shlex.quote(str(where))}"
        text = (f"random world {index} of seed {self.seed}, check {json.dumps(failure['check'])}: {failure['text']}{others}\n"
                f"  smallest world found that differs, after {trials} trials: {where}/world.json, {case['ticks']} ticks; to "
                f"check it again: {command}")
        self.say(text)
        self.failed.append(text)


def is_same(failure, check):
    return failure["check"]["check"] == check["check"]


def shrunk(runner, case, tick=None):
    """Makes a failing case smaller with a Shrinker. Returns the smaller case and the number of trials. case: a dict with the
    world, the number of ticks and the check that fails; these ticks and the ticks of checkpoints are reduced too. tick: the
    tick of the first difference, or None."""

    def fails(document):
        if set(document) != set(case) or document["ticks"] < 1 or "check" not in document["check"]:
            return False
        check = document["check"]
        if check["check"] != case["check"]["check"] or set(check) != set(case["check"]):
            return False
        marks = check.get("at")
        if isinstance(marks, list):
            if marks != sorted(set(marks)) or any(not 0 <= mark <= document["ticks"] for mark in marks):
                return False
            if len(check["threads"]) <= len(marks) or len(check["tiles"]) <= len(marks):
                return False
        threads = check.get("threads", 1)
        if any(n < 1 for n in (threads if isinstance(threads, list) else [threads])) or check.get("of", 1) < 1 or not threads:
            return False
        if check["check"] == "tables" and check["ranks"] < 1:
            return False
        told = runner.run(document["world"], document["ticks"], [check])
        return any(is_same(failure, check) for failure in told.get("failures", ()))

    shrinker = Shrinker(fails)
    for ticks in (tick, tick + 1) if tick else ():  # stop at the first difference
        cut = {**case, "ticks": ticks}
        if fails(cut):
            case = cut
            break
    return shrinker.shrunk(case), shrinker.trials


def again(runner, folder, say=print):
    """Runs the check of a world that RandomProof has kept in `folder` again; returns whether it still differs. Raises Fault if
    the folder has no such case or the world cannot be loaded."""
    folder = pathlib.Path(folder)
    try:
        case = json.loads((folder / "case.json").read_text())
        world = json.loads((folder / "world.json").read_text())
    except (OSError, ValueError) as error:
        raise Fault(f"{folder}: expected a folder in which scripts/prove has kept a random world (case.json and world.json): "
                    f"{error}")
    (runner.folder / PLAN).write_bytes(plan_image())
    told = runner.run(world, case["ticks"], [case["check"]])
    if "invalid" in told:
        raise Fault(f"{folder}/world.json: {told['invalid']}")
    for failure in told["failures"]:
        say(failure["text"])
    say(f"{json.dumps(case['check'])}: {'DIFFERS' if told['failures'] else 'same bits'}")
    return bool(told["failures"])
