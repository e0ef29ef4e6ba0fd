#!/usr/bin/env python3
"""Tests that scripts/prove detects differences: stand-ins for the program give different bits in a single variant."""

import contextlib
import importlib.machinery
import importlib.util
import io
import itertools
import json
import math
import pathlib
import subprocess
import sys
import tempfile
import unittest
import unittest.mock

ROOT = pathlib.Path(__file__).resolve().parent.parent
spec = importlib.util.spec_from_loader("prove", importlib.machinery.SourceFileLoader("prove", str(ROOT / "scripts" / "prove")))
prove = importlib.util.module_from_spec(spec)
spec.loader.exec_module(prove)
# scripts/prove has put its folder on the path
from proofs import (builds, checks, coverage, random_proof, random_worlds, reach, runs, scenes, sessions, shrink,  # noqa: E402
                    variants)
from proofs.kinds import Kinds  # noqa: E402

WORLD = runs.World("crowd.json")
LOG = [f"{tick} {tick:016x} pose={1:016x} velocity={2:016x} sensor={3:016x} memory={4:016x}" for tick in range(51)]
OTHER = LOG[:-1] + [LOG[-1].replace("pose=0", "pose=1")]
GOLDEN = {("crowd.json", None, 50): f"{50:016x}"}


class Difference(unittest.TestCase):
    def test_equal_logs_have_none(self):
        self.assertEqual(runs.difference(LOG, list(LOG)), "")

    def test_names_the_first_tick_and_its_groups(self):
        other = list(LOG)
        other[7] = other[7].replace(f"sensor={3:016x}", f"sensor={5:016x}").replace(f"memory={4:016x}", "memory=0")
        other[9] = other[9].replace("pose", "pos")
        self.assertTrue(runs.difference(LOG, other).startswith("differs from tick 7 on, in sensor, memory:\n"))
        self.assertIn(f"\n  expected {LOG[7]}\n  got      {other[7]}", runs.difference(LOG, other))


class Reach(unittest.TestCase):
    def test_populations_keep_their_proportions(self):
        world = {"populations": [{"name": "a", "count": 3000}, {"name": "b", "count": 1000}, {"name": "c", "count": 1}]}
        self.assertEqual(reach.populations(world, 100), ("a=75", "b=25", "c=1"))
        self.assertEqual(reach.populations(world, 5000), ())
        self.assertEqual(reach.populations({}, 5000), ())

    def prove(self, code, result):
        """Makes the reach test with a stand-in for the program that prints this result."""
        done = subprocess.CompletedProcess([], code, f"1 thread   50 same bits  0123\n1 thread, bodies beyond reach hidden  7 {result}\n", "")
        with unittest.mock.patch.object(reach.subprocess, "run", return_value=done) as run:
            found = reach.prove("troupe", runs.World("crowd.json", populations=("r=9",)), 50)
        self.assertEqual(run.call_args[0][0][2:], [str(ROOT / "worlds/crowd.json"), "--robots", "r=9", "--reach", "--threads", "1",
                                                   "--tile-size", "auto", "--for", "5"])
        return found

    def test_a_difference_is_a_fault(self):
        self.assertEqual(self.prove(0, "same bits 0123"), ("0123", ""))
        state, fault = self.prove(1, "DIFFERS 4567")
        self.assertEqual(state, "4567")
        self.assertIn("crowd, reach:", fault)
        with self.assertRaises(runs.Fault):
            self.prove(2, "")

    def test_unknown_worlds_are_refused(self):
        with self.assertRaisesRegex(runs.Fault, "there is no world none.json; known: "):
            scenes.Scenes().named(["none.json"])
        self.assertEqual(scenes.Scenes().named(), [row["world"] for row in scenes.Scenes().rows])


class Given:
    """A variant with a given result."""

    def __init__(self, label, lines):
        self.label, self._lines = label, lines

    def lines(self, *_):
        return self._lines


class Proofs(unittest.TestCase):
    def hold(self, *proofs, golden=None):
        with contextlib.redirect_stdout(io.StringIO()) as table:
            found = {proof.name: texts for proof, texts in prove.hold(WORLD, list(proofs), 50, None, golden)}
        return found, table.getvalue()

    def test_the_same_bits_everywhere_are_no_fault(self):
        found, table = self.hold(variants.Proof("a", "two", (Given("x", LOG), Given("y", LOG))),
                                 variants.Proof("b", "one", (Given("z", LOG),)), golden=GOLDEN)
        self.assertEqual(found, {"a": [], "b": []})
        self.assertEqual(table.count("same bits"), 2)

    def test_one_variant_that_differs_is_found_in_its_proof(self):
        found, table = self.hold(variants.Proof("a", "one", (Given("x", LOG),)),
                                 variants.Proof("b", "two", (Given("y", LOG), Given("z", OTHER))))
        self.assertEqual(found["a"], [])
        self.assertEqual(len(found["b"]), 1)
        self.assertTrue(found["b"][0].startswith("crowd, b, z: differs from tick 50 on, in pose:"))
        self.assertIn("DIFFERS", table)

    def test_another_golden_hash_is_a_fault(self):
        found, _ = self.hold(variants.Proof("a", "one", (Given("x", LOG),)),
                             golden={("crowd.json", None, 50): "0123456789abcdef"})
        self.assertIn("the golden hash is 0123456789abcdef", found["a"][0])

    def test_no_golden_hash_is_a_fault(self):
        found, _ = self.hold(variants.Proof("a", "one", (Given("x", LOG),)), golden={})
        self.assertIn("no golden hash of tick 50", found["a"][0])

    def test_kernels_of_another_instruction_set_than_asked_for_are_a_fault(self):
        with tempfile.TemporaryDirectory() as name:
            folder = pathlib.Path(name)
            for ran, asked, fault in (("sse4", "sse4", None), ("avx2", "sse4", "must run on sse4, but ran on avx2"),
                                      ("", "sse4", "must run on sse4, but ran on an unknown instruction set")):
                program = folder / "program"
                head = f"# simd: {ran}\n" if ran else ""
                log = "\n".join(LOG)
                program.write_text(f"#!/bin/sh\nprintf '%s\\n' '{head}{log}' > {folder}/run.log\n")
                program.chmod(0o755)
                variant = runs.Variant("x", program, simd=asked)
                with self.subTest(ran=ran):
                    if fault is None:
                        self.assertEqual(variant.lines(WORLD, 50, folder), LOG)
                    else:
                        with self.assertRaisesRegex(runs.Fault, fault):
                            variant.lines(WORLD, 50, folder)

    def test_a_library_that_cannot_be_preloaded_is_a_fault(self):
        with tempfile.TemporaryDirectory(prefix="troupe ") as name:
            folder = pathlib.Path(name)
            log = "\n".join(LOG)
            program = folder / "program"
            program.write_text(f"#!/bin/sh\nprintf '%s\\n' '{log}' > '{folder}/run.log'\n")
            program.chmod(0o755)
            self.assertEqual(runs.Variant("x", program).lines(WORLD, 50, folder), LOG)
            (folder / "hostile.so").touch()
            variant = runs.Variant("x", program, environment={"LD_PRELOAD": str(folder / "hostile.so")})
            with self.assertRaisesRegex(runs.Fault, "^x: .*cannot be preloaded"):
                variant.lines(WORLD, 50, folder)


class Ranks(unittest.TestCase):
    def test_every_shipped_world_is_run(self):
        ranked = scenes.Scenes().ranked()
        self.assertEqual(sorted(world.file for world, _, _ in ranked), scenes.shipped())
        golden = runs.read_golden()
        for world, robots, ticks in ranked:
            if world.populations:
                self.assertEqual(world.file, "campus.json")
                self.assertEqual(world.arguments[1:3], ["--robots", "a=100"])
            else:
                self.assertIn((world.key, robots, ticks), golden)
        self.assertEqual([world.file for world, _, _ in scenes.Scenes().ranked(["door.json"])], ["door.json"])
        with self.assertRaisesRegex(runs.Fault, "there is no world dor.json; known: hospital.json, "):
            scenes.Scenes().ranked(["dor.json"])

    def test_teams_contain_all_pairs(self):
        for values in ((0, 1), (0, 2), (1, 2)):
            pairs = {tuple(team[i] for i in values) for team in prove.TEAMS}
            self.assertEqual({ranks for ranks, _, _ in prove.TEAMS}, {1, 2, 3, 4, 7})
            self.assertEqual(len(pairs), math.prod(len({team[i] for team in prove.TEAMS}) for i in values))

    def test_processes_are_started_with_the_launchers_that_are_installed(self):
        with tempfile.TemporaryDirectory() as name:
            folder = pathlib.Path(name)
            for file in ("mpirun.mpich", "libtroupe_mpi_mpich.so", "libtroupe_mpi_openmpi.so", "troupe"):
                (folder / file).touch(mode=0o755)
            base = runs.Variant("1 thread", folder / "troupe")
            with unittest.mock.patch.dict("os.environ", {"PATH": name}), contextlib.redirect_stdout(io.StringIO()) as told:
                proof = variants.processes(base, (1, 4))
                (folder / "mpirun.mpich").unlink()
                nothing = variants.processes(base, (1, 4))
            self.assertIsNone(nothing)
            self.assertEqual(told.getvalue().count("NOT PROVED: processes of openmpi"), 2)
            self.assertEqual(told.getvalue().count("NOT PROVED: processes of mpich"), 1)
            self.assertEqual([variant.label for variant in proof.variants],
                             ["1 processes of mpich", "4 processes of mpich",
                              "3 processes of mpich, two of them scalar, in hostile surroundings"])
            self.assertEqual(proof.variants[1].emulator, (f"{name}/mpirun.mpich", "-n", 4))


class Planted(unittest.TestCase):
    """The patches of scripts/prove --planted, which insert faults, still apply to the sources."""

    def test_faults_apply_to_the_sources(self):
        names = [name for name, _ in builds.planted_faults()]
        self.assertEqual(names, ["address_tie", "avx2_division", "birth_memory", "depth_forgotten", "float_sum", "libm_sine", "light_reach", "odometry_at_birth", "racing_read",
                                 "rank_birth_order", "rank_blocked_lost", "rank_effect_order", "rank_float_sum", "rank_ghost_old", "rank_message_early", "rank_message_order",
                                 "rank_outcome_early", "rank_push_lost", "rank_skin_thin", "rank_state_old", "rank_undeclared",
                                 "rank_world_of_one", "row_kept"])
        for name in names:
            with self.subTest(name=name), tempfile.TemporaryDirectory() as folder:
                patch = builds.PLANTED / f"{name}.patch"
                for file in builds.patched_files(patch):
                    builds.copy_if_changed(ROOT / file, pathlib.Path(folder) / file)
                done = subprocess.run(["patch", "--strip=1", "--fuzz=0", "--input", patch], cwd=folder, capture_output=True,
                                      text=True)
                self.assertEqual(done.returncode, 0, done.stdout + done.stderr)

    def test_worlds_belong_to_faults(self):
        names = {name for name, _ in builds.planted_faults()}
        worlds = {file.stem for file in builds.PLANTED.glob("*.json")}
        self.assertEqual(worlds, {"light_reach", "rank_birth_order", "rank_blocked_lost", "rank_effect_order", "rank_outcome_early", "rank_push_lost",
                                  "rank_skin_thin"})
        self.assertLessEqual(worlds, names)

    def test_a_fault_is_looked_for_in_its_own_world(self):
        for code, found in ((0, False), (1, True)):
            with tempfile.TemporaryDirectory() as folder:
                program = pathlib.Path(folder) / "program"
                program.write_text(f"#!/bin/sh\nexit {code}\n")
                program.chmod(0o755)
                self.assertEqual(prove.planted_in_own_world(program, "rank_effect_order"), found)
                self.assertFalse(prove.planted_in_own_world(program, "float_sum"))

    def test_faults_are_chosen_by_their_names(self):
        self.assertEqual([name for name, _ in builds.planted_faults(["rank_world_of_one", "float_sum"])],
                         ["rank_world_of_one", "float_sum"])
        with self.assertRaisesRegex(runs.Fault, "there is no planted fault rank_world; known: address_tie, .*rank_world_of_one"):
            builds.planted_faults(["rank_world"])

    def test_faults_say_what_they_do(self):
        for name, about in builds.planted_faults():
            self.assertGreater(len(about), 40, name)


SCHEMA = json.loads((ROOT / "docs" / "world.schema.json").read_text())


class RandomWorlds(unittest.TestCase):
    def setUp(self):
        self.kinds = Kinds(json.loads(json.dumps(SCHEMA)))
        self.pairs = random_worlds.pairs_of(self.kinds)

    def test_a_world_follows_from_its_seed_and_index(self):
        once, again, other = (random_worlds.make_world(self.kinds, seed, 5, self.pairs) for seed in (1, 1, 2))
        self.assertEqual(once, again)
        self.assertNotEqual(once, other)

    def test_every_pair_of_a_kind_and_an_event_is_the_focus_of_a_world(self):
        foci = {random_worlds.focus_of(self.pairs, 1, i) for i in range(len(self.pairs))}
        self.assertEqual(foci, set(self.pairs))
        self.assertIn(("device", "gripper", "carried"), foci)
        self.assertIn(("sensor", "radio", "born"), foci)

    def test_worlds_have_every_kind_rule_and_intervention_of_the_schema(self):
        counted = coverage.Coverage(self.kinds)
        told = {"ticks": 1000, "events": [], "resumed": [], "acts": sessions.ACTS}
        for i in range(400):
            counted.add(random_worlds.make_world(self.kinds, 1, i, self.pairs)[0], told)
        missing = [name for name in counted.missing() if ": " not in name]
        self.assertEqual(missing, [])

    def test_some_worlds_have_edge_cases(self):
        made = [random_worlds.make_world(self.kinds, 1, i, self.pairs)[0] for i in range(200)]
        with unittest.mock.patch.object(random_worlds, "EDGE_CASES", 0):
            plain = [random_worlds.make_world(self.kinds, 1, i, self.pairs)[0] for i in range(200)]
        changed = [(world, before) for world, before in zip(made, plain) if world != before]
        self.assertGreater(len(changed), 200 * 0.2)
        for world, before in changed:
            self.assertEqual({name: world["types"][name] for name in before["types"]}, before["types"])
            self.assertGreaterEqual(len(world.get("at", ())), len(before.get("at", ())))
        for name in ("crate", "board", "arms", "listener", "sheet"):
            self.assertTrue(any(name in world["types"] for world, _ in changed), name)
        self.assertTrue(any(abs(model["pose"]["y_m"]) > 8e4 for world, _ in changed for model in world.get("models", ())
                            if "y_m" in model["pose"]))
        self.assertTrue(any(at["time_s"] == 0 for world, _ in changed for at in world.get("at", ())))

    def test_rounding_puts_radios_at_their_range(self):
        pairs = 0
        for i in range(300):
            world = random_worlds.make_world(self.kinds, 1, i, self.pairs)[0]
            models = {model["name"]: model["pose"] for model in world.get("models", ())}
            if "listener" not in models or "y_m" in models["listener"]:  # without a radio, or far from the origin
                continue
            radius = world["types"]["speaker"]["blocks"][0]["points_m"][0][0]
            range_m = world["types"]["listener"]["sensors"][0]["range_m"]
            listener, speaker = models["listener"]["x_m"], models["speaker"]["x_m"]
            self.assertLessEqual(abs((speaker - radius) - listener), range_m)
            self.assertLess((listener + range_m) + radius, speaker)
            pairs += 1
        self.assertGreater(pairs, 5)

    def test_a_kind_that_is_new_to_the_program_is_in_worlds_without_a_line_here(self):
        schema = json.loads(json.dumps(SCHEMA))
        schema["definitions"]["sensor"]["anyOf"].insert(0, {"type": "object", "required": ["kind", "grasp_m"], "properties": {
            "kind": {"const": "whisker"}, "grasp_m": {"type": "number", "minimum": 0.1, "maximum": 0.4, "default": 0.2}}})
        kinds = Kinds(schema)
        pairs = random_worlds.pairs_of(kinds)
        self.assertIn(("sensor", "whisker", "set"), pairs)
        whiskers = [sensor for i in range(200) for one in random_worlds.make_world(kinds, 1, i, pairs)[0]["types"].values()
                    for sensor in one.get("sensors", ()) if sensor["kind"] == "whisker"]
        self.assertTrue(whiskers)
        self.assertTrue(all(0.1 <= whisker["grasp_m"] <= 0.4 for whisker in whiskers))

    def test_a_kind_that_no_world_has_is_named(self):
        counted = coverage.Coverage(self.kinds)
        counted.add({"tick_s": 0.1, "types": {"r": {"drive": {"kind": "diff"}}}, "models": [{"name": "r", "type": "r"}]},
                    {"ticks": 9, "events": [], "resumed": []})
        self.assertNotIn("drive diff", counted.missing())
        self.assertIn("drive omni", counted.missing())
        self.assertIn("sensor ranger: born", counted.missing())

    def test_what_happened_is_counted_of_what_the_run_told(self):
        counted = coverage.Coverage(self.kinds)
        world = {"tick_s": 0.1, "types": {"bot": {"drive": {"kind": "diff"}, "devices": [{"kind": "led", "name": "led0"}]}},
                 "models": [{"name": "solo", "type": "bot"}],
                 "populations": [{"name": "r", "type": "bot", "count": 2, "place": {"rule": "grid"}}],
                 "at": [{"time_s": 0.2, "set": {"type": "bot", "device": {"name": "led0", "intensity": 1}}},
                        {"time_s": 0.3, "move": {"model": "solo", "pose": {}}}, {"time_s": 99, "remove": {"type": "bot"}}]}
        counted.add(world, {"ticks": 20, "events": [["birth", "r7", None], ["grip", "x", "solo"]], "resumed": []})
        led = {event for family, kind, event in counted.pairs if kind == "led"}
        self.assertEqual(led, {"born", "carried", "moved", "set"})
        self.assertEqual(counted.actions["remove"], 0)  # after the end

    def test_acts_that_no_session_has_are_named(self):
        counted = coverage.Coverage(self.kinds)
        counted.add(random_worlds.make_world(self.kinds, 1, 0, self.pairs)[0],
                    {"ticks": 9, "events": [], "resumed": [], "acts": ["hold", "move"]})
        self.assertIn("act remove", counted.missing())
        self.assertNotIn("act hold", counted.missing())

    def test_sessions_contain_every_act(self):
        header = (ROOT / "engine" / "kinds" / "act.hpp").read_text()
        listed = header[header.index("k_acts{"):].split("}")[0]
        self.assertEqual(sorted(sessions.ACTS), sorted(listed.split('"')[1::2]))

    def test_some_worlds_have_a_session_a_check_of_controllers_or_tables(self):
        made = [{check["check"] for check in checks.plan(1, i, 20)} for i in range(2000)]
        self.assertGreater(sum("session" in names for names in made), 2000 / 3)
        self.assertGreater(sum("controllers" in names for names in made), 2000 / 20)
        self.assertGreater(sum("tables" in names for names in made), 2000 / 5)
        self.assertTrue(all("controllers" in {check["check"] for check in checks.plan(1, i, 20, controllers=True)} for i in range(50)))
        without_module = [checks.plan(1, i, 20, program_only=True) for i in range(200)]
        self.assertTrue({"session", "tables"}.isdisjoint(check["check"] for plan in without_module for check in plan))

    def test_checkpoints_of_a_plan_lie_within_the_run(self):
        planned = 0
        for i in range(50):
            for check in checks.plan(1, i, 20):
                if check["check"] == "checkpoints":
                    planned += 1
                    self.assertTrue(all(0 <= tick < 20 for tick in check["at"]))
                    self.assertGreater(len(check["threads"]), len(check["at"]))
        self.assertGreater(planned, 0)

    def test_lines_that_part_are_named_by_tick_and_groups(self):
        self.assertIsNone(checks.difference(LOG, LOG[7:]))
        tick, text = checks.difference(LOG, OTHER[7:])
        self.assertEqual(tick, 50)
        self.assertIn("from tick 50 on, in pose", text)
        self.assertIsNotNone(checks.difference(LOG, LOG[7:-1]))
        self.assertIsNotNone(checks.difference(LOG[:-1], LOG))


class Shrink(unittest.TestCase):
    def test_nothing_is_left_but_what_fails(self):
        document = {"many": [{"n": i, "text": "x"} for i in range(40)], "other": {"deep": [1, 2, 3]}, "count": 1000}
        document["many"][17]["needle"] = 80
        shrinker = shrink.Shrinker(lambda one: any(each.get("needle", 0) >= 7 for each in one.get("many", ())))
        self.assertEqual(shrinker.shrunk(document), {"many": [{"needle": 7}]})
        self.assertLess(shrinker.trials, 150)

    def test_it_ends_where_it_may_try_no_more(self):
        shrinker = shrink.Shrinker(lambda one: len(one.get("a", ())) == 100, most_trials=5)
        shrinker.shrunk({"a": list(range(100))})
        self.assertEqual(shrinker.trials, 5)


class Runner:
    """A stand-in for the program: worlds with faults differ in one check, and invalid(world) worlds do not load."""

    program_only = False
    program = None

    def __init__(self, folder, invalid=lambda world: False):
        self.folder, self.invalid = pathlib.Path(folder), invalid

    def run(self, world, ticks, wanted, cover=False):
        if self.invalid(world):
            return {"invalid": "world.json:1: error: no such thing"}
        failures = [{"check": check, "tick": 3, "text": "differs from tick 3 on, in memory"} for check in wanted
                    if check["check"] == "reset" and world.get("faults") and ticks >= 3]
        return {"failures": failures, "events": [], "refused": [], "resumed": [], "ticks": ticks, "stopped": ""}


class RandomProofs(unittest.TestCase):
    def prove(self, runner, count, kept, **options):
        proof = random_proof.RandomProof(runner, 1, count, kept=pathlib.Path(kept), kinds=Kinds(SCHEMA), say=lambda _: None, **options)
        return proof, proof.run()

    def test_a_world_that_differs_is_made_small_and_kept(self):
        with tempfile.TemporaryDirectory() as folder, tempfile.TemporaryDirectory() as kept:
            proof, faults = self.prove(Runner(folder), 12, kept)
            self.assertGreater(len(faults), 1)
            self.assertIn("differs from tick 3 on, in memory", faults[0])
            self.assertIn("scripts/prove --random-again", faults[0])
            first = sorted(pathlib.Path(kept).iterdir())[0]
            self.assertEqual(set(json.loads((first / "world.json").read_text())), {"faults"})
            self.assertEqual(json.loads((first / "case.json").read_text())["ticks"], 3)
            self.assertIn("types", json.loads((first / "original.json").read_text()))
            self.assertTrue(random_proof.again(Runner(folder), first, say=lambda _: None))
            self.assertIn("12 of seed 1", next(iter(proof.report())))

    def test_too_many_worlds_that_do_not_load_are_a_fault(self):
        with tempfile.TemporaryDirectory() as folder, tempfile.TemporaryDirectory() as kept:
            _, faults = self.prove(Runner(folder, lambda world: world["seed"] % 4 == 0), 60, kept, shrink=False)
            self.assertTrue(any("could be loaded; the most frequent errors: error: no such thing" in fault for fault in faults), faults)

    def test_a_limit_of_time_is_that_of_the_clock(self):
        with tempfile.TemporaryDirectory() as folder, tempfile.TemporaryDirectory() as kept:
            ticks = itertools.count(0, 10)
            proof, _ = self.prove(Runner(folder), None, kept, shrink=False, seconds=45, now=lambda: next(ticks))
            self.assertEqual(proof.made, 4)
            self.assertEqual(proof.took_s, 60)

    def test_processor_time_includes_that_of_ended_children(self):
        before = random_proof.processor_s()
        subprocess.run([sys.executable, "-c", "import time\nwhile time.process_time() < 0.2: pass"], check=True)
        self.assertGreaterEqual(random_proof.processor_s() - before, 0.19)

    def test_a_folder_that_is_no_case_is_told(self):
        with tempfile.TemporaryDirectory() as folder, self.assertRaises(runs.Fault):
            random_proof.again(Runner(folder), folder)


if __name__ == "__main__":
    unittest.main()
