#!/usr/bin/env python3
"""One world on several processes, with the real launchers of Open MPI and MPICH (docs/cluster.md).

    mpi_test.py PROGRAM [TEST...]    PROGRAM: the program `troupe`, in the folder of its modules for MPI

Without TEST, the tests of both MPIs run at the same time, because they mostly wait for launchers. Exits with 77 if neither
MPI can be tested here.
"""

import contextlib
import json
import os
import pathlib
import re
import shutil
import signal
import subprocess
import sys
import tempfile
import threading
import time
import unittest

ROOT = pathlib.Path(__file__).resolve().parent.parent
sys.path.insert(0, str(ROOT))
from tests.support.websocket import Socket  # noqa: E402

PROGRAM = None
WAIT_S = 240  # for a busy machine
WORLDS = ROOT / "worlds"

WORLD = """{
  "troupe": 1, "title": "A room", "quit_time_s": 3,
  "types": {
    "wall": {"size_m": [0.2, 6.5, 1]},
    "wanderer": {"size_m": [0.31, 0.17, 0.2], "drive": {"kind": "diff", "localization": "odom"},
      "controller": {"kind": "wander"}, "sensors": [
        {"name": "eyes", "kind": "ranger", "pose": {"z_m": 0.1},
         "transducers": [{"range_max_m": 3.3, "fov_deg": 170.5, "samples": 9}]}]}
  },
  "models": [{"name": "wall", "type": "wall", "pose": {"x_m": 3.7, "heading_deg": 0.7}}],
  "populations": [{"name": "w", "type": "wanderer", "count": 40,
                   "place": {"rule": "uniform", "region_m": [[-3.3, -3.3], [3.3, 3.3]]}}]
}
"""


def lines_of(log):
    return [line for line in log.read_text().splitlines() if not line.startswith("#")]


class OnProcesses:
    """The tests of one MPI."""

    mpi = None
    launcher_options = ()

    @classmethod
    def setUpClass(cls):
        cls.launcher = shutil.which(f"mpirun.{cls.mpi}")
        module = pathlib.Path(PROGRAM).parent / f"libtroupe_mpi_{cls.mpi}.so"
        if cls.launcher is None or not module.exists():
            raise unittest.SkipTest(f"NOT TESTED: {cls.mpi}: its mpirun or {module} is missing (scripts/setup --mpi)")

    def setUp(self):
        scratch = tempfile.TemporaryDirectory()
        self.addCleanup(scratch.cleanup)
        self.folder = pathlib.Path(scratch.name)
        (self.folder / "room.json").write_text(WORLD)

    def environment(self, **more):
        own = {name: value for name, value in os.environ.items()
               if not name.startswith(("OMPI_", "PMI", "SLURM_", "TROUPE_"))}
        return {**own, "OMPI_ALLOW_RUN_AS_ROOT": "1", "OMPI_ALLOW_RUN_AS_ROOT_CONFIRM": "1", **more}

    def command(self, ranks, *arguments):
        return [self.launcher, *self.launcher_options, "-n", str(ranks), PROGRAM, *map(str, arguments)]

    def call(self, command, **environment):
        return subprocess.run(command, capture_output=True, text=True, cwd=self.folder, timeout=300,
                              env=self.environment(**environment))

    def run_on(self, ranks, *arguments, **environment):
        return self.call(self.command(ranks, *arguments), **environment)

    def plain(self, *arguments):
        done = self.call([PROGRAM, *map(str, arguments)])
        self.assertEqual(done.returncode, 0, done.stderr)

    def expected(self):
        self.plain("run", "room.json", "--threads", 1, "--hash-log", "plain.log", "--quiet")
        return lines_of(self.folder / "plain.log")

    def test_any_number_of_processes_gives_the_same_bits(self):
        expected = self.expected()
        self.assertEqual(len(expected), 31)
        for ranks in (1, 2, 3, 4):
            done = self.run_on(ranks, "run", "room.json", "--threads", 1, "--hash-log", "log", "--quiet")
            self.assertEqual((done.returncode, done.stdout), (0, ""), done.stderr)
            self.assertEqual(lines_of(self.folder / "log"), expected, f"{ranks} processes")

    def test_distributed_robots_have_the_same_bits(self):
        self.plain("run", "room.json", "--threads", 1, "--hash-log", "plain.log", "--record", "plain.h5", "--quiet")
        expected = lines_of(self.folder / "plain.log")
        for ranks in (2, 3, 4):
            with self.subTest(ranks=ranks):
                done = self.run_on(ranks, "run", "room.json", "--threads", 1, "--distribute", "--tile-size", 1, "--hash-log",
                                   "distributed.log", "--json")
                self.assertEqual(done.returncode, 0, done.stderr)
                self.assertEqual(lines_of(self.folder / "distributed.log"), expected)
                summary = json.loads(done.stdout)
                self.assertEqual(summary["rank_form"], "distributed")
                self.assertGreater(summary["rank_distributions"], 0)
        done = self.run_on(3, "run", "room.json", "--threads", 1, "--distribute", "--tile-size", 1, "--rank-seed", 5, "--record",
                           "distributed.h5", "--checkpoint", "state.h5", "--quiet")
        self.assertEqual(done.returncode, 0, done.stderr)
        self.plain("diff", "plain.h5", "distributed.h5")
        done = self.run_on(2, "resume", "state.h5", "--for", 4, "--distribute", "--hash-log", "resumed.log", "--quiet")
        self.assertEqual(done.returncode, 0, done.stderr)
        self.plain("run", "room.json", "--for", 4, "--hash-log", "longer.log", "--quiet")
        self.assertEqual(lines_of(self.folder / "resumed.log")[-1], lines_of(self.folder / "longer.log")[-1])

    def expect_same_bits_on_distributed_ranks(self, world):
        (self.folder / "world.json").write_text(json.dumps(world))
        self.plain("run", "world.json", "--threads", 1, "--hash-log", "plain.log", "--quiet")
        for ranks in (2, 3):
            done = self.run_on(ranks, "run", "world.json", "--threads", 1, "--distribute", "--tile-size", 1, "--hash-log",
                               "distributed.log", "--json")
            self.assertEqual(done.returncode, 0, done.stderr)
            self.assertEqual(json.loads(done.stdout)["rank_form"], "distributed")
            self.assertEqual(lines_of(self.folder / "distributed.log"), lines_of(self.folder / "plain.log"))

    def test_births_and_deaths_have_the_same_bits_on_distributed_ranks(self):
        world = json.loads(WORLD)
        world["types"]["wanderer"]["devices"] = [{"name": "pack", "kind": "power_pack", "capacity_J": 40, "mass_kg": 1, "when_empty": "die"}]
        world["types"]["door"] = {"size_m": [0.2, 0.2, 0.01], "obstacle": False, "ranger_return": -1, "devices": [
            {"name": "spawner", "kind": "spawner", "population": "w", "every_s": 0.2, "within_m": 0.5}]}
        world["populations"][0]["reserve"] = 40
        world["populations"].append({"name": "d", "type": "door", "count": 4,
                                     "place": {"rule": "grid", "region_m": [[-2, -2], [2, 2]], "pitch_m": 4}})
        world["at"] = [{"time_s": 1, "add": {"population": "w", "count": 5, "region_m": [[-3, -3], [3, 3]]}},
                       {"time_s": 2, "remove": {"population": "w", "share": 0.2}}]
        self.expect_same_bits_on_distributed_ranks(world)

    def test_pushed_bodies_have_the_same_bits_on_distributed_ranks(self):
        world = json.loads(WORLD)
        world["types"]["wanderer"]["drive"]["pushes"] = 2
        world["types"]["puck"] = {"size_m": [0.1, 0.1, 0.05], "pushable": True}
        world["populations"].append({"name": "p", "type": "puck", "count": 200,
                                     "place": {"rule": "uniform", "region_m": [[-4, -4], [4, 4]]}})
        self.expect_same_bits_on_distributed_ranks(world)

    def test_a_world_that_cannot_be_distributed_is_replicated(self):
        world = json.loads(WORLD)
        world["ranging"] = "grid"
        (self.folder / "grid.json").write_text(json.dumps(world))
        done = self.run_on(2, "run", "grid.json", "--for", 0.5, "--distribute", "--json")
        self.assertEqual(done.returncode, 0, done.stderr)
        summary = json.loads(done.stdout)
        self.assertEqual((summary["rank_form"], summary["why_replicated"]), ("replicated", "the world uses the grid ray engine"))

    def test_only_rank_0_prints(self):
        done = self.run_on(3, "run", "room.json", "--threads", 1)
        self.assertEqual(done.returncode, 0, done.stderr)
        self.assertEqual(done.stdout.count("running\n"), 1)
        self.assertIn("\n  ranks              3\n", done.stdout)
        self.assertNotIn("rank_seed", done.stdout)

    def test_the_seed_of_random_delays_is_printed(self):
        line = "\n  rank_seed          7 (random d"
        done = self.run_on(2, "run", "room.json", "--threads", 1, "--rank-seed", 7)
        self.assertIn(line + "ivision of the robots)\n", done.stdout, done.stderr)
        for ranks, count in ((1, 0), (2, 1)):
            done = self.call([PROGRAM, "run", "room.json", "--ranks", str(ranks), "--rank-seed", "7"])
            self.assertEqual(done.stdout.count(line + "elays and order of messages, random division of the robots)\n"), count)

    def test_other_numbers_of_processes_resume(self):
        expected = self.expected()
        done = self.run_on(3, "run", "room.json", "--threads", 1, "--for", 1, "--checkpoint", "run.h5", "--quiet")
        self.assertEqual(done.returncode, 0, done.stderr)
        for ranks in (2, 4):
            done = self.run_on(ranks, "resume", "run.h5", "--threads", 1, "--hash-log", f"{ranks}.log", "--quiet")
            self.assertEqual(done.returncode, 0, done.stderr)
            self.assertEqual(lines_of(self.folder / f"{ranks}.log"), expected[10:])
        self.plain("resume", "run.h5", "--threads", 2, "--hash-log", "one.log", "--quiet")
        self.assertEqual(lines_of(self.folder / "one.log"), expected[10:])

    def test_check_compares_with_one_process(self):
        done = self.run_on(3, "check", "room.json", "--for", 1, "--threads", "1,2", "--tile-size", "auto")
        self.assertEqual(done.returncode, 0, done.stdout + done.stderr)
        self.assertIn("division of the robots among the processes: --rank-seed 1 repeats it\n", done.stdout)
        self.assertEqual(done.stdout.count("same bits"), 4)
        self.assertEqual(done.stdout.count("all processes"), 2)

    def test_ranks_may_have_different_instruction_sets(self):
        expected = self.expected()
        arguments = ["run", "room.json", "--threads", "1", "--hash-log", "log", "--quiet"]
        command = [self.launcher, *self.launcher_options, "-n", "1", "env", "TROUPE_SIMD=scalar", PROGRAM, *arguments,
                   ":", "-n", "2", PROGRAM, *arguments]
        done = self.call(command)
        self.assertEqual(done.returncode, 0, done.stderr)
        self.assertEqual(lines_of(self.folder / "log"), expected)

    def test_all_outputs_are_those_of_one_process(self):
        def outputs(name):
            (self.folder / name).mkdir()
            return ["run", WORLDS / "failures.json", "--threads", 1, "--for", 1, "--quiet", "--measures", f"{name}/measures.csv",
                    "--measure-every", 0.1, "--events", f"{name}/events.csv", "--record", f"{name}/run.h5", "--record-every", 0.1,
                    "--record-fields", "all", "--snapshot", f"{name}/last.png", "--film", f"{name}/%06d.png", "--fps", 5,
                    "--size", "160x90", "--layers", "scans,trails,coverage,density,names,energy"]

        self.plain(*outputs("one"))
        done = self.run_on(3, *outputs("three"))
        self.assertEqual((done.returncode, done.stdout), (0, ""), done.stderr)
        files = sorted(file.name for file in (self.folder / "one").iterdir())
        self.assertEqual(files, sorted(file.name for file in (self.folder / "three").iterdir()))
        self.assertEqual(len(files), 4 + 6)
        for file in files:
            if file != "run.h5":
                self.assertEqual((self.folder / "three" / file).read_bytes(), (self.folder / "one" / file).read_bytes(), file)
        self.plain("diff", "one/run.h5", "three/run.h5")

    def threads_of(self, done):
        self.assertEqual(done.returncode, 0, done.stderr)
        return json.loads(done.stdout)["threads"]

    def test_the_threads_are_those_of_slurm(self):
        processors = len(os.sched_getaffinity(0))
        done = self.run_on(2, "run", "room.json", "--for", 0.2, "--json", SLURM_CPUS_PER_TASK=str(processors))
        self.assertEqual(self.threads_of(done), processors)
        self.assertNotIn("warning", done.stderr)

    def test_more_threads_of_slurm_than_processors_are_a_warning(self):
        processors = len(os.sched_getaffinity(0))
        arguments = ["run", "room.json", "--for", 0.2, "--json"]
        done = self.run_on(2, *arguments, SLURM_CPUS_PER_TASK=str(processors + 1))
        self.assertEqual(self.threads_of(done), processors)
        self.assertRegex(done.stderr, rf"troupe: warning: SLURM_CPUS_PER_TASK is {processors + 1}, but rank 0 on \S+ may use only "
                                      rf"{processors} processors?: rank 0 computes with {processors} threads?; give srun the option "
                                      rf"-c {processors + 1}, or mpirun the option --bind-to none\n")
        self.assertEqual(done.stderr.count("warning"), 1)
        done = self.run_on(2, *arguments, "--threads", processors + 1, SLURM_CPUS_PER_TASK=str(processors + 1))
        self.assertEqual(self.threads_of(done), processors + 1)
        self.assertNotIn("warning", done.stderr)

    def test_each_rank_has_its_own_number_of_threads(self):
        if len(os.sched_getaffinity(0)) < 2:
            self.skipTest("NOT TESTED: threads of each rank: this needs two processors")

        def ranks_of(threads):
            """Starts two ranks. Returns the launcher, the processes, and a function that counts the threads of rank 1."""
            (self.folder / "log").unlink(missing_ok=True)
            arguments = [PROGRAM, "run", "room.json", "--for", "1e6", "--tile-size", "1", "--hash-log", "log", "--quiet"]
            run = self.start([self.launcher, *self.launcher_options, "-n", "1", "env", "SLURM_CPUS_PER_TASK=1", *arguments, ":",
                              "-n", "1", "env", f"SLURM_CPUS_PER_TASK={threads}", *arguments])
            self.wait_for(lambda: (self.folder / "log").exists() and len(lines_of(self.folder / "log")) > 20, run)
            ranks = self.ranks_here()
            tasks = pathlib.Path(f"/proc/{next(process for process in ranks if self.is_rank(process, 1))}/task")
            return run, ranks, lambda: len(list(tasks.iterdir()))

        run, ranks, count = ranks_of(1)
        least = count()
        self.end_all(ranks)
        run.wait(timeout=WAIT_S)
        _, _, count = ranks_of(2)
        self.wait_until(lambda: count() > least)

    def test_the_summary_describes_the_messages(self):
        ranks, ticks = 3, 30
        for where, done in (("processes", self.run_on(ranks, "run", "room.json", "--threads", 1, "--for", ticks / 10, "--json")),
                            ("threads", self.call([PROGRAM, "run", "room.json", "--ranks", str(ranks), "--threads", "1", "--for",
                                                   str(ticks / 10), "--json"]))):
            with self.subTest(where):
                self.assertEqual(done.returncode, 0, done.stderr)
                summary = json.loads(done.stdout)
                self.assertEqual((summary["ranks"], summary["nodes"], summary["ticks"]), (ranks, 1, ticks))
                messages, size = summary["rank_messages_per_tick"], summary["rank_bytes_per_tick"]
                # Each tick sends at least one message to each other rank, and to all of them alike.
                self.assertGreaterEqual(messages, ranks - 1)
                each = messages * ticks / (ranks - 1)
                self.assertAlmostEqual(each, round(each), places=6)
                # At least 24 bytes for each of the 13 or 14 robots of rank 0, to each other rank.
                self.assertGreaterEqual(size, (ranks - 1) * 24 * (40 // ranks))
                self.assertLess(size, 1e5)
                self.assertGreater(summary["rank_waited_s"], 0)
                self.assertLessEqual(summary["rank_waited_s"], summary["wall_s"])

    def test_ranks_that_share_processors_divide_them(self):
        processors = sorted(os.sched_getaffinity(0))
        if len(processors) < 3:
            self.skipTest("NOT TESTED: ranks that share a part of the processors: this needs three processors")
        shared = ",".join(map(str, processors[:2]))
        done = self.call([self.launcher, *self.launcher_options, "-n", "2", "taskset", "-c", shared, PROGRAM, "run", "room.json",
                          "--for", "0.2", "--json"])
        self.assertEqual(self.threads_of(done), 1)

    def test_a_rank_that_is_bound_to_one_core_is_a_warning(self):
        cores = len(os.sched_getaffinity(0))
        if cores < 2 or os.geteuid() != 0:
            self.skipTest("NOT TESTED: ranks bound to one core: this needs root and two processors")
        # Two hosts of one rank each: each rank could use all processors of its host.
        first = str(min(os.sched_getaffinity(0)))
        arguments = ["taskset", "-c", first, PROGRAM, "run", "room.json", "--for", "0.2", "--json"]
        command = [self.launcher, *self.launcher_options, "-n", "1", *arguments, ":",
                   "-n", "1", "unshare", "--uts", "sh", "-c", 'hostname other && exec "$@"', "sh", *arguments]
        done = self.call(command)
        self.assertEqual(self.threads_of(done), 1)
        self.assertRegex(done.stderr, r"troupe: warning: each rank may use 1 of the \d+ processors of \S+: for several threads "
                                      r"per rank, give mpirun the option --bind-to none")
        self.assertEqual(done.stderr.count("warning"), 1)

    def test_a_rank_that_throws_ends_the_run(self):
        plugins = pathlib.Path(PROGRAM).parent.parent / "plugins" / "plugins"
        if not (plugins / "thrower.so").exists():
            self.skipTest(f"NOT TESTED: a controller that throws: {plugins}/thrower.so is missing")
        (self.folder / "room.json").write_text(WORLD.replace('"wander"', '"thrower:says"'))

        def arguments(name):
            return ["run", "room.json", "--threads", 1, "--plugin-path", plugins, "--hash-log", f"{name}.log", "--events",
                    f"{name}.csv", "--record", f"{name}.h5", "--checkpoint", f"{name}-state.h5", "--quiet"]

        error = 'tick 3: controller "thrower:says" of "w3" threw: the map is missing'
        one = self.call([PROGRAM, *map(str, arguments("one"))])
        self.assertEqual((one.returncode, one.stderr), (1, f"troupe: error: {error}\n"))
        done = self.run_on(3, *arguments("three"))
        self.assertNotEqual(done.returncode, 0)
        self.assertRegex(done.stderr, rf"troupe: error: rank 0 on \S+: {error}\n")
        self.assertEqual(done.stderr.count(error), 1)
        # What is written is whole: the ticks before the error, as by one process.
        self.assertEqual(lines_of(self.folder / "three.log"), lines_of(self.folder / "one.log"))
        self.assertEqual((self.folder / "three.csv").read_text(), (self.folder / "one.csv").read_text())
        self.plain("diff", "one.h5", "three.h5")
        self.assertEqual(list(self.folder.glob("*-state.h5*")), [])

    def refused(self, done, text, code=2):
        self.assertEqual(done.returncode, code, done.stdout + done.stderr)
        self.assertEqual(done.stderr.count(text), 1, done.stderr)
        self.assertEqual([file.name for file in self.folder.iterdir()], ["room.json"])

    def test_errors_are_reported_once(self):
        (self.folder / "room.json").write_text(WORLD.replace('"wander"', '"wonder"'))
        self.refused(self.run_on(3, "run", "room.json", "--hash-log", "log"), 'unknown controller "wonder"')

    def test_a_wrong_instruction_set_is_reported_once(self):
        self.refused(self.run_on(3, "run", "room.json", TROUPE_SIMD="none"), "TROUPE_SIMD: error")

    def test_wrong_usage_is_reported_once(self):
        self.refused(self.run_on(2, "run", "room.json", "--thread", 3), 'unknown option "--thread"')

    def test_wrong_usage_of_another_rank_is_reported(self):
        command = [self.launcher, *self.launcher_options, "-n", "1", PROGRAM, "run", "room.json", "--rank-limit", "10", ":",
                   "-n", "1", PROGRAM, "run", "room.json", "--thread", "3"]
        done = self.call(command)
        self.assertNotEqual(done.returncode, 0, done.stderr)
        self.assertRegex(done.stderr, '(?m)^rank 1 on .*: .*unknown option "--thread"')

    def test_the_help_and_the_version_are_printed_once(self):
        for arguments, text in ((("--version",), "troupe "), (("run", "--help"), "Usage: "), (("--help",), "Usage: ")):
            done = self.run_on(2, *arguments)
            self.assertEqual(done.returncode, 0, done.stderr)
            self.assertEqual(sum(line.startswith(text) for line in done.stdout.splitlines()), 1, done.stdout)
        self.refused(self.run_on(2), "Usage: ")

    def test_controllers_in_python_are_refused(self):
        self.refused(self.run_on(2, "run", "room.json", "--controller", "my.py"),
                     "--controller works only in one process, but mpirun of")

    def test_controllers_in_python_are_refused_by_the_package(self):
        scratch = tempfile.TemporaryDirectory()
        self.addCleanup(scratch.cleanup)
        script = pathlib.Path(scratch.name) / "my.py"
        script.write_text("import troupe\n\n\nclass rest(troupe.Controller):\n    def decide(self, robots):\n        pass\n")
        command = [self.launcher, *self.launcher_options, "-n", "2", *self.python("import troupe"), "-m", "troupe", "run",
                   "room.json", "--controller", str(script)]
        self.refused(self.call(command), "--controller works only in one process, but mpirun of")

    def test_ranks_in_one_process_are_refused(self):
        self.refused(self.run_on(2, "run", "room.json", "--ranks", 2), "leave out --ranks")
        self.refused(self.run_on(2, "check", "room.json", "--ranks", "1,3"), "leave out --ranks")
        self.refused(self.run_on(2, "run", "room.json", "--ranks", 1), "leave out --ranks")
        self.refused(self.run_on(2, "check", "room.json", "--ranks", 1), "leave out --ranks")
        for ranks in (0, 1025):
            self.refused(self.run_on(2, "run", "room.json", "--ranks", ranks), "is not a number of ranks from 1 to 1024")

    def test_commands_of_one_process_are_refused(self):
        self.refused(self.run_on(2, "info", "room.json"), "this command uses only one: start it without the launcher")

    def test_too_many_processes_are_refused(self):
        # Only the environment of rank 0 of such a launcher: no other process is needed for the error.
        variables = {"openmpi": ("OMPI_COMM_WORLD_RANK", "OMPI_COMM_WORLD_SIZE"), "mpich": ("PMI_RANK", "PMI_SIZE")}[self.mpi]
        (self.folder / "study.json").write_text("{}")
        for arguments in (["run", "room.json"], ["check", "room.json"], ["sweep", "study.json", "-o", "results"]):
            done = self.call([PROGRAM, *arguments], **dict(zip(variables, ("0", "1025"))))
            self.assertEqual(done.returncode, 2, done.stderr)
            self.assertIn("started 1025 processes, but at most 1024 are allowed", done.stderr)
            self.assertEqual(sorted(file.name for file in self.folder.iterdir()), ["room.json", "study.json"])

    def test_a_view_is_refused(self):
        for arguments in (["run", "room.json", "--view"], ["view", "room.json"]):
            done = self.run_on(2, *arguments)
            self.assertEqual(done.returncode, 2, done.stdout + done.stderr)
            self.assertEqual(done.stderr.count("without the launcher"), 1, done.stderr)

    def serves_a_view_in_each_process(self, *program):
        """Starts two processes of a program that runs a view (served_view.cpp, served_view.py), and opens the page of each."""
        self.plain("run", "room.json", "--threads", 1, "--for", 1, "--hash-log", "plain.log", "--quiet")
        state = lines_of(self.folder / "plain.log")[-1].split()[1]
        run = subprocess.Popen([self.launcher, *self.launcher_options, "-n", "2", *map(str, program), "room.json"], cwd=self.folder,
                               env=self.environment(), text=True, stdout=subprocess.PIPE, stderr=subprocess.PIPE)
        limit = threading.Timer(WAIT_S, run.kill)
        limit.start()
        with run, contextlib.ExitStack() as viewers:
            viewers.callback(limit.cancel)
            printed = {"error": [], "view": [], "hash": []}
            for line in run.stdout:
                what, _, text = line.rstrip("\n").partition(" ")
                printed[what].append(text)
                if what == "view":
                    port, token = text.removeprefix("http://127.0.0.1:").split("/#")
                    viewers.enter_context(Socket(int(port))).send(token)
            errors = run.stderr.read()
            self.assertEqual(run.wait(), 0, errors)
        self.assertEqual(len(set(printed["view"])), 2, errors)
        self.assertEqual(printed["hash"], [state, state], errors)
        for error in printed["error"]:
            self.assertRegex(error, r"^2 ranks: the ranks of a program are threads of one process, but mpirun of .* started 2 processes: ")
        self.assertEqual(len(printed["error"]), 2)
        self.assertEqual(sorted(file.name for file in self.folder.glob("*session*")), ["room.session-2.jsonl", "room.session.jsonl"])

    def test_each_process_of_a_program_serves_its_own_view(self):
        program = pathlib.Path(PROGRAM).parent / "served_view"
        if not program.exists():
            self.skipTest(f"NOT TESTED: views of programs in C++: {program} is missing; it needs TROUPE_VIEW")
        self.serves_a_view_in_each_process(program)

    def python(self, test):
        """Returns a command of Python with the package, after which `test` raises no exception. Skips if there is none."""
        package = pathlib.Path(PROGRAM).parent.parent / "lib" / "python3" / "dist-packages"
        for interpreter in (sys.executable, "/usr/bin/python3"):
            path = {"PYTHONPATH": str(package)}
            if package.exists() and self.call([interpreter, "-c", test], **path).returncode == 0:
                return ["env", f"PYTHONPATH={package}", interpreter]
        self.skipTest(f"NOT TESTED: programs in Python: no interpreter can load the package in {package}")

    def test_each_process_of_a_program_in_python_serves_its_own_view(self):
        self.serves_a_view_in_each_process(*self.python("import troupe; troupe.Simulation.view"),
                                           pathlib.Path(__file__).with_name("served_view.py"))

    def test_a_missing_module_is_an_error(self):
        self.refused(self.run_on(3, "run", "room.json", "--hash-log", "log", TROUPE_MPI="none"),
                     "there is no module libtroupe_mpi_none.so")

    def test_an_error_of_one_computer_is_reported(self):
        first_there = {"openmpi": "OMPI_COMM_WORLD_LOCAL_RANK=0", "mpich": "MPI_LOCALRANKID=0"}[self.mpi]
        arguments = [PROGRAM, "run", "room.json", "--rank-limit", "10"]
        for environment, more, error in (("TROUPE_MPI=none", [], "troupe: error: .* there is no module libtroupe_mpi_none\\.so"),
                                         ("TROUPE_MPI=", ["--simd", "none"], "troupe run: error: --simd: .*none")):
            done = self.call([self.launcher, *self.launcher_options, "-n", "1", *arguments, ":",
                              "-n", "1", "env", environment, first_there, *arguments, *more])
            self.assertNotEqual(done.returncode, 0, done.stderr)
            self.assertRegex(done.stderr, f"(?m)^rank 1 on .*: {error}")

    def test_a_world_of_one_under_a_launcher_of_three_is_an_error(self):
        other = {"openmpi": "mpich", "mpich": "openmpi"}[self.mpi]
        if not (pathlib.Path(PROGRAM).parent / f"libtroupe_mpi_{other}.so").exists():
            self.skipTest(f"NOT TESTED: there is no module of {other}")
        done = self.run_on(3, "run", "room.json", "--hash-log", "log", TROUPE_MPI=other)
        self.refused(done, "this module belongs to another MPI")

    def test_other_arguments_are_an_error(self):
        command = [self.launcher, *self.launcher_options, "-n", "1", PROGRAM, "run", "room.json", "--seed", "1", ":",
                   "-n", "1", PROGRAM, "run", "room.json", "--seed", "2"]
        self.refused(self.call(command), "give all ranks the same arguments")

    def test_another_build_or_version_is_an_error(self):
        module = pathlib.Path(PROGRAM).parent / f"libtroupe_mpi_{self.mpi}.so"
        version = self.call([PROGRAM, "--version"]).stdout.split()[1].encode()
        program = pathlib.Path(PROGRAM).read_bytes()
        later = version[:-1] + b"9"
        for other, text in ((program + b"another build", f"runs another build of troupe {version.decode()} "),
                            (program.replace(version, later), f"runs troupe {later.decode()} ")):
            with tempfile.TemporaryDirectory() as name:
                file = pathlib.Path(name) / "troupe"
                file.write_bytes(other)
                file.chmod(0o755)
                command = [self.launcher, *self.launcher_options, "-n", "1", PROGRAM, "run", "room.json", ":",
                           "-n", "1", str(file), "run", "room.json"]
                self.refused(self.call(command, TROUPE_MPI=str(module)), text)

    def test_other_plugins_are_an_error(self):
        plugins = pathlib.Path(PROGRAM).parent.parent / "plugins"
        if not (plugins / "other" / "walker.so").exists() or os.geteuid() != 0:
            self.skipTest("NOT TESTED: other plug-ins: this needs root and the plug-ins of the tests")
        (self.folder / "room.json").write_text(WORLD.replace('"wander"', '"walker"'))
        with tempfile.TemporaryDirectory() as name:
            arguments = [PROGRAM, "run", "room.json", "--plugin-path", name]
            own = ["unshare", "--mount", "sh", "-c", 'mount --bind "$0" "$1" && shift && exec "$@"']
            command = [self.launcher, *self.launcher_options, "-n", "1", *own, str(plugins / "plugins"), name, *arguments, ":",
                       "-n", "1", *own, str(plugins / "other"), name, *arguments]
            self.refused(self.call(command), 'is another build of plug-in "walker" than that of rank 0')

    def test_processes_share_a_study(self):
        self.write_study(for_s=1, count=4)
        self.plain("sweep", "study.json", "-o", "one", "--quiet")
        done = self.run_on(3, "sweep", "study.json", "-o", "three", "--threads", 1, "--quiet")
        self.assertEqual((done.returncode, done.stdout), (0, ""), done.stderr)
        self.assertEqual((self.folder / "three" / "table.csv").read_text(), (self.folder / "one" / "table.csv").read_text())
        self.assertEqual(len(list((self.folder / "three").glob("runs-*-of-3.jsonl"))), 3)

    def test_another_number_of_processes_continues_a_study(self):
        self.write_study(for_s=1000, count=20)
        results = self.folder / "parts"
        runs = lambda: sum(len(file.read_text().splitlines()) for file in results.glob("runs-*.jsonl"))
        sweep = self.start(self.command(3, "sweep", "study.json", "-o", "parts", "--threads", 1, "--quiet"))
        self.wait_for(lambda: runs() >= 4, sweep)
        for process in self.ranks_here():
            self.end(process)
        sweep.wait(timeout=WAIT_S)
        done = runs()
        self.assertLess(done, 40)
        self.assertFalse((results / "table.csv").exists())
        again = self.run_on(2, "sweep", "study.json", "-o", "parts", "--threads", 1)
        self.assertEqual(again.returncode, 0, again.stderr)
        self.plain("sweep", "study.json", "-o", "one", "--quiet")
        self.assertEqual((results / "table.csv").read_text(), (self.folder / "one" / "table.csv").read_text())
        self.assertGreaterEqual(done, 4)

    def test_a_wrong_study_is_reported_once(self):
        done = self.run_on(3, "sweep", "room.json", "-o", "results")
        self.assertEqual(done.returncode, 2, done.stderr)
        self.assertEqual(done.stderr.count("this is a world, not a study"), 1, done.stderr)

    def test_an_error_of_one_process_ends_a_study(self):
        plugins = pathlib.Path(PROGRAM).parent.parent / "plugins" / "plugins"
        if not (plugins / "walker.so").exists() or os.geteuid() != 0:
            self.skipTest("NOT TESTED: a plug-in that one process lacks: this needs root and the plug-ins of the tests")
        (self.folder / "room.json").write_text(WORLD.replace('"wander"', '"walker"'))
        self.write_study(for_s=1, count=4)
        arguments = [PROGRAM, "sweep", "study.json", "-o", "results", "--plugin-path", str(plugins), "--quiet"]
        command = [self.launcher, *self.launcher_options, "-n", "1", *arguments, ":", "-n", "1", "unshare", "--mount", "sh", "-c",
                   'mount -t tmpfs none "$0" && exec "$@"', str(plugins), *arguments]
        done = self.call(command)
        self.assertNotEqual(done.returncode, 0)
        self.assertRegex(done.stderr, r"troupe: error: rank 1 on \S+: .*walker")
        self.assertFalse((self.folder / "results" / "table.csv").exists())

    def sweep_of_two(self, mount):
        """Runs a study of eight runs on two processes. On rank 1, the command `mount` changes the files first."""
        if os.geteuid() != 0:
            self.skipTest("NOT TESTED: other files on one of two processes: this needs root")
        self.write_study(for_s=1, count=4)
        arguments = [PROGRAM, "sweep", "study.json", "-o", "results", "--threads", "1", "--quiet"]
        done = self.call([self.launcher, *self.launcher_options, "-n", "1", *arguments, ":", "-n", "1", "unshare", "--mount", "sh", "-c",
                          mount + ' && exec "$@"', "sh", *arguments])
        self.assertNotEqual(done.returncode, 0)
        self.assertFalse((self.folder / "results" / "table.csv").exists())
        return done.stderr

    def test_files_of_a_study_that_differ_between_processes_are_an_error(self):
        (self.folder / "other.json").write_text(WORLD.replace("0.31", "0.35"))
        errors = self.sweep_of_two("mount --bind other.json room.json")
        self.assertRegex(errors, r"rank 1 on \S+: study\.json: error: this study, its world, or an image, plug-in or script of it "
                                 r"differs from that of rank 0: give all processes the same files\n")

    def test_a_folder_that_the_processes_do_not_share_is_an_error(self):
        (self.folder / "results").mkdir()
        errors = self.sweep_of_two("mount -t tmpfs none results")
        self.assertIn("results: error: the results of 4 finished runs are missing, so there is no table: either this folder is not "
                      "on a file system that all processes share, or another program has removed or replaced files", errors)

    def test_a_process_that_does_not_answer_ends_a_study(self):
        self.write_study(for_s=1e7, count=2)
        sweep = self.start(self.command(3, "sweep", "study.json", "-o", "parts", "--threads", 1, "--rank-limit", 4, "--quiet"))
        self.wait_for(lambda: len(list((self.folder / "parts").glob("runs-*-of-3.jsonl"))) == 3, sweep)
        ranks = self.ranks_here()
        # The runs take longer than the limit, but processes at work are not waited for in vain.
        time.sleep(6)
        self.assertIsNone(sweep.poll())
        self.assertEqual(self.ranks_here(), ranks)
        for rank in (1, 2):
            os.kill(next(process for process in ranks if self.is_rank(process, rank)), signal.SIGSTOP)
        self.addCleanup(self.end_all, ranks)
        # Rank 0 ends its own runs first: it must not wait for the others without end.
        os.kill(next(process for process in ranks if self.is_rank(process, 0)), signal.SIGTERM)
        self.assertNotEqual(sweep.wait(timeout=WAIT_S), 0)
        self.assertRegex(sweep.stderr.read(), r"rank 0 on \S+: waited 4 s for rank 1 on \S+, which does not answer")
        self.assertFalse((self.folder / "parts" / "table.csv").exists())

    def write_study(self, for_s, count):
        study = {"troupe_study": 1, "world": "room.json", "for_s": for_s, "measures": ["stalls"],
                 "parameters": [{"set": "/populations/0/count", "name": "robots", "values": [5, 10]}],
                 "seeds": {"from": 1, "count": count}}
        (self.folder / "study.json").write_text(json.dumps(study))

    def wait_for(self, condition, run):
        """Waits until a condition holds, or until a run of self.start() has ended, which is an error."""
        end = time.monotonic() + WAIT_S
        while not condition() and time.monotonic() < end and run.poll() is None:
            time.sleep(0.05)
        if not condition():
            ended = run.poll()
            self.end_all([*self.ranks_here(), run.pid])
            self.fail(f"the run {'goes on' if ended is None else f'ended with {ended}'}\n{run.stderr.read()}")

    def wait_until(self, condition):
        end = time.monotonic() + WAIT_S
        while not condition() and time.monotonic() < end:
            time.sleep(0.05)
        self.assertTrue(condition())

    def start(self, command):
        run = subprocess.Popen(command, cwd=self.folder, env=self.environment(), text=True, stdout=subprocess.DEVNULL,
                               stderr=subprocess.PIPE)
        self.addCleanup(run.stderr.close)
        self.addCleanup(run.wait)
        self.addCleanup(lambda: self.end_all([*self.ranks_here(), run.pid]))
        return run

    def started(self, *arguments, first="run.h5"):
        """Starts a run on three processes that does not end by itself, and waits until the file `first` exists. Returns the
        launcher and the processes of the ranks."""
        run = self.start(self.command(3, "run", "room.json", "--threads", 1, "--for", 1e6, "--checkpoint", "run.h5", "--quiet",
                                      *arguments))
        self.wait_for((self.folder / first).exists, run)
        ranks = self.ranks_here()
        self.assertEqual(len(ranks), 3)
        return run, ranks

    def ranks_here(self):
        """Returns the processes of this test that run the program."""
        ranks = []
        for process in pathlib.Path("/proc").iterdir():
            try:
                if not process.name.isdigit() or os.readlink(process / "exe") != os.path.realpath(PROGRAM):
                    continue
                if os.readlink(process / "cwd") == str(self.folder.resolve()):
                    ranks.append(int(process.name))
            except OSError:
                continue
        return sorted(ranks)

    @staticmethod
    def end(process):
        with contextlib.suppress(ProcessLookupError):
            os.kill(process, signal.SIGKILL)

    def end_all(self, processes):
        for process in processes:
            self.end(process)

    def is_rank(self, process, rank):
        words = pathlib.Path(f"/proc/{process}/environ").read_bytes().split(b"\0")
        return any(word in words for word in (b"OMPI_COMM_WORLD_RANK=%d" % rank, b"PMI_RANK=%d" % rank))

    def test_a_rank_that_dies_ends_the_run(self):
        run, ranks = self.started("--checkpoint-every", 1)
        os.kill(next(process for process in ranks if self.is_rank(process, 2)), signal.SIGKILL)
        self.assertNotEqual(run.wait(timeout=WAIT_S), 0)
        self.wait_until(lambda: self.ranks_here() == [])  # no process goes on, nor waits
        # The last checkpoint is complete, and can be resumed with another number of ranks.
        done = self.run_on(2, "resume", "run.h5", "--for", 1e6, "--wall-limit", 1, "--quiet")
        self.assertEqual(done.returncode, 3, done.stderr)

    def test_a_rank_that_does_not_answer_ends_the_run(self):
        run, ranks = self.started("--checkpoint-every", 1, "--rank-limit", 5)
        os.kill(next(process for process in ranks if self.is_rank(process, 2)), signal.SIGSTOP)
        self.assertNotEqual(run.wait(timeout=WAIT_S), 0)
        errors = run.stderr.read()
        # Rank 1 may wait for rank 0, which waits for rank 2; either limit may end first. Open MPI's mpirun lets rank 2 go on
        # when it ends the run, so rank 2 may print too.
        self.assertRegex(errors, r"rank [01] on \S+: waited 5 s for rank 2 on \S+, which does not answer")
        self.assertNotIn("internal error", errors)

    def test_all_ranks_that_wait_are_heard(self):
        run, ranks = self.started("--hash-log", "log", "--rank-limit", 4, first="log")
        of_rank = {rank: next(process for process in ranks if self.is_rank(process, rank)) for rank in range(3)}
        ticks = lambda: len(lines_of(self.folder / "log"))
        self.wait_for(lambda: ticks() > 5, run)
        os.kill(of_rank[2], signal.SIGSTOP)
        self.wait_until(lambda: [ticks(), time.sleep(1)][0] == ticks())  # rank 0 waits for rank 2
        # The limit of rank 1 runs out first. Rank 0 still has the time to print for whom it waits.
        os.kill(of_rank[0], signal.SIGSTOP)
        errors = run.stderr.readline()
        self.assertRegex(errors, r"rank 1 on \S+: waited 4 s for rank [02] on ")
        os.kill(of_rank[0], signal.SIGCONT)
        self.assertNotEqual(run.wait(timeout=WAIT_S), 0)
        # Rank 0 may wait for rank 1, which waits for rank 2.
        self.assertRegex(run.stderr.read(), r"rank 0 on \S+: waited 4 s for rank [12] on \S+, which does not answer")

    def test_usr1_at_any_process_saves_the_state(self):
        expected = self.expected()
        saved = self.folder / "run.h5"
        for rank in (0, 2):
            saved.unlink(missing_ok=True)
            (self.folder / "log").unlink(missing_ok=True)
            run, ranks = self.started("--hash-log", "log", first="log")
            ticks = lambda: len(lines_of(self.folder / "log"))
            self.wait_for(lambda: ticks() > 10, run)
            self.assertFalse(saved.exists())
            os.kill(next(process for process in ranks if self.is_rank(process, rank)), signal.SIGUSR1)
            self.wait_for(saved.exists, run)
            before = ticks()
            self.wait_for(lambda: ticks() > before + 10, run)  # the run goes on
            os.kill(next(process for process in ranks if self.is_rank(process, 0)), signal.SIGKILL)
            run.wait(timeout=WAIT_S)
            self.plain("resume", "run.h5", "--for", 0.1 + float(self.tick()) / 10, "--quiet", "--hash-log", "log")
            log = lines_of(self.folder / "log")
            self.assertEqual(log[:len(expected)], expected[:len(log)])

    def test_a_profile_shows_each_process(self):
        done = self.run_on(3, "run", "room.json", "--threads", 1, "--profile", "trace.json", "--profile-ticks", "2:4", "--quiet")
        self.assertEqual(done.returncode, 0, done.stderr)
        events = [event for event in json.loads((self.folder / "trace.json").read_text())["traceEvents"] if event["pid"] == 2]
        names = [event["args"]["name"] for event in events if event["name"] == "thread_name"]
        self.assertEqual(names, ["rank 0", "rank 1", "rank 2"])
        sensed = [event for event in events if event["name"] == "sense"]
        self.assertEqual(sorted((event["args"]["tick"], event["tid"]) for event in sensed),
                         [(tick, rank) for tick in (2, 3, 4) for rank in (0, 1, 2)])
        self.assertTrue(all(event["dur"] > 0 for event in sensed))
        self.assertEqual(sum(event["args"]["rows"] for event in sensed), 3 * 40)

    def test_a_signal_saves_the_state(self):
        run, ranks = self.started("--checkpoint-every", 1)
        os.kill(next(process for process in ranks if self.is_rank(process, 0)), signal.SIGTERM)
        self.assertEqual(run.wait(timeout=WAIT_S), 3)
        self.plain("resume", "run.h5", "--for", 0.1 + float(self.tick()) / 10, "--quiet")

    def test_a_signal_to_any_process_saves_the_state(self):
        for number in (signal.SIGTERM, signal.SIGINT, signal.SIGHUP):
            for name in ("run.h5", "log"):
                (self.folder / name).unlink(missing_ok=True)
            run, ranks = self.started("--hash-log", "log", first="log")
            os.kill(next(process for process in ranks if self.is_rank(process, 2)), number)
            self.assertEqual(run.wait(timeout=WAIT_S), 3)
            self.assertEqual(int(self.tick()), len(lines_of(self.folder / "log")) - 1)

    def test_a_second_signal_to_any_process_ends_the_run(self):
        run, ranks = self.started("--hash-log", "log", first="log")
        first, last = (next(process for process in ranks if self.is_rank(process, rank)) for rank in (0, 2))
        os.kill(first, signal.SIGSTOP)  # the tick does not end
        os.kill(last, signal.SIGTERM)
        pending = lambda: re.search(r"ShdPnd:\s*(\w+)", pathlib.Path(f"/proc/{last}/status").read_text())[1]
        self.wait_until(lambda: int(pending(), 16) == 0)
        os.kill(last, signal.SIGTERM)
        self.wait_until(lambda: last not in self.ranks_here())
        with contextlib.suppress(ProcessLookupError):  # the launcher may have ended it
            os.kill(first, signal.SIGCONT)
        self.assertNotIn(run.wait(timeout=WAIT_S), (0, 3))
        self.wait_until(lambda: self.ranks_here() == [])

    def test_a_signal_to_the_launcher_saves_the_state(self):
        run, _ = self.started("--hash-log", "log", first="log")
        self.wait_for(lambda: len(lines_of(self.folder / "log")) > 5, run)
        run.send_signal(signal.SIGTERM)  # the exit code is the launcher's own
        run.wait(timeout=WAIT_S)
        self.assertEqual(int(self.tick()), len(lines_of(self.folder / "log")) - 1)
        self.assertEqual(self.ranks_here(), [])

    def tick(self):
        done = self.call([PROGRAM, "info", "run.h5"])
        line = next(line for line in done.stdout.splitlines() if line.split()[:1] == ["tick"])
        return line.split()[1].strip(",")


class OpenMpi(OnProcesses, unittest.TestCase):
    mpi = "openmpi"
    launcher_options = ("--oversubscribe", "--bind-to", "none")


class Mpich(OnProcesses, unittest.TestCase):
    mpi = "mpich"


class OneProcess(unittest.TestCase):
    def test_needs_no_mpi(self):
        libraries = subprocess.run(["ldd", PROGRAM], check=True, capture_output=True, text=True).stdout
        self.assertIn("libc.so", libraries)
        self.assertNotRegex(libraries, r"(?i)mpi|\bpmi|libucp|open-rte|open-pal")


def run_all():
    """Runs all tests, each class in a process. Returns the exit code."""
    names = [name for name, one in globals().items() if isinstance(one, type) and issubclass(one, unittest.TestCase)]
    running = {name: subprocess.Popen([sys.executable, __file__, PROGRAM, name]) for name in names}
    codes = {name: process.wait() for name, process in running.items()}
    if not set(codes.values()) <= {0, 77}:
        return 1
    return 77 if codes["OpenMpi"] == codes["Mpich"] == 77 else 0


if __name__ == "__main__":
    PROGRAM = os.path.abspath(sys.argv.pop(1))
    if len(sys.argv) == 1:
        sys.exit(run_all())
    result = unittest.main(exit=False).result
    for _, reason in result.skipped:
        print(reason, file=sys.stderr)
    if not result.wasSuccessful():
        sys.exit(1)
    sys.exit(77 if result.testsRun == 0 else 0)
