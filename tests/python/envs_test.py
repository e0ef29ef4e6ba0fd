"""Tests the environments of troupe.envs with the packages whose interfaces they implement (Gymnasium, PettingZoo): with the
checkers of these packages, and by comparing their vector environment with that of troupe.envs, bit for bit."""

import contextlib
import io
import sys
import time
import unittest
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
from support import ROOM, ROOT
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
        for make in [*(lambda task=task: task(robots=3) for task in troupe.envs.TASKS.values()), Walkers, Short]:
            task = make()
            with self.subTest(type(task).__name__):
                task.seconds = min(task.seconds, 4.0)
                pettingzoo.test.parallel_api_test(troupe.envs.ParallelEnv(task), num_cycles=100)
                pettingzoo.test.parallel_seed_test(lambda task=task: troupe.envs.ParallelEnv(task), num_cycles=50)


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
                for task in (Looker, *troupe.envs.TASKS.values()):
                    with self.subTest(task.__name__):

                        def make(task=task):
                            made = task() if task is Looker else task(robots=3)
                            made.seconds = 2.0
                            return made

                        self.same_as_sync(make, mode)

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

    def test_by_the_registry(self):
        envs = gymnasium.make_vec("troupe/Navigation-v0", num_envs=4, vectorization_mode="vector_entry_point", robots=3)
        self.assertIsInstance(envs.unwrapped, troupe.envs.VectorEnv)
        self.assertEqual(envs.reset(seed=1)[0].shape, (4, 18))
        self.assertEqual(set(troupe.envs.TASKS), {name[7:-3] for name in gymnasium.registry if name.startswith("troupe/")})

    def test_says_what_is_wrong(self):
        for wrong, text in (
            (lambda: troupe.envs.VectorEnv(Short(2), 3), "2 robots learn in each copy: give a multiple of 2"),
            (lambda: troupe.envs.VectorEnv(Walkers(), 2), "needs a task with one team, but Walkers has 2"),
            (lambda: troupe.envs.VectorEnv(Short(2), 2, render_mode="ansi"), 'unknown render_mode "ansi"; known: human, rgb_array'),
            (lambda: troupe.envs.Env(Short(2), robot="robot"), "names 2 robots: give the name of one"),
        ):
            with self.assertRaisesRegex(ValueError, text):
                wrong()
        env = troupe.envs.VectorEnv(Short(2), 4)
        env.reset(seed=1)
        with self.assertRaisesRegex(ValueError, r"shape \(4, 2\), not \(2, 2\)"):
            env.step(np.zeros((2, 2)))
        with self.assertRaisesRegex(ValueError, 'action 1 of "r1" in copy 0 is nan'):
            env.step(np.array([[0, 0], [0, np.nan], [0, 0], [0, 0]]))
        with self.assertRaisesRegex(LookupError, 'has no device "lidr"; it has: lidar'):
            task = Short(2)
            task.teams[0].observation = [{"device": "lidr", "field": "ranges"}]
            troupe.envs.Env(task)
        with self.assertRaisesRegex(ValueError, "batch/teams/0/rewards/0: unknown member \"wieght\""):
            task = Short(2)
            task.teams[0].rewards = [{"array": "goal", "wieght": 1}]
            troupe.envs.Env(task)


class Human(unittest.TestCase):
    def shown(self, env, reset, step, batch):
        """Steps an environment in the mode human while a user looks at its page. Returns the state hashes of the steps, the
        state that the page got last, the first text to the page in each episode, and the wall time of a step, s."""
        told = io.StringIO()
        with contextlib.redirect_stderr(told):
            reset(5)
        self.assertEqual(told.getvalue(), f"troupe: the world is shown at {env.renderer.address}\n")
        port, token = env.renderer.address.removeprefix("http://127.0.0.1:").split("/#")
        hashes, texts = [], []
        with Socket(int(port)) as user:
            user.send(token)
            texts.append(user.receive())
            self.assertEqual(user.ask(do="pause")["reason"], "this address is read-only")
            began = time.perf_counter()
            for _ in range(8):
                step()
                hashes.append(batch().core.state_hash(0))
            wall_s = (time.perf_counter() - began) / 8
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
                self.assertGreater(wall_s, 0.08)  # a tick is 0.1 s
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

    def test_says_which_copies_there_are(self):
        batch = troupe.envs.VectorEnv(Short(2), 4).batch.core
        with self.assertRaisesRegex(IndexError, "copy 2 does not exist: give a number from 0 to 1"):
            batch.view(2)


class Tasks(unittest.TestCase):
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
