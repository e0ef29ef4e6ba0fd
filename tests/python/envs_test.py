"""Tests the environments of troupe.envs with the packages whose interfaces they implement (Gymnasium, PettingZoo): with the
checkers of these packages, and by comparing their vector environment with that of troupe.envs, bit for bit."""

import ast
import contextlib
import copy
import dataclasses
import gc
import inspect
import io
import pathlib
import pickle
import re
import subprocess
import sys
import tempfile
import threading
import time
import unittest
import unittest.mock
import warnings

from packages import run_with_packages

if __name__ == "__main__":
    run_with_packages()

import gymnasium
import numpy as np
import pettingzoo.test
import troupe
import troupe.envs
from gymnasium.utils.env_checker import check_env, data_equivalence
from gymnasium.vector import AutoresetMode, SyncVectorEnv
from support import ROOM, ROOT, WAIT_S, needs_view
from troupe.envs.tasks import lidar, room, robot_type, spread

sys.path.insert(0, str(ROOT))
from tests.support.websocket import Socket  # noqa: E402

TASKS = sorted(troupe.envs.TASKS)


class Short(troupe.envs.Navigation):
    """A task with short episodes, some of which end at a goal."""

    seconds = 3.0

    def __init__(self, robots=2):
        super().__init__(robots=robots, size=4.0)


class Walkers(troupe.envs.Task):
    """A task with two different teams: the carts of the other tests, and bots, some of which are born later."""

    world = ROOM
    seconds = 4.0
    teams = [
        troupe.envs.Team(robots="r", observation=[{"field": "ranges"}, {"of": "time_left"}]),
        troupe.envs.Team(
            robots="cart",
            observation={"eye": [{"field": "ranges", "scale": 0.5}], "where": [{"of": "pose"}]},
            actions=[{"command": "forward"}, {"command": "left"}, {"command": "turn"}],
            levels=[[-1, 0, 1], [-1, 1], [0, 0.5]],
        ),
    ]


class Looker(troupe.envs.Task):
    """A task whose observation is a dict with a picture and ranges, and which has three discrete actions."""

    seconds = 3.0

    def __init__(self):
        robot = robot_type()
        robot["sensors"].append({"name": "eye", "kind": "camera", "pose": {"z_m": 0.2}, "width": 8, "height": 4})
        self.world = room(6.0, [spread("r", "robot", 3, 6.0)], {"robot": robot})
        self.teams = [
            troupe.envs.Team(
                robots="r",
                observation={
                    "picture": [{"device": "eye", "field": "color", "shape": (4, 8, 4)}],
                    "lidar": [lidar()],
                },
                choices=[[1, 0], [0, 1], [0, -1]],
                arrays={"speed": [{"of": "speed"}]},
                rewards=[{"array": "speed", "column": 0}],
            )
        ]


class Carts(troupe.envs.Task):
    """A task with the cart of the tests' room, whose actions are MultiDiscrete: one index per command."""

    world = ROOM
    seconds = 3.0
    measures = ["displacement:cart"]
    teams = [
        dataclasses.replace(
            Walkers.teams[1],
            arrays={"pose": [{"of": "pose"}]},
            rewards=[{"array": "pose", "column": 0, "change": True}, {"measure": "displacement:cart", "weight": 0.5, "change": True}],
            ends=[{"measure": "displacement_m:cart", "above": 0.8, "reward": 7.0}],
        )
    ]


class Births(troupe.envs.Task):
    """A task with three robots, a fourth that is born after 1 s, and a fifth that is never born. NumPy functions reward and,
    if asked to, finish all robots in all steps."""

    seconds = 2.0
    measures = ["alive"]

    def __init__(self, ends=(), finishes=False):
        self.world = room(8.0, [{**spread("r", "robot", 3, 8.0), "reserve": 2}], {"robot": robot_type()})
        self.world["at"] = [{"time_s": 1.0, "add": {"population": "r", "count": 1, "region_m": [[-3.5, -3.5], [3.5, 3.5]]}}]
        self.finishes = finishes
        self.teams = [
            troupe.envs.Team(robots="r", observation=[lidar()], rewards=[{"measure": "alive", "weight": 10.0}], ends=list(ends))
        ]

    def reward(self, batch, team):
        return np.ones((batch.copies, 5))

    def terminated(self, batch, team):
        return np.ones((batch.copies, 5), np.bool_) if self.finishes else None


class Telling(Short):
    """A task with infos. An option sets the number that `begin` gives the robots of the copies that begin an episode."""

    def begin(self, batch, copies):
        numbers = batch.memory.setdefault("numbers", np.zeros((batch.copies, 2), np.int64))
        numbers[copies] = batch.options.get("number", 7)

    def info(self, batch, team):
        robots = len(batch.names[team])
        return {
            "reward": batch.core.rewards(team),
            "is_close": batch.array("goal", team)[..., 2] < 1,
            "number": batch.memory["numbers"][:, :robots],
            "goal": batch.array("goal", team)[..., :2],
        }


def fixed_actions(space, step):
    """Returns actions that depend only on the step, so that all environments get the same actions."""
    space.seed(step)
    return space.sample()


class Checkers(unittest.TestCase):
    def test_single_environments(self):
        for name in TASKS:
            with self.subTest(name), warnings.catch_warnings():
                warnings.filterwarnings("ignore", message=".*Box.*(infinity|low|high).*")
                env = gymnasium.make(f"troupe/{name}-v0", robots=3, render_mode="rgb_array", render_size=(64, 48))
                check_env(env.unwrapped)
                env.reset(seed=1)
                picture = env.render()
                self.assertEqual((picture.shape, picture.dtype), ((48, 64, 3), np.uint8))
                self.assertGreater(len(np.unique(picture.reshape(-1, 3), axis=0)), 2)
                env.close()

    def test_films_of_all_environments_run_in_real_time(self):
        class Slow(Short):
            ticks = 4  # of 0.1 s

        for task, rate in ((Short(2), 10), (Slow(2), 2.5), (Walkers(), 5)):
            made = [troupe.envs.ParallelEnv(task)]
            if len(task.teams) == 1:
                made += [troupe.envs.Env(task), troupe.envs.VectorEnv(task, 2)]
            for env in made:
                self.assertAlmostEqual(env.metadata["render_fps"], rate)

    def test_the_size_of_pictures_is_checked_at_once(self):
        for make in (troupe.envs.Env, troupe.envs.ParallelEnv, lambda task, **options: troupe.envs.VectorEnv(task, 4, **options)):
            for size in (64, (64,), (64, 64, 3), (0, 64), (64, -1), (64.5, 64), "ab", None):
                with self.subTest(size), self.assertRaises(ValueError) as raised:
                    make(Short(2), render_mode="rgb_array", render_size=size)
                self.assertEqual(
                    str(raised.exception), f"render_size={size!r}: give the width and the height of pictures, whole numbers of pixels from 1"
                )
            self.assertEqual(make(Short(2), render_size=np.array([64, 48])).renderer.size, (64, 48))

    def test_pictures_have_the_options_of_those_of_simulations(self):
        makers = (
            troupe.envs.Env,
            troupe.envs.ParallelEnv,
            lambda task, **options: troupe.envs.VectorEnv(task, 4, **options),
        )
        single = troupe.Simulation(Short(2).world, threads=1, seed=1)
        single.step()  # the tick with which an episode begins
        for look in ({}, {"camera": "perspective", "layers": "scans"}, {"center_m": (0, 0), "across_m": 2.0, "background": "dark"}):
            for make in makers:
                env = make(Short(2), render_mode="rgb_array", render_size=(64, 48), render_look=look)
                env.reset(seed=1)
                drawn = env.render()
                drawn = drawn[0] if isinstance(drawn, tuple) else drawn
                with self.subTest(look):
                    self.assertTrue(np.array_equal(drawn, single.picture(64, 48, **look)))
        for look in ({"kamera": "top"}, ["top"], "top"):
            for make in makers:
                with self.assertRaises(TypeError) as raised:
                    make(Short(2), render_look=look)
                self.assertEqual(
                    str(raised.exception),
                    f"render_look={look!r}: give a dict of options of pictures; known: camera, layers, center_m, angle_rad, across_m, "
                    "color_by, color_range, background",
                )

    def test_missing_libraries_for_pictures_are_reported_at_once(self):
        """Pictures need OSMesa or EGL, which a wheel does not contain. The error comes with the environment, not with a picture."""

        class WithoutOSMesa(troupe.Simulation):
            def picture(self, **_):
                raise RuntimeError("cannot draw: neither OSMesa nor EGL is installed")

        text = 'render_mode="rgb_array": cannot draw: neither OSMesa nor EGL is installed'
        with unittest.mock.patch("troupe.envs.render.Simulation", WithoutOSMesa):
            for make in (troupe.envs.Env, troupe.envs.ParallelEnv, lambda task, **options: troupe.envs.VectorEnv(task, 4, **options)):
                with self.assertRaisesRegex(RuntimeError, re.escape(text)):
                    make(Short(2), render_mode="rgb_array")
                make(Short(2)).close()

    def test_a_picture_as_observation_and_discrete_actions(self):
        env = troupe.envs.Env(Looker())
        check_env(env, skip_render_check=True)
        observation, _ = env.reset(seed=4)
        self.assertEqual(observation["picture"].shape, (4, 8, 4))
        self.assertGreater(len(np.unique(observation["picture"])), 2)
        self.assertEqual(env.action_space, gymnasium.spaces.Discrete(3))
        rewards = [env.step(0)[1] for _ in range(3)]  # action 0: drive straight on
        self.assertGreater(rewards[-1], 0.4)
        with self.assertRaisesRegex(ValueError, "whole numbers from 0 to 2"):
            env.step(3)

    def test_parallel_environments(self):
        for make in [*(lambda task=task: task(robots=3) for task in troupe.envs.TASKS.values()), Walkers, Short, Carts, Births]:
            task = make()
            with self.subTest(type(task).__name__):
                task.seconds = min(task.seconds, 4.0)
                pettingzoo.test.parallel_api_test(troupe.envs.ParallelEnv(task), num_cycles=100)
                pettingzoo.test.parallel_seed_test(lambda task=task: troupe.envs.ParallelEnv(task), num_cycles=50)


    def test_the_state_has_the_observations_of_all_agents(self):
        for make in (Short, Carts, Births, Looker):
            with self.subTest(make.__name__):
                env = troupe.envs.ParallelEnv(make())
                aec = pettingzoo.utils.parallel_to_aec(troupe.envs.ParallelEnv(make()))
                with warnings.catch_warnings(record=True):  # of spaces with infinite bounds
                    warnings.simplefilter("always")
                    pettingzoo.test.state_test(aec, env)
        env = troupe.envs.ParallelEnv(Births())
        self.assertEqual({*env.observation_spaces}, {*env.action_spaces}, {*env.possible_agents})
        observations, _ = env.reset(seed=1)
        rows = env.state().reshape(5, 12)
        for row, agent in zip(rows, ("r0", "r1", "r2")):
            self.assertEqual(row.tolist(), observations[agent].tolist())
        self.assertFalse(rows[3:].any(), "r3 and r4 are not in the world")
        finished = troupe.envs.ParallelEnv(Births(finishes=True))
        finished.reset(seed=1)
        last, *_ = finished.step({})
        self.assertEqual(finished.agents, [])
        self.assertEqual(finished.state()[:12].tolist(), last["r0"].tolist())
        walkers = troupe.envs.ParallelEnv(Walkers())
        observations, _ = walkers.reset(seed=1)
        row, cart = walkers.state(), observations["cart"]
        self.assertEqual(row.shape, (8 * 4 + 5 + 4,))
        self.assertTrue(np.array_equal(row[-9:], np.concatenate([cart["eye"], cart["where"]])))

    def test_actions_have_the_shape_of_the_space(self):
        env = troupe.envs.Env(Short(2))
        env.reset(seed=1)
        for action in (0.7, [0.7], [[0.7, 0.7]], [0.1, 0.2, 0.3], None):
            with self.assertRaisesRegex(ValueError, r"action: must have the shape \(2,\), found \("):
                env.step(action)
        discrete = troupe.envs.Env(Looker())
        discrete.reset(seed=1)
        with self.assertRaisesRegex(ValueError, r"action: must have the shape \(\), found \(1,\)"):
            discrete.step([0])
        with self.assertRaisesRegex(ValueError, r"action: must consist of whole numbers, found 1.9"):
            discrete.step(1.9)
        parallel = troupe.envs.ParallelEnv(Looker())
        parallel.reset(seed=1)
        with self.assertRaisesRegex(ValueError, r"action of r1: must consist of whole numbers, found 1.9"):
            parallel.step({"r1": 1.9})
        for wrong in (None, [0, 1, 2]):
            with self.assertRaises(TypeError) as raised:
                parallel.step(wrong)
            self.assertEqual(str(raised.exception), f"actions: found {wrong!r}: give a dict with one action per agent")

    def test_actions_of_agents_are_not_rounded(self):
        parallel, vector = troupe.envs.ParallelEnv(Short(2)), troupe.envs.VectorEnv(Short(2), 2)
        seen, _ = parallel.reset(seed=1)
        rows, _ = vector.reset(seed=1)
        for _ in range(5):
            seen, *_ = parallel.step({"r0": np.array([0.1, 0.2]), "r1": np.array([0.3, 0.7])})
            rows, *_ = vector.step(np.array([[0.1, 0.2], [0.3, 0.7]]))
        self.assertTrue(np.array_equal(np.stack([seen["r0"], seen["r1"]]), rows))

    def test_a_robot_may_have_the_name_of_a_type(self):
        def bot(range_max_m):
            eye = {"name": "eye", "kind": "ranger", "transducers": [{"range_max_m": range_max_m}]}
            return {"size_m": [0.3, 0.3, 0.2], "drive": {"kind": "diff"}, "sensors": [eye]}

        task = troupe.envs.Task()
        task.world = {"troupe": 1, "types": {"near": bot(1), "far": bot(5)}, "models": [
            {"name": "far", "type": "near"}, {"name": "near", "type": "far", "pose": {"y_m": 1}},
            {"name": "other", "type": "far", "pose": {"y_m": 2}}]}
        task.teams = [troupe.envs.Team(robots="near", observation=[{"field": "ranges"}])]  # the robots far and near
        for robot, bound in (("far", 1), ("near", 5)):
            for env in (troupe.envs.Env(task, robot=robot), troupe.envs.VectorEnv(task, 2, robot=robot)):
                env.reset(seed=1)
                self.assertEqual(env.batch.names, [[robot]])
                space = getattr(env, "single_observation_space", env.observation_space)
                self.assertEqual(space.high.tolist(), [bound])
        self.assertEqual(troupe.envs.Env(task).robot, "far")
        world = troupe.Simulation(task.world, threads=1)
        self.assertEqual(world.swarm("near").names, ["far", "near"])
        self.assertEqual(world.swarm(world.find("near")).names, ["near"])
        with self.assertRaisesRegex(RuntimeError, "is a model of another simulation"):
            world.swarm(troupe.Simulation(task.world, threads=1).find("near"))

    def test_a_step_does_not_search_the_list_of_agents_for_each_agent(self):
        class Unsearched(list):
            def __contains__(self, agent):
                raise AssertionError(f"the list of agents is searched for {agent}")

        env = troupe.envs.ParallelEnv(Short(3))
        env.reset(seed=1)
        env.agents = Unsearched(env.agents)
        self.assertEqual([*env.step({"r1": np.zeros(2)})[0]], ["r0", "r1", "r2"])

    def test_arrays_are_read_once_for_all_agents(self):
        class Counting:
            def __init__(self, core):
                self.core, self.reads = core, 0

            def __getattr__(self, name):
                self.reads += 1
                return getattr(self.core, name)

        reads = []
        for robots in (2, 6):
            env = troupe.envs.ParallelEnv(Short(robots))
            env.batch.core = Counting(env.batch.core)
            env.reset(seed=1)
            env.step({})
            reads.append(env.batch.core.reads)
        self.assertEqual(reads[0], reads[1])

    def test_an_older_gymnasium_is_an_error_that_names_the_version(self):
        with tempfile.TemporaryDirectory() as folder:
            (pathlib.Path(folder) / "gymnasium").mkdir()
            (pathlib.Path(folder) / "gymnasium" / "__init__.py").write_text('from . import vector\n__version__ = "0.29.1"\n')
            (pathlib.Path(folder) / "gymnasium" / "vector.py").write_text("")
            program = f"import sys; sys.path.insert(0, {folder!r}); import troupe.envs"
            done = subprocess.run([sys.executable, "-c", program], stderr=subprocess.PIPE, text=True)
        self.assertIn("ImportError: troupe.envs needs Gymnasium 1.1 or later, found 0.29.1: pip install --upgrade gymnasium", done.stderr)

    def test_one_copy_uses_one_thread(self):
        for make in (troupe.envs.Env, troupe.envs.ParallelEnv):
            with self.assertRaisesRegex(TypeError, "uses one thread: omit threads, or use VectorEnv"):
                make(Short(2), threads=2)

    def test_seeds_may_be_integers_of_numpy(self):
        for make in (troupe.envs.Env, troupe.envs.ParallelEnv, lambda task: troupe.envs.VectorEnv(task, 2)):
            one, other = make(Short(2)), make(Short(2))
            self.assertTrue(data_equivalence(one.reset(seed=np.int64(7)), other.reset(seed=7), exact=True))

    def test_environments_without_a_seed_differ(self):
        def make():
            return troupe.envs.Env(Short(2))

        first, _ = SyncVectorEnv([make, make]).reset()
        self.assertFalse(np.array_equal(first[0], first[1]))
        one, other = (troupe.envs.ParallelEnv(Short(2)).reset()[0] for _ in range(2))
        self.assertFalse(data_equivalence(one, other, exact=True))
        for kind in (troupe.envs.Env, troupe.envs.ParallelEnv):
            given, seeded = kind(Short(2), seed=7), kind(Short(2))
            self.assertTrue(data_equivalence(given.reset(), seeded.reset(seed=7), exact=True))

    def test_a_closed_environment_says_so(self):
        for make in (troupe.envs.Env, troupe.envs.ParallelEnv, lambda task: troupe.envs.VectorEnv(task, 2)):
            env = make(Short(2))
            self.assertIsNone(env.render())
            env.close()
            env.close()
            for call in (env.render, env.reset):
                with self.assertRaisesRegex(RuntimeError, "this environment was closed: create another one"):
                    call()

    def test_environments_can_be_copied_and_pickled(self):
        for make in (
            lambda: troupe.envs.Env(Short(3), robot="r1", seed=5),
            lambda: troupe.envs.ParallelEnv(Short(3), seed=5),
            lambda: troupe.envs.VectorEnv(Short(3), 6, autoreset_mode="SameStep", threads=1, seed=5),
        ):
            env = make()
            actions = {} if isinstance(env, troupe.envs.ParallelEnv) else np.full(env.action_space.shape, 0.5)
            first = env.reset()
            env.step(actions)
            for copied in (pickle.loads(pickle.dumps(env)), copy.deepcopy(env)):
                self.assertIs(type(copied), type(env))
                gc.collect()  # objects that only made the copy must not close it
                with self.assertRaisesRegex(RuntimeError, r"call reset\(\) before the first step"):
                    copied.step(actions)
                self.assertTrue(data_equivalence(copied.reset(), first, exact=True))
                self.assertEqual(copied.metadata, env.metadata)
                copied.close()
            again = make()
            again.reset()
            again.step(actions)
            self.assertTrue(data_equivalence(env.step(actions), again.step(actions), exact=True), "the copied environment goes on")

    def test_the_task_is_an_object(self):
        for task in ("Navigation", troupe.envs.Navigation):
            for make in (
                troupe.envs.Env,
                troupe.envs.ParallelEnv,
                lambda task, **options: troupe.envs.VectorEnv(task, 8, **options),
                lambda task, **options: troupe.envs.Batch(task, 1),
            ):
                with self.assertRaises(TypeError) as raised:
                    make(task, render_mode="ansi")  # an error that the wrong task comes before
                self.assertEqual(str(raised.exception), f"task: must be a troupe.envs.Task, found {task!r}")

    def test_a_step_needs_a_reset(self):
        for env in (troupe.envs.Env(Short(2)), troupe.envs.ParallelEnv(Short(2))):
            with self.assertRaisesRegex(RuntimeError, r"call reset\(\) before the first step"):
                env.step(np.zeros(2) if isinstance(env, gymnasium.Env) else {})


    def test_a_step_during_a_step_says_so(self):
        class nested(troupe.Controller):  # in place of another thread, whose step might begin too late
            robots = "prey"

            def decide(self, robots):
                if robots.tick > 1:
                    env.step(np.zeros(2))

        env = troupe.envs.Env(troupe.envs.Pursuit(robots=1), controllers=nested)
        env.reset(seed=1)
        with self.assertRaises(troupe.StepError) as raised:
            env.step(np.zeros(2))
        self.assertIn("this batch is being stepped by another thread", str(raised.exception.__cause__))


class Vector(unittest.TestCase):
    def same_as_sync(self, make_task, mode, steps=70):
        names = troupe.envs.ParallelEnv(make_task()).possible_agents
        sync = SyncVectorEnv([lambda: troupe.envs.Env(make_task(), robot=names[0]) for _ in range(3)], autoreset_mode=mode)
        own = troupe.envs.VectorEnv(make_task(), 3, robot=names[0], autoreset_mode=mode)
        self.assertEqual(own.observation_space, sync.observation_space)
        self.assertEqual(own.action_space, sync.action_space)
        self.assertTrue(data_equivalence(own.reset(seed=5), sync.reset(seed=5), exact=True))
        ends = {"terminated": 0, "truncated": 0}
        for step in range(steps):
            actions = fixed_actions(sync.action_space, step)
            ours, theirs = own.step(actions), sync.step(actions)
            self.assertEqual(ours[4].keys(), theirs[4].keys())
            for key in ours[4]:
                one, other = ours[4][key], theirs[4][key]
                if key == "final_obs":
                    self.assertTrue(all(data_equivalence(a, b, exact=True) for a, b in zip(one, other)), f"step {step}")
                else:
                    self.assertTrue(data_equivalence(one, other, exact=True), f"step {step}: {key}")
            self.assertTrue(data_equivalence(ours[:4], theirs[:4], exact=True), f"step {step}")
            ends["terminated"] += int(ours[2].sum())
            ends["truncated"] += int(ours[3].sum())
            if mode == AutoresetMode.DISABLED and (ours[2] | ours[3]).any():
                mask = ours[2] | ours[3]
                self.assertTrue(
                    data_equivalence(own.reset(options={"reset_mask": mask}), sync.reset(options={"reset_mask": mask}), exact=True)
                )
        self.assertGreater(ends["truncated"], 2)
        return ends

    def test_is_the_single_environment_bit_for_bit(self):
        for mode in AutoresetMode:
            with self.subTest(mode):
                self.assertGreater(self.same_as_sync(Short, mode, 200)["terminated"], 0)
                self.assertGreater(self.same_as_sync(Carts, mode)["terminated"], 0)
                for task in (Looker, *troupe.envs.TASKS.values()):
                    with self.subTest(task.__name__):

                        def make(task=task):
                            made = task() if task is Looker else task(robots=3)
                            made.seconds = 2.0
                            return made

                        self.same_as_sync(make, mode)

    def test_infos_are_those_of_the_single_environment(self):
        for mode in AutoresetMode:
            with self.subTest(mode):
                self.same_as_sync(Telling, mode)

    def test_options_of_a_reset_reach_the_task(self):
        env = troupe.envs.VectorEnv(Telling(), 6)
        _, infos = env.reset(seed=1, options={"number": 2})
        self.assertEqual(infos["number"].tolist(), [2] * 6)
        mask = np.repeat([False, True, False], 2)
        _, infos = env.reset(options={"reset_mask": mask, "number": 3})
        self.assertEqual(infos["number"].tolist(), [0, 0, 3, 3, 0, 0])
        self.assertEqual(infos["_number"].tolist(), mask.tolist())
        _, rewards, _, _, infos = env.step(env.action_space.sample())
        self.assertEqual(infos["number"].tolist(), [2, 2, 3, 3, 2, 2])
        self.assertEqual(infos["reward"].tolist(), rewards.tolist())
        self.assertEqual(infos["goal"].shape, (6, 2))
        for _ in range(40):  # at least one more episode
            infos = env.step(np.zeros((6, 2)))[4]
        self.assertEqual(infos["number"].tolist(), [7] * 6, "an episode that begins in a step has no options")
        parallel = troupe.envs.ParallelEnv(Telling())
        for options, number in (({"number": 4}, 4), (None, 7)):
            _, infos = parallel.reset(options=options)
            self.assertEqual([infos[agent]["number"] for agent in ("r0", "r1")], [number, number])
        _, rewards, _, _, infos = parallel.step({})
        self.assertEqual({agent: info["reward"] for agent, info in infos.items()}, rewards)
        single = troupe.envs.Env(Telling())
        self.assertEqual(single.reset(options={"number": 5})[1]["number"], 5)
        for env in (env, parallel, single):
            with self.assertRaises(TypeError) as raised:
                env.reset(options=3)
            self.assertEqual(str(raised.exception), "options: found 3: give a dict")

    def test_a_task_places_bodies(self):
        class Placing(Short):
            starts = ["r", "goal0"]

            def place(self, batch, copies, seeds):
                batch.starts("r")[copies] = np.nan
                for copy in np.flatnonzero(copies):
                    x, y = np.random.default_rng(seeds[copy]).uniform(-1, 1, 2)
                    batch.starts("goal0")[copy] = x, y, 0.0
                if "row" in batch.options:
                    batch.starts("r")[copies] = [(-1.0, y, 0.5) for y in (-1.0, batch.options["row"])]

        env = troupe.envs.VectorEnv(Placing(), 6)
        runs = []
        for seed, options in ((1, {}), (2, {}), (1, {}), (1, {"row": 1.0})):
            observations, _ = env.reset(seed=seed, options=options)
            runs.append((observations.tolist(), [env.unwrapped.batch.core.state_hash(copy) for copy in range(3)]))
        self.assertEqual(runs[0], runs[2], "equal seeds, equal places")
        self.assertTrue(all(a != b for a, b in zip(runs[0][1], runs[1][1])))
        self.assertEqual(env.unwrapped.batch.starts("r")[2].tolist(), [[-1.0, -1.0, 0.5], [-1.0, 1.0, 0.5]])
        self.assertTrue(all(a != b for a, b in zip(runs[0][1], runs[3][1])))
        for _ in range(40):  # at least one more episode, without options
            env.step(np.zeros((6, 2)))
        self.assertTrue(np.isnan(env.unwrapped.batch.starts("r")).all())
        single = troupe.envs.Env(Placing())
        places = [single.reset(seed=seed)[0].tolist() for seed in (5, 6, 5)]
        self.assertEqual(places[0], places[2])
        self.assertNotEqual(places[0], places[1])

        class Outside(Placing):
            def place(self, batch, copies, seeds):
                batch.starts("goal0")[copies] = 1e6, 0.0, 0.0

        with self.assertRaisesRegex(ValueError, '"goal0" cannot be placed at x 1000000'):
            troupe.envs.Env(Outside()).reset(seed=1)
        with self.assertRaises(LookupError):
            single.unwrapped.batch.starts("goal")

    def test_infos_are_not_broadcast(self):
        class Wrong(Short):
            def info(self, batch, team):
                return self.infos

        task = Wrong(2)
        batch = troupe.envs.Batch(task, 3, threads=1)
        batch.reset()
        of = 'Wrong.info(), team "team0": '
        for infos, error, text in (
            ({"x": np.zeros(2)}, ValueError, 'must return an array of the shape (3, 2) (copies, robots of "x"), found (2,)'),
            ({"x": 1.0}, ValueError, 'must return an array of the shape (3, 2) (copies, robots of "x"), found ()'),
            ({"x": np.full((3, 2), "a")}, ValueError, "must return real numbers, found elements of the type <U1"),
            ([1], TypeError, "must return a dict from names to arrays, found [1]"),
            ({"_x": np.zeros((3, 2))}, ValueError, "found the name '_x': give a text that does not begin with an underscore and is "
                                                   "none of finished, alive, final_obs, final_info"),
            ({"alive": np.zeros((3, 2))}, ValueError, "found the name 'alive': give a text that does not begin with an underscore "
                                                      "and is none of finished, alive, final_obs, final_info"),
        ):
            task.infos = infos
            with self.subTest(text), self.assertRaises(error) as raised:
                batch.infos()
            self.assertEqual(str(raised.exception), of + text)

    def test_threads_do_not_show(self):
        runs = []
        for threads in (1, 3):
            env = troupe.envs.VectorEnv(Short(4), 4 * 20, threads=threads, autoreset_mode="SameStep")
            run = [env.reset(seed=1)[0]]
            for step in range(40):
                run += env.step(fixed_actions(env.action_space, step))[:4]
            runs.append(run)
        for one, other in zip(*runs):
            self.assertTrue(np.array_equal(one, other))

    def test_robots_of_a_copy_end_together(self):
        task = Short(4)
        env = troupe.envs.VectorEnv(task, 8)
        observations, _ = env.reset(seed=1)
        finished_alone = False
        for _ in range(60):
            observations, _, terminations, truncations, infos = env.step(task.baseline(observations))
            done = (terminations | truncations).reshape(2, 4)
            self.assertTrue((done.all(axis=1) == done.any(axis=1)).all())
            alone = infos["finished"] & ~done.reshape(-1)
            finished_alone |= alone.any()
        self.assertTrue(finished_alone)

    def test_a_mask_resets_copies(self):
        env = troupe.envs.VectorEnv(Short(2), 6)
        first, _ = env.reset(seed=3)
        stepped = env.step(fixed_actions(env.action_space, 0))[0]
        mask = np.array([False, False, True, True, False, False])
        seeds = [None, 4, None]
        again, _ = env.reset(seed=seeds, options={"reset_mask": mask})
        self.assertTrue(np.array_equal(again[2:4], first[2:4]))
        self.assertTrue(np.array_equal(again[[0, 1, 4, 5]], stepped[[0, 1, 4, 5]]))
        for wrong, error, text in (
            (np.array([True, False, False, False, False, False]), ValueError, "marks only some robots of copy 0: mark all or none of environments 0 to 1"),
            (np.zeros(6, np.bool_), ValueError, "at least one"),
            (np.ones(5, np.bool_), ValueError, r"shape \(6,\)"),
            ([True] * 6, TypeError, "NumPy array of bool"),
        ):
            with self.assertRaisesRegex(error, text):
                env.reset(options={"reset_mask": wrong})

    def test_members_of_a_team_are_lists(self):
        for member, wrong, text in (
            ("observation", "ranges", "Team.observation: must be a list of dicts, found 'ranges'"),
            ("observation", {"near": ["ranges"]}, "Team.observation['near']: must be a list of dicts, found ['ranges']"),
            ("arrays", [], "Team.arrays: must be a dict from names to lists of parts, found []"),
            ("rewards", {"of": "goal"}, "Team.rewards: must be a list of dicts, found {'of': 'goal'}"),
            ("choices", 3, "Team.choices: must be a list of lists of numbers, found 3"),
            ("levels", [1, 2], "Team.levels: must be a list of lists of numbers, found [1, 2]"),
        ):
            task = Short(2)
            task.teams = [dataclasses.replace(task.teams[0], **{member: wrong})]
            with self.subTest(member=member), self.assertRaises(TypeError) as raised:
                troupe.envs.VectorEnv(task, 1)
            self.assertEqual(str(raised.exception), text)

    def test_names_and_shapes_of_parts_are_unique(self):
        eye = {"device": "eye", "field": "color", "shape": (4, 8, 4)}
        for members, text in (
            ({"observation": [lidar()], "arrays": {"observation": [lidar(1)]}}, 'Team.arrays has the name "observation" of an observation: give the array another name'),
            ({"observation": {"near": [lidar()]}, "arrays": {"near": [lidar(1)]}},
             'Team.arrays has the name "near" of an observation: give the array another name'),
            ({"observation": [lidar(), eye]},
             'Team.observation: has a part with a "shape" and other parts: a part with a shape must be the only one of its list'),
        ):
            task = Looker()
            task.teams = [dataclasses.replace(task.teams[0], **{"rewards": [], **members})]
            with self.assertRaises(ValueError) as raised:
                troupe.envs.VectorEnv(task, 3)
            self.assertEqual(str(raised.exception), text)

    def test_the_space_of_a_part_is_checked(self):
        eye = {"device": "eye", "field": "color"}
        for part, error, text in (
            ({**eye, "shape": (4, 8, 3)}, ValueError,
             'array "observation" of team "team0": the field "color" has 128 elements, which do not fill the shape (4, 8, 3)'),
            ({**eye, "shape": 128}, TypeError, 'Team.observation[0]: the value 128 of the member "shape" must be a list of whole numbers from 1'),
            ({**eye, "shape": (-4, -8, 4)}, TypeError,
             'Team.observation[0]: the value (-4, -8, 4) of the member "shape" must be a list of whole numbers from 1'),
            ({"of": "speed", "shape": [3]}, ValueError,
             'Team.observation[0]: a part "speed" has no shape: only a part with the member "field" can have one'),
            ({**lidar(), "low": [0] * 12}, TypeError, f'Team.observation[0]: the value {[0] * 12} of the member "low" must be a number'),
            ({**lidar(), "high": None}, TypeError, 'Team.observation[0]: the value None of the member "high" must be a number'),
            ({**lidar(), "high": float("nan")}, TypeError, 'Team.observation[0]: the value nan of the member "high" must be a number'),
            ({**lidar(), "low": 5, "high": 1}, ValueError,
             'Team.observation[0]: "low" is 5, "high" is 1: the lower bound must not exceed the upper one'),
        ):
            task = Looker()
            task.teams = [dataclasses.replace(task.teams[0], observation=[part])]
            with self.subTest(part), self.assertRaises(error) as raised:
                troupe.envs.VectorEnv(task, 3)
            self.assertEqual(str(raised.exception), text)
        task = Looker()
        task.teams = [dataclasses.replace(task.teams[0], observation=[{**eye, "shape": np.array([4, 32]), "high": np.int64(200)}])]
        env = troupe.envs.VectorEnv(task, 3)
        self.assertEqual(env.reset(seed=1)[0].shape, (3, 4, 32))
        self.assertEqual(env.single_observation_space, gymnasium.spaces.Box(0, 200, (4, 32), np.uint8))

    def test_teams_and_measures_of_a_task_are_lists(self):
        for member, wrong, text in (
            ("teams", Short(2).teams[0], "Short.teams: must be a list of troupe.envs.Team, found Team("),
            ("teams", [{"robots": "r"}], "Short.teams: must be a list of troupe.envs.Team, found [{'robots': 'r'}]"),
            ("measures", "stalls", "Short.measures: must be a list of names of measures, found 'stalls'"),
        ):
            for make in (troupe.envs.Env, troupe.envs.ParallelEnv, lambda task: troupe.envs.VectorEnv(task, 2)):
                task = Short(2)
                setattr(task, member, wrong)
                with self.assertRaisesRegex(TypeError, "^" + re.escape(text)):
                    make(task)

    def test_a_negative_scale_has_bounds_in_order(self):
        task = Short(2)
        task.teams = [dataclasses.replace(task.teams[0], observation=[lidar(-1.0)], rewards=[], ends=[], arrays={})]
        env = troupe.envs.VectorEnv(task, 2)
        space = env.single_observation_space
        self.assertTrue((space.high == 0).all() and (space.low == -3).all(), space)
        self.assertTrue(space.contains(env.reset(seed=1)[0][0]))

    def test_the_observation_space_contains_the_readings_of_all_robots(self):
        def bot(range_max_m):
            eye = {"name": "eye", "kind": "ranger", "transducers": [{"range_max_m": range_max_m}]}
            return {"size_m": [0.3, 0.3, 0.2], "drive": {"kind": "diff"}, "sensors": [eye]}

        task = troupe.envs.Task()
        task.world = {"troupe": 1, "types": {"near": bot(1), "far": bot(3.2)}, "models": [
            {"name": "a", "type": "near"}, {"name": "b", "type": "far", "pose": {"y_m": 1}}]}
        for scale in (1, 0.3, -0.3):  # 3.2 as float32 is above 3.2, and 0.3 times this number rounds to a number above 0.96
            task.teams = [troupe.envs.Team(observation=[{"field": "ranges", "scale": scale}])]
            env = troupe.envs.VectorEnv(task, 2)
            observations, _ = env.reset(seed=1)  # no obstacle is in range: the readings are the largest possible
            for observation, range_max in zip(observations, (1, 3.2)):
                self.assertAlmostEqual(float(observation[0]), range_max * scale, 5)
                self.assertTrue(env.single_observation_space.contains(observation), (scale, observation))
            bounds = env.single_observation_space.low, env.single_observation_space.high
            self.assertAlmostEqual(float(bounds[int(scale > 0)][0]), 3.2 * scale, 5)

    def test_choices_and_levels_fit_the_actions(self):
        for members, error, text in (
            ({"choices": [[1]]}, ValueError, "Team.choices[0] has 1 number: give 2, one per entry of actions"),
            ({"choices": [[1, 0], [1, 0, 1]]}, ValueError, "Team.choices[1] has 3 numbers: give 2, one per entry of actions"),
            ({"choices": np.zeros((3, 1))}, ValueError, "Team.choices[0] has 1 number: give 2, one per entry of actions"),
            ({"choices": []}, ValueError, "Team.choices is empty: give one row or more"),
            ({"choices": [[1, 1.5]]}, ValueError, "Team.choices[0][1] is 1.5: give a number from -1 to 1"),
            ({"choices": [[1, 0], ["0", 1]]}, TypeError, "Team.choices[1][0]: must be a number from -1 to 1, found '0'"),
            ({"levels": [[-1, 1]]}, ValueError, "Team.levels has 1 list: give 2, one per entry of actions"),
            ({"levels": [[0], [0], [0]]}, ValueError, "Team.levels has 3 lists: give 2, one per entry of actions"),
            ({"levels": [[0], []]}, ValueError, "Team.levels[1] is empty: give one number or more"),
            ({"levels": [[0], [float("nan")]]}, ValueError, "Team.levels[1][0] is nan: give a number from -1 to 1"),
            ({"choices": [[0, 0]], "levels": [[0], [0]]}, ValueError,
             "Team.choices and Team.levels are both given: give one of them, because each defines the action space"),
        ):
            task = Short(2)
            task.teams = [dataclasses.replace(task.teams[0], **members)]
            with self.subTest(members), self.assertRaises(error) as raised:
                troupe.envs.VectorEnv(task, 2)
            self.assertEqual(str(raised.exception), text)
        task = Short(2)
        task.teams = [dataclasses.replace(task.teams[0], choices=np.eye(2, dtype=np.float32))]
        self.assertEqual(troupe.envs.VectorEnv(task, 2).single_action_space, gymnasium.spaces.Discrete(2))

    def test_actions_and_commands_are_not_broadcast(self):
        class Acting(Short):
            commands = None

            def act(self, batch, team, actions):
                return actions if self.commands is None else self.commands

        batch = troupe.envs.Batch(Acting(2), 3, threads=1)
        batch.reset()
        batch.step([np.zeros((3, 2, 2))])
        for wrong, text in (
            ([np.zeros((3, 2, 1))], 'actions of team "team0": must have the shape (3, 2, 2), found (3, 2, 1)'),
            (np.zeros((1, 2, 2)), 'actions of team "team0": must have the shape (3, 2, 2), found (2, 2)'),
            ([np.zeros((3, 2, 2))] * 2, "actions: found 2: give 1, one array per team"),
        ):
            with self.assertRaises(ValueError) as raised:
                batch.step(wrong)
            self.assertEqual(str(raised.exception), text)
        for commands in (np.zeros((3, 2, 1)), np.zeros((2, 2)), 0.0):
            batch.task.commands = commands
            with self.assertRaises(ValueError) as raised:
                batch.step([np.zeros((3, 2, 2))])
            self.assertEqual(
                str(raised.exception),
                'Acting.act(), team "team0": must return an array of the shape (3, 2, 2) (copies, robots, commands), '
                f"found {np.shape(commands)}",
            )

        class Rewarding(Short):
            result = None

            def reward(self, batch, team):
                return self.result

            def terminated(self, batch, team):
                return None if self.result is None else np.zeros(self.ends, np.bool_)

        batch = troupe.envs.Batch(Rewarding(2), 2, threads=1)
        for rewards, ends, text in (
            ((2,), (2, 2), "reward(), team \"team0\": must return an array of the shape (2, 2) (copies, robots), found (2,)"),
            ((2, 1), (2, 2), "reward(), team \"team0\": must return an array of the shape (2, 2) (copies, robots), found (2, 1)"),
            ((2, 2), (2,), "terminated(), team \"team0\": must return an array of the shape (2, 2) (copies, robots), found (2,)"),
        ):
            batch.reset()
            batch.task.result, batch.task.ends = np.zeros(rewards), ends
            with self.assertRaises(ValueError) as raised:
                batch.step([np.zeros((2, 2, 2))])
            self.assertEqual(str(raised.exception), f"Rewarding.{text}")

        task = Short(2)
        task.teams = [dataclasses.replace(task.teams[0], levels=[[-1, 1], [0, 1]])]
        batch = troupe.envs.Batch(task, 3, threads=1)
        batch.reset()
        batch.step([np.ones((3, 2, 2), np.int64)])
        self.assertTrue((batch.core.actions() == 1).all())
        for columns in (1, 3):
            with self.assertRaisesRegex(ValueError, rf"must have the shape \(3, 2, 2\), found \(3, 2, {columns}\)"):
                batch.step([np.ones((3, 2, columns), np.int64)])

    def test_a_task_may_change_the_array_of_actions(self):
        class Halving(Short):
            def act(self, batch, team, actions):
                actions *= 0.5
                return actions

        env, halved = troupe.envs.VectorEnv(Halving(2), 4), troupe.envs.VectorEnv(Short(2), 4)
        env.reset(seed=1)
        halved.reset(seed=1)
        for dtype in (np.float64, np.float32):
            actions = np.full((4, 2), 0.5, dtype)
            self.assertTrue(np.array_equal(env.step(actions)[0], halved.step(actions / 2)[0]))
            self.assertTrue((actions == 0.5).all(), "the actions of the program are unchanged")

    def test_observed_columns_of_the_task_are_not_broadcast(self):
        class Observing(Short):
            def observe(self, batch, team, name):
                return self.columns(batch)

        def make(columns, robots=2):
            task = Observing(robots)
            task.columns = columns
            return troupe.envs.Batch(task, 3, threads=1)

        for robots, columns, found in (
            (2, np.zeros((2, 3)), "(2, 3)"),  # without the axis of copies
            (3, np.zeros((3, 3)), "(3, 3)"),  # without the axis of columns, in as many copies as robots
            (2, np.zeros((3, 1, 1)), "(3, 1, 1)"),
            (2, 1.0, "()"),
        ):
            with self.subTest(found), self.assertRaises(ValueError) as raised:
                make(lambda batch, columns=columns: columns, robots)
            self.assertEqual(
                str(raised.exception),
                f'Observing.observe(), team "team0": must return an array of the shape (3, {robots}, any) (copies, robots, columns '
                f'of "observation"), found {found}',
            )
        batch = make(lambda batch: np.full((batch.copies, 2, 1), 0.5).tolist())
        batch.reset()
        self.assertTrue((batch.observations()[..., -1] == 0.5).all())
        self.assertTrue(batch.observation_spaces[0].contains(batch.observations()[0, 0]))
        for columns, found in ((lambda batch: np.zeros((batch.copies, 2, 2)), r"\(3, 2, 2\)"), (lambda batch: None, "None")):
            batch.task.columns = columns
            with self.assertRaisesRegex(ValueError, rf'of the shape \(3, 2, 1\) \(copies, robots, columns of "observation"\), found {found}$'):
                batch.observations()

        class Seeing(Looker):
            def observe(self, batch, team, name):
                return np.zeros((batch.copies, 3, 1))

        with self.assertRaises(ValueError) as raised:
            troupe.envs.VectorEnv(Seeing(), 3)
        self.assertEqual(
            str(raised.exception),
            'Seeing.observe(), team "team0": must return None for the array "picture", which has a part with a "shape" and can '
            "have no other columns",
        )

    def test_results_of_the_task_are_real_numbers_and_bools(self):
        class Returning(Short):
            commands = gains = marks = None

            def act(self, batch, team, actions):
                return actions if self.commands is None else self.commands

            def reward(self, batch, team):
                return self.gains

            def terminated(self, batch, team):
                return self.marks

        for member, values, text in (
            ("commands", np.full((1, 2, 2), 1j), 'act(), team "team0": must return real numbers, found elements of the type complex128'),
            ("gains", np.full((1, 2), None), 'reward(), team "team0": must return real numbers, found elements of the type object'),
            ("marks", np.zeros((1, 2)), 'terminated(), team "team0": must return bools, found elements of the type float64'),
        ):
            batch = troupe.envs.Batch(Returning(2), 1, threads=1)
            batch.reset()
            setattr(batch.task, member, values)
            with self.assertRaises(ValueError) as raised:
                batch.step([np.zeros((1, 2, 2))])
            self.assertEqual(str(raised.exception), f"Returning.{text}")

    def test_a_step_that_an_exception_has_ended_needs_a_reset(self):
        class Failing(Short):
            error = None

            def reward(self, batch, team):
                if self.error is not None:
                    raise self.error
                return None

        for make in (troupe.envs.Env, troupe.envs.ParallelEnv, lambda task: troupe.envs.VectorEnv(task, 6)):
            one, other = make(Failing(2)), make(Failing(2))
            vector = isinstance(one, troupe.envs.VectorEnv)
            action = {} if isinstance(one, troupe.envs.ParallelEnv) else np.zeros(one.action_space.shape)
            for error in (KeyboardInterrupt, ZeroDivisionError):
                one.reset(seed=3)
                one.step(action)
                one.task.error = error
                with self.assertRaises(error):
                    one.step(action)
                one.task.error = None
                with self.assertRaisesRegex(RuntimeError, "after a step or reset that an exception has ended"):
                    one.step(action)
                if vector:  # a reset of some copies is not enough
                    one.reset(options={"reset_mask": np.array([True, True, False, False, True, True])})
                    with self.assertRaisesRegex(RuntimeError, r"\(1 of 3 copies need a reset\)"):
                        one.step(action)
                self.assertTrue(data_equivalence(one.reset(seed=4), other.reset(seed=4), exact=True))
                self.assertTrue(data_equivalence(one.step(action), other.step(action), exact=True))
            if not vector:
                continue
            with self.assertRaisesRegex(ValueError, "is nan: give finite numbers"):
                one.step(np.full(one.action_space.shape, np.nan))  # an error before the copies have made their step
            self.assertTrue(data_equivalence(one.step(action), other.step(action), exact=True))

    def test_wrong_arguments_of_a_batch_change_nothing(self):
        batch, other = (troupe.envs.Batch(Short(2), 3, threads=1) for _ in range(2))
        still = [np.zeros((3, 2, 2))]
        for each in (batch, other):
            each.reset(seeds=(4, 5, 6))
        for call, error, text in (
            (lambda: batch.reset([True]), ValueError, "which: found [True]: give one bool for each of the 3 copies"),
            (lambda: batch.reset(np.ones(3, int)), ValueError, "which: found array([1, 1, 1]): give one bool for each of the 3 copies"),
            (lambda: batch.reset(seeds=[1, 2]), ValueError, "seeds: found a list of 2 seeds: give 3, one per copy"),
            (lambda: batch.reset(seeds=7), TypeError, "seeds: found 7: give a list with one seed or None per copy"),
            (lambda: batch.step(still, [0, 1, 0]), ValueError, "begins: found [0, 1, 0]: give one bool for each of the 3 copies"),
        ):
            with self.subTest(text), self.assertRaises(error) as raised:
                call()
            self.assertEqual(str(raised.exception), text)
        for each, begins in ((batch, [False, True, False]), (other, np.array([False, True, False]))):
            each.step(still)
            each.step(still, begins)
            each.reset(begins)
        self.assertTrue(np.array_equal(batch.observations(), other.observations()))

    def test_an_episode_that_cannot_begin_makes_all_copies_need_a_reset(self):
        class Crowded:
            """The core of a batch in which an episode cannot begin, because robots find no place."""

            def __init__(self, core):
                self.core = core

            def __getattr__(self, name):
                return getattr(self.core, name)

            def step(self, begins):
                raise troupe.InputError("placed 254 of 2000 bodies")

        batch = troupe.envs.Batch(Short(2), 2, threads=1)
        batch.reset()
        core, batch.core = batch.core, Crowded(batch.core)
        actions = np.zeros((2, 2, 2))
        actions[1] = np.nan  # of the copy that begins an episode: not used
        with self.assertRaisesRegex(troupe.InputError, "placed 254"):
            batch.step([actions], [False, True])
        batch.core = core
        with self.assertRaisesRegex(RuntimeError, "2 of 2 copies need a reset"):
            batch.step([np.zeros((2, 2, 2))])

    def test_rewards_are_finite(self):
        class Rewarding(Short):
            wrong = np.nan

            def reward(self, batch, team):
                return np.array([[0, 0], [0, self.wrong]])

        batch = troupe.envs.Batch(Rewarding(2), 2, threads=1)
        for wrong in (np.nan, -np.inf):
            batch.task.wrong = wrong
            batch.reset()
            with self.assertRaises(ValueError) as raised:
                batch.step([np.zeros((2, 2, 2))])
            self.assertEqual(
                str(raised.exception),
                f'Rewarding.reward(), team "team0": returned {wrong} for robot "r1" in copy 1 (counted from 0) at tick 2: '
                "return finite rewards",
            )
        task = Short(2)
        task.measures = ["mean_nearest_distance:r1"]  # NaN, because a group of one robot has no nearest robots
        task.teams[0].rewards = [{"measure": "mean_nearest_distance:r1"}]
        env = troupe.envs.VectorEnv(task, 4)
        env.reset(seed=1)
        text = 'reward 0 of team "team0": the value of measure "mean_nearest_distance_m:r1" is nan for robot "r0" in copy 0 at tick 2'
        with self.assertRaisesRegex(troupe.StepError, text):
            env.step(np.zeros((4, 2)))

    def test_the_seeds_of_copies_begin_again_at_0(self):
        env = troupe.envs.VectorEnv(Short(2), 6)
        env.reset(seed=2**64 - 1)
        self.assertEqual(env.batch.core.seeds.tolist(), [2**64 - 1, 0, 1])

    def test_seeds_may_be_a_list(self):
        for seeds in ([7, 3, 7], [None, 5, 0], (2, 2, 9), np.array([4, 1, 4])):
            with self.subTest(seeds=seeds):
                listed = [None if each is None else int(each) for each in seeds]
                sync = SyncVectorEnv([lambda: troupe.envs.Env(Short(2), robot="r0") for _ in range(3)])
                own = troupe.envs.VectorEnv(Short(2), 3, robot="r0")
                of_all = troupe.envs.VectorEnv(Short(2), 6)
                per_env = troupe.envs.VectorEnv(Short(2), 6)
                for env in (sync, own, of_all, per_env):
                    env.reset(seed=11)  # an environment without a seed of its own begins the next episode of this seed
                if None not in listed:  # SyncVectorEnv's first environment would have the seed 11, the second 12, ...
                    self.assertTrue(np.array_equal(own.reset(seed=seeds)[0], sync.reset(seed=listed)[0]))
                first, _ = of_all.reset(seed=seeds)
                again, _ = per_env.reset(seed=[each for each in listed for _ in range(2)])
                self.assertTrue(np.array_equal(first, again))
                self.assertEqual(np.array_equal(first[:2], first[4:]), listed[0] == listed[2])
                for index, each in enumerate(listed):
                    if each is not None:
                        self.assertEqual(of_all.batch.core.seeds[index], each)
        env = troupe.envs.VectorEnv(Short(2), 6)
        for wrong, text in (
            ([1, 2], "seed: found a list of 2 seeds: give 3, one per copy, or 6, one per environment"),
            ([1, 1, 2, 3, 4, 4], "seed: environments 2 and 3 share one world, but have the seeds 2 and 3"),
            ([1, None, 2, 2, 4, 4], "environments 0 and 1 share one world, but have the seeds 1 and None"),
        ):
            with self.assertRaisesRegex(ValueError, text):
                env.reset(seed=wrong)
        for wrong, found in ((1.5, "1.5"), ("12", "'12'"), ([1, 2.0, 3], "2.0"), (np.array([1.0, 2, 3]), ".*1.0.*")):
            with self.assertRaisesRegex(TypeError, f"^seed: found {found}: give a whole number"):
                env.reset(seed=wrong)
        with self.assertRaisesRegex(ValueError, "found a list of 2 seeds: give 3, one per copy$"):
            troupe.envs.VectorEnv(Short(2), 3, robot="r0").reset(seed=[1, 2])

    def test_by_the_registry(self):
        envs = gymnasium.make_vec("troupe/Navigation-v0", num_envs=4, vectorization_mode="vector_entry_point", robots=3)
        self.assertIsInstance(envs.unwrapped, troupe.envs.VectorEnv)
        self.assertEqual(envs.reset(seed=1)[0].shape, (4, 18))
        for steps in (3, np.int64(3)):  # the argument that gymnasium.make() has, too
            short = gymnasium.make_vec("troupe/Navigation-v0", num_envs=2, max_episode_steps=steps)
            short.reset(seed=1)
            self.assertEqual([short.step(np.zeros((2, 2)))[3].tolist() for _ in range(4)], [[False] * 2] * 2 + [[True] * 2, [False] * 2])
        task = Short(2)
        task.ticks = 2  # 15 steps
        for steps, last in ((7, 7), (100, 15)):
            envs = troupe.envs.VectorEnv(task, 2, max_episode_steps=steps)
            envs.reset(seed=1)
            ends = [bool(envs.step(np.zeros((2, 2)))[3].all()) for _ in range(16)]
            self.assertEqual(ends.index(True) + 1, last)
            single, parallel = troupe.envs.Env(task, max_episode_steps=steps), troupe.envs.ParallelEnv(task, max_episode_steps=steps)
            single.reset(seed=1)
            parallel.reset(seed=1)
            for step in range(1, last + 1):
                self.assertEqual(single.step(np.zeros(2))[3], step == last)
                self.assertEqual(set(parallel.step({})[3].values()), {step == last})
        for steps in (0, -1, 2.5, "3"):
            with self.assertRaisesRegex(ValueError, "^" + re.escape(f"max_episode_steps={steps!r}: give a whole number above 0, or None")):
                troupe.envs.VectorEnv(task, 2, max_episode_steps=steps)
        for kind in (troupe.envs.Batch, troupe.envs.Env, troupe.envs.ParallelEnv, troupe.envs.VectorEnv):
            self.assertIn("max_episode_steps", inspect.signature(kind.__init__).parameters)
        self.assertEqual(set(troupe.envs.TASKS), {name[7:-3] for name in gymnasium.registry if name.startswith("troupe/")})

    def test_says_what_is_wrong(self):
        teamless = Short(2)
        teamless.teams = None
        for wrong, text in (
            (lambda: troupe.envs.Env(teamless), "Short has no teams: set its member `teams`"),
            (lambda: troupe.envs.VectorEnv(teamless, 2), "Short has no teams: set its member `teams`"),
            (lambda: room(0.2, [], {}), "size=0.2: give the length of a side of the room, above 0.2 m"),
            *((lambda size=size: troupe.envs.Dispersion(size=size),
               f"^size={size}: give the length of a side of the room, at least 1 m, because bodies are placed 0.5 m from its sides$")
              for size in (0, 0.9, float("nan"))),
            (lambda: troupe.envs.VectorEnv(Short(2), 2).reset(seed=2**64), "seed: found 18446744073709551616: give a whole number from 0 to"),
            (lambda: troupe.envs.Env(Short(2)).reset(seed=2**64), "seed: found 18446744073709551616: give a whole number from 0 to"),
            (lambda: troupe.envs.VectorEnv(Short(2), 3), "2 robots learn in each copy: give a multiple of 2"),
            (lambda: troupe.envs.VectorEnv(Walkers(), 2), "^VectorEnv needs a task with one team, but Walkers has 2: set"),
            (lambda: troupe.envs.Env(Walkers()), "^Env needs a task with one team, but Walkers has 2: set"),
            (lambda: troupe.envs.VectorEnv(Short(2), 2, autoreset_mode="next"),
             "^unknown autoreset_mode 'next'; known: NextStep, SameStep, Disabled$"),
            (lambda: troupe.envs.VectorEnv(Short(2), 2, render_mode="ansi"), 'unknown render_mode "ansi"; known: human, rgb_array'),
        ):
            with self.assertRaisesRegex(ValueError, text):
                wrong()
        for env in (troupe.envs.Env(Short(2)), troupe.envs.VectorEnv(Short(2), 2), troupe.envs.ParallelEnv(Short(2))):
            for seed, error in ((-1, ValueError), (1.5, TypeError)):
                with self.assertRaises(error) as raised:
                    env.reset(seed=seed)
                text = str(raised.exception)
                if seed == -1 or not isinstance(env, troupe.envs.VectorEnv):
                    self.assertEqual(text, f"seed: found {seed}: give a whole number from 0 to {2**64 - 1}")
                else:
                    self.assertEqual(text, "seed: found 1.5: give a whole number, or a list with one seed per copy")
        for wrong in (4.0, "4", None, True, 0):
            with self.assertRaisesRegex(ValueError, re.escape(f"num_envs={wrong!r}: give a whole number above 0")):
                troupe.envs.VectorEnv(Short(2), wrong)
        self.assertIs(type(troupe.envs.VectorEnv(Short(2), np.int64(4)).num_envs), int)
        env = troupe.envs.VectorEnv(Short(2), 4)
        env.reset(seed=1)
        with self.assertRaisesRegex(ValueError, r"actions: must have the shape \(4, 2\), found \(2, 2\)"):
            env.step(np.zeros((2, 2)))
        with self.assertRaisesRegex(ValueError, 'action 1 of "r1" in copy 0 \(both counted from 0\) is nan'):
            env.step(np.array([[0, 0], [0, np.nan], [0, 0], [0, 0]]))
        task = Short(2)
        task.teams[0].observation = [{"of": "pose", "hihg": 1}]
        with self.assertRaisesRegex(ValueError, 'unknown member "hihg"; known: .*high, low, .*shape.*did you mean "high"'):
            troupe.envs.Env(task)
        task = Short(2)
        task.seconds = None
        with self.assertRaisesRegex(TypeError, "^Short.seconds: must be a number of seconds, found None$"):
            troupe.envs.Env(task)
        task = Short(2)
        task.second = 5.0
        for make in (troupe.envs.Env, troupe.envs.ParallelEnv, lambda task: troupe.envs.VectorEnv(task, 2)):
            with self.assertWarnsRegex(UserWarning, 'Short has the attribute "second", which Task does not use: did you mean "seconds"') as told:
                make(task)
            self.assertEqual(told.filename, __file__)
        for wrong in (0, 1, ""):
            for make in (troupe.envs.Env, lambda task, robot: troupe.envs.VectorEnv(task, 2, robot=robot)):
                with self.assertRaises(TypeError) as raised:
                    make(Short(2), robot=wrong)
                self.assertEqual(str(raised.exception), f'robot: found {wrong!r}: give the name of a robot, such as "r0"')
        with self.assertRaisesRegex(LookupError, 'no model "robot" in '):  # it is the name of the type
            troupe.envs.Env(Short(2), robot="robot")
        with self.assertRaisesRegex(LookupError, 'has no device "lidr"; it has: lidar'):
            task = Short(2)
            task.teams[0].observation = [{"device": "lidr", "field": "ranges"}]
            troupe.envs.Env(task)
        for listed, text in (
            ([], "which is empty: add it there"),
            (["displacement"], "which contains displacement_m: add it there"),
        ):
            for member in ("rewards", "ends"):
                task = Short(2)
                task.measures = listed
                entry = {"measure": "stalls"} if member == "rewards" else {"measure": "stalls", "above": 1}
                task.teams[0] = dataclasses.replace(task.teams[0], **{member: [entry]})
                with self.assertRaises(LookupError) as raised:
                    troupe.envs.Env(task)
                self.assertEqual(
                    raised.exception.args[0],
                    f'{member[:-1]} of team "team0": the measure "stalls" is not in the list `measures` of the task, {text}')
        with self.assertRaisesRegex(ValueError, "batch/teams/0/rewards/0: unknown member \"wieght\""):
            task = Short(2)
            task.teams[0].rewards = [{"array": "goal", "wieght": 1}]
            troupe.envs.Env(task)


def per_robot():
    """Returns the class PerRobot of the example train_navigation.py, without the libraries for training that the example
    imports: it needs only Gymnasium and NumPy."""
    file = ROOT / "python/examples/train_navigation.py"
    classes = [each for each in ast.parse(file.read_text()).body if isinstance(each, ast.ClassDef) and each.name == "PerRobot"]
    names = {"gymnasium": gymnasium, "np": np}
    exec(compile(ast.Module(classes, []), str(file), "exec"), names)
    return names["PerRobot"]


class EpisodesPerRobot(unittest.TestCase):
    def test_end_when_the_robot_is_finished_and_in_the_step_that_begins_the_next_one(self):
        for robots in (1, 2):
            with self.subTest(robots=robots):
                task = Short(robots)
                env = troupe.envs.VectorEnv(task, 4 * robots, threads=1)
                wrapped = per_robot()(troupe.envs.VectorEnv(task, 4 * robots, threads=1))
                observations, _ = env.reset(seed=1)
                self.assertTrue(np.array_equal(wrapped.reset(seed=1)[0], observations))
                begins = np.zeros(env.num_envs, np.bool_)
                seen = set()
                for _ in range(80):
                    actions = task.baseline(observations)
                    observations, rewards, terminations, truncations, infos = env.step(actions)
                    of_robots = wrapped.step(actions)
                    self.assertEqual("finished" in infos, robots > 1)
                    ended = (infos["finished"] if robots > 1 else terminations) | begins
                    for one, other in zip(of_robots, (observations, rewards, ended, truncations & ~ended)):
                        self.assertTrue(np.array_equal(one, other))
                    self.assertEqual(of_robots[4], {})
                    begins = terminations | truncations
                    seen |= {name for name, marks in (("begins", begins), ("terminated", terminations), ("truncated", truncations))
                             if marks.any()}
                self.assertEqual(seen, {"begins", "terminated", "truncated"})


class RobotsThatAreBorn(unittest.TestCase):
    """The robots r0 to r2 of each copy are there from the start, r3 is born after 1 s (tick 10), r4 never."""

    ENDS = ({"measure": "alive", "above": 3.5, "reward": 100.0},)  # when r3 is born

    def run_vector(self, task, mode, steps):
        env = troupe.envs.VectorEnv(task, 10, autoreset_mode=mode)
        env.reset(seed=1)
        out = [env.step(np.full((10, 2), -1.0)) for _ in range(steps)]
        for _, rewards, terminations, truncations, _ in out:
            done = (terminations | truncations).reshape(2, 5)
            self.assertTrue((done.all(axis=1) == done.any(axis=1)).all(), "the robots of a copy end together")
            self.assertTrue(np.isfinite(rewards).all())
        return out

    def test_only_robots_in_the_world_are_rewarded(self):
        out = self.run_vector(Births(), "NextStep", 20)
        for step, (observations, rewards, terminations, truncations, infos) in enumerate(out):
            there = np.tile([True, True, True, step >= 9, False], 2)  # the first tick of an episode has no actions
            self.assertTrue(np.array_equal(infos["alive"], there), step)
            self.assertTrue(np.array_equal(rewards, np.where(there, 31.0 if step < 9 else 41.0, 0.0)), (step, rewards))
            self.assertFalse(terminations.any() or infos["finished"].any())
            self.assertEqual(truncations.all(), step == 19)
            self.assertFalse(observations[~there].any())
            self.assertTrue(observations[there].any(axis=1).all())

    def test_columns_of_the_task_are_0_for_robots_that_are_not_in_the_world(self):
        class Constant(Births):
            def observe(self, batch, team, name):
                return np.full((batch.copies, 5, 1), -1.0, np.float32)

        observations, *_ = self.run_vector(Constant(), "NextStep", 1)[0]
        self.assertEqual(observations[:5, -1].tolist(), [-1.0, -1.0, -1.0, 0.0, 0.0])

    def test_a_measure_ends_the_episode_of_all(self):
        for mode in ("NextStep", "SameStep"):
            with self.subTest(mode):
                out = self.run_vector(Births(self.ENDS), mode, 12)
                ends = [terminations.all() for _, _, terminations, _, _ in out]
                self.assertEqual(ends.index(True), 9)
                self.assertFalse(any(truncations.any() for _, _, _, truncations, _ in out))
                _, rewards, _, _, infos = out[9]
                self.assertTrue(np.array_equal(rewards, np.tile([141.0, 141.0, 141.0, 141.0, 0.0], 2)))
                last = infos["final_info"] if mode == "SameStep" else infos
                for name in ("finished", "alive"):
                    self.assertTrue(np.array_equal(last[name], np.tile([True, True, True, True, False], 2)))
                    self.assertTrue(last[f"_{name}"].all())
                if mode == "SameStep":  # the other infos are those of the next episode, in which r3 has not been born
                    self.assertEqual([each.shape for each in infos["final_obs"]], [(12,)] * 10)
                    self.assertFalse(infos["finished"].any())
                    self.assertTrue(np.array_equal(infos["alive"], np.tile([True, True, True, False, False], 2)))

    def test_only_episodes_that_have_ended_have_final_infos(self):
        task = Short(2)
        env = troupe.envs.VectorEnv(task, 6, autoreset_mode="SameStep")
        observations, _ = env.reset(seed=1)
        counts = set()
        for _ in range(60):
            observations, _, terminations, truncations, infos = env.step(task.baseline(observations))
            done = terminations | truncations
            counts.add(int(done.sum()))
            self.assertEqual("final_info" in infos, bool(done.any()))
            if done.any():
                self.assertTrue(all(last.base is None for last in infos["final_obs"][done]), "no views of all observations")
                self.assertTrue(np.array_equal(infos["final_info"]["_finished"], done))
                self.assertTrue(np.array_equal(infos["final_info"]["alive"], done))
                self.assertFalse((infos["finished"] & done).any())
        self.assertIn(2, counts)

    def test_a_function_finishes_only_robots_in_the_world(self):
        _, rewards, terminations, truncations, infos = self.run_vector(Births(finishes=True), "NextStep", 1)[0]
        self.assertTrue(terminations.all())
        self.assertFalse(truncations.any())
        self.assertTrue(np.array_equal(infos["finished"], infos["alive"]))
        self.assertTrue(np.array_equal(rewards, np.tile([31.0, 31.0, 31.0, 0.0, 0.0], 2)))

    def test_agents_join(self):
        env = troupe.envs.ParallelEnv(Births(self.ENDS))
        observations, _ = env.reset(seed=1)
        self.assertEqual(env.possible_agents, ["r0", "r1", "r2", "r3", "r4"])
        self.assertEqual([*observations], ["r0", "r1", "r2"])
        for step in range(10):
            observations, rewards, terminations, truncations, infos = env.step({agent: np.full(2, -1.0) for agent in env.agents})
            names = ["r0", "r1", "r2"] + ["r3"] * (step == 9)
            for told in (observations, rewards, terminations, truncations, infos):
                self.assertEqual([*told], names)
            self.assertEqual(set(rewards.values()), {31.0 if step < 9 else 141.0})
            self.assertEqual(set(terminations.values()), {step == 9})
        self.assertEqual(env.agents, [])


class Teams(unittest.TestCase):
    """Two unlike teams: bots with a differential drive and a Box of actions, and an omnidirectional cart with MultiDiscrete
    actions and a Dict of observations."""

    def test_each_has_its_own_spaces_and_commands(self):
        env = troupe.envs.ParallelEnv(Walkers())
        self.assertEqual(env.action_space("r0"), gymnasium.spaces.Box(-1.0, 1.0, (2,), np.float32))
        self.assertEqual(env.action_space("cart"), gymnasium.spaces.MultiDiscrete([3, 2, 2]))
        self.assertEqual(env.observation_space("r0").shape, (4,))
        self.assertEqual({name: box.shape for name, box in env.observation_space("cart").items()}, {"eye": (5,), "where": (4,)})
        before, _ = env.reset(seed=5)
        for action, moved in (([2, 1, 0], [0.2, 0.2]), ([1, 0, 0], [0.0, -0.2]), ([0, 1, 0], [-0.2, 0.2])):
            # Bots turn left on the spot; a tick is 0.2 s.
            actions = {agent: np.array([-1.0, 1.0]) for agent in env.agents if agent != "cart"} | {"cart": np.array(action)}
            after, _, _, _, _ = env.step(actions)
            change = after["cart"]["where"][:2] - before["cart"]["where"][:2]
            self.assertTrue(np.allclose(change, moved, atol=1e-6), (action, change))
            before = after
        with self.assertRaisesRegex(ValueError, r"column 1 \(counted from 0\): must be whole numbers from 0 to 1, found "):
            env.step({"cart": np.array([2, 2, 0])})

    def test_observations_are_those_of_the_world_alone(self):
        env = troupe.envs.ParallelEnv(Walkers())
        seen, _ = env.reset(seed=9)
        world = troupe.Simulation(ROOM, seed=9)
        bots, cart = world.swarm("bot"), world.swarm("cart")
        bots.subscribe()
        cart.subscribe()
        speeds = np.zeros((len(bots), 2))
        world.step(1)  # the first tick of an episode
        for step in range(6):
            for at, name in enumerate(env.possible_agents[:6]):
                self.assertTrue(np.array_equal(seen[name][:3], np.asarray(world.find(name).readings("ranges"), np.float32)), (step, at))
            eye = np.asarray(world.find("cart").readings("ranges"), np.float64) * 0.5
            self.assertTrue(np.array_equal(seen["cart"]["eye"], eye.astype(np.float32)), step)
            action = fixed_actions(env.action_space("r0"), step)
            # DRIVE: the numbers -1 and 1 are 0 and 0.5 m/s, and -1.5 and 1.5 rad/s.
            speeds[:] = (float(action[0]) + 1) * 0.5 * 0.5, -1.5 + (float(action[1]) + 1) * 0.5 * 3.0
            bots.set_speeds(speeds[:, 0], speeds[:, 1])
            cart.set_speeds(np.ones(1), np.zeros(1), left=np.full(1, -1.0))
            world.step(1)
            actions = {agent: action for agent in env.agents if agent != "cart"} | {"cart": np.array([2, 0, 0])}
            seen, _, _, _, _ = env.step(actions)


@needs_view
class Human(unittest.TestCase):
    def shown(self, env, reset, step, batch):
        """Steps an environment in the mode human while a user looks at its page. Returns the state hashes of the steps, the
        state that the page got last, the first text to the page in each episode, and the wall time of the first episode, s."""
        told = io.StringIO()
        began = time.perf_counter()  # before the pace begins: a run that is late catches up
        with contextlib.redirect_stderr(told):
            reset(5)
        self.assertEqual(told.getvalue(), f"troupe: the world is shown at {env.renderer.address}\n")
        port, token = env.renderer.address.removeprefix("http://127.0.0.1:").split("/#")
        hashes, texts = [], []
        with Socket(int(port)) as user:
            user.send(token)
            texts.append(user.receive())
            self.assertEqual(user.ask(do="pause")["reason"], "this address is read-only")
            for _ in range(8):
                step()
                hashes.append(batch().core.state_hash(0))
            wall_s = time.perf_counter() - began
            reset(6)
            step()
            step()
            hashes.append(batch().core.state_hash(0))
            state = {}
            while state.get("run") != 2:
                message = user.receive()
                if isinstance(message, bytes):
                    user.send('{"do": "drawn"}')
                elif message["type"] == "hello":
                    texts.append(message)
                else:
                    state = message
        self.assertIsNone(env.render())
        env.close()
        with self.assertRaises(OSError):
            Socket(int(port))
        return hashes, state, texts, wall_s

    def test_a_page_shows_the_first_copy_in_real_time_and_changes_nothing(self):
        def single(mode):
            env = troupe.envs.Env(Short(2), render_mode=mode)
            return env, lambda seed: env.reset(seed=seed), lambda: env.step(np.array([1.0, 0.5])), lambda: env.batch

        def vector(mode):
            env = troupe.envs.VectorEnv(Short(2), 6, render_mode=mode)
            return env, lambda seed: env.reset(seed=seed), lambda: env.step(np.full((6, 2), 0.5)), lambda: env.batch

        def parallel(mode):
            env = troupe.envs.ParallelEnv(Short(2), render_mode=mode)
            step = lambda: env.step({name: np.array([1.0, 0.5]) for name in env.agents})  # noqa: E731
            return env, lambda seed: env.reset(seed=seed), step, lambda: env.batch

        for make in (single, vector, parallel):
            with self.subTest(make.__name__):
                hashes, state, texts, wall_s = self.shown(*make("human"))
                self.assertEqual([text["type"] for text in texts], ["hello", "hello"])
                self.assertFalse(texts[0]["may_steer"])
                self.assertNotEqual(texts[0]["header"], texts[1]["header"], "the seeds place the robots differently")
                self.assertLessEqual(state["tick"], 3)
                self.assertGreater(wall_s, 0.64)  # eight ticks of 0.1 s
                env, reset, step, batch = make(None)
                reset(5)
                alone = []
                for _ in range(8):
                    step()
                    alone.append(batch().core.state_hash(0))
                reset(6)
                step()
                step()
                self.assertEqual(hashes, [*alone, batch().core.state_hash(0)])

    def test_a_view_released_during_a_step_ends_after_the_step(self):
        batch = troupe.envs.VectorEnv(Short(2), 4).batch.core
        batch.reset()
        with tempfile.TemporaryDirectory() as folder:
            view = batch.view(rate=0.001, out=folder)  # a tick of 0.1 s would take 100 s
            stepping = threading.Thread(target=lambda: [batch.step() for _ in range(3)], daemon=True)
            stepping.start()
            time.sleep(0.5)  # the view may be released before the first step, too
            del view
            stepping.join(WAIT_S)
            self.assertFalse(stepping.is_alive())
        self.assertEqual(batch.tick(), batch.tick(1))

    def test_says_which_copies_there_are(self):
        batch = troupe.envs.VectorEnv(Short(2), 4).batch.core
        with self.assertRaisesRegex(IndexError, "copy 2 does not exist: give a number from 0 to 1"):
            batch.view(2)
        for call in (batch.tick, batch.state_hash, batch.picture):
            with self.assertRaisesRegex(LookupError, "copy 2 does not exist: give a number from 0 to 1"):
                call(2)
        for call in (batch.robots, batch.names, batch.actions, batch.rewards, batch.terminated, batch.alive):
            with self.assertRaisesRegex(LookupError, "team 1 does not exist: give a number from 0 to 0"):
                call(1)
        for seeds, error, text in (
            ([1, -1], ValueError, "seed: found -1: give a whole number from 0 to "),
            ([1, 1.5], TypeError, "seed: found 1.5: give a whole number from 0 to "),
            (1, TypeError, "seeds: found 1: give a list with one seed or None per copy"),
        ):
            with self.assertRaisesRegex(error, f"^{text}"):
                batch.reset(seeds=seeds)
        batch.reset(seeds=np.array([3, 4]))
        self.assertEqual(batch.seeds.tolist(), [3, 4])
        with self.assertRaisesRegex(TypeError, 'batch: the value None of the member "teams" must be a list'):
            troupe.BatchEnv(troupe.Simulation(ROOM), {"teams": None})

    def test_a_bool_is_no_number(self):
        def reward(change):
            return {"measures": ["stalls"], "teams": [{"robots": "r", "rewards": [{"measure": "stalls", "change": change}]}]}

        for wrong in (None, 0.5, 1, "True", []):
            text = f'batch/teams/0/rewards/0: the value {wrong!r} of the member "change" must be a bool'
            with self.subTest(wrong), self.assertRaisesRegex(TypeError, f"^{re.escape(text)}$"):
                troupe.BatchEnv(troupe.Simulation(ROOM), reward(wrong))
        for right in (True, np.bool_(False)):
            troupe.BatchEnv(troupe.Simulation(ROOM), reward(right))


class Benchmark(unittest.TestCase):
    def test_both_environments_of_perf_learning_step_the_same_task(self):
        sys.path.insert(0, str(ROOT / "perf"))
        self.addCleanup(sys.path.remove, str(ROOT / "perf"))
        import learning

        batched = learning.Batched(troupe.Simulation(learning.world(), threads=1), 2)
        vectorised = learning.Vectorised(2)
        before = batched.batch.array("observation").copy()
        for step in range(70):
            batched.step(step)
            vectorised.step(step)
        one, other = batched.batch.array("observation"), vectorised.env.batch.array("observation")
        self.assertTrue(np.array_equal(one, other))
        self.assertFalse(np.array_equal(one, before))


class Tasks(unittest.TestCase):
    def test_observations_are_bounded(self):
        for name, task in troupe.envs.TASKS.items():
            with self.subTest(name):
                env = troupe.envs.VectorEnv(task(robots=4, size=3.0), 4 * 4)
                self.assertTrue(env.single_observation_space.is_bounded(), env.single_observation_space)
                observations, _ = env.reset(seed=1)
                for step in range(300):
                    self.assertTrue(env.observation_space.contains(observations), step)
                    observations, *_ = env.step(fixed_actions(env.action_space, step // 20))

    def test_robots_begin_inside_the_room(self):
        for task in (troupe.envs.Flocking(robots=12, size=6.0), troupe.envs.Dispersion(robots=12, size=6.0)):
            simulation = troupe.Simulation(task.world)
            for seed in range(20):
                simulation.reset(seed=seed)
                self.assertLess(np.abs(simulation.swarm("r").poses()[:, :2]).max(), 2.51, (type(task).__name__, seed))

    def returns(self, task, act, copies=8):
        env = troupe.envs.VectorEnv(task, copies * len(troupe.envs.ParallelEnv(task).possible_agents), autoreset_mode="Disabled")
        observations, _ = env.reset(seed=1)
        total = np.zeros(env.num_envs)
        done = np.zeros(env.num_envs, np.bool_)
        while not done.all():
            observations, rewards, terminations, truncations, _ = env.step(act(env, observations))
            total += np.where(done, 0, rewards)
            over = terminations | truncations
            done |= over
            if over.any() and not done.all():
                observations, _ = env.reset(options={"reset_mask": over})
        return total.mean()

    def test_baselines_do_better_than_chance(self):
        for name, make in troupe.envs.TASKS.items():
            with self.subTest(name):
                task = make()
                best = self.returns(task, lambda env, observations: task.baseline(observations))
                chance = self.returns(task, lambda env, observations: fixed_actions(env.action_space, 1))
                print(f"{name}: baseline {best:.2f}, one random action a robot {chance:.2f}")
                self.assertGreater(best, chance)


if __name__ == "__main__":
    unittest.main()
