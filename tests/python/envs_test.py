"""troupe.envs keeps the published interfaces of PettingZoo's ParallelEnv and Gymnasium's VectorEnv: signatures, and
what their documentation promises of calls. Neither package takes part."""

import copy
import inspect
import json
import os
import pathlib
import re
import subprocess
import sys
import textwrap
import unittest

import numpy as np
import troupe
from support import ROOM, ROOT, InAFolder
from troupe.envs import AutoresetMode, Box, ParallelEnv, Task, VectorEnv

# Name -> parameters behind self: of pettingzoo.ParallelEnv 1.24, and of gymnasium.vector.VectorEnv 1.0 to 1.2.
PARALLEL = {
    "reset": ["seed", "options"],
    "step": ["actions"],
    "render": [],
    "close": [],
    "state": [],
    "observation_space": ["agent"],
    "action_space": ["agent"],
}
VECTOR = {
    "reset": ["seed", "options"],
    "step": ["actions"],
    "render": [],
    "close": ["kwargs"],
    "close_extras": ["kwargs"],
}


def room(**changes):
    world = copy.deepcopy(ROOM)
    world.update(changes)
    return world


class Short(Task):
    robots = "bot"
    seconds = 1.0


class Lone(Task):
    robots = "cart"
    seconds = 1.0


class South(Short):
    """Robots have done what is asked when they are far south."""

    def terminated(self, swarm):
        return swarm.poses()[:, 1] < -4.2


def parallel_api(test, env, steps, act):
    """What pettingzoo's documentation and its api test ask of an environment; returns the episode's trace."""
    trace = []
    test.assertIsInstance(env.possible_agents, list)
    observations, infos = env.reset(seed=3, options={"options": 1})
    for told in (observations, infos):
        test.assertIsInstance(told, dict)
        test.assertEqual(set(told), set(env.agents))
    finished = set()
    for _ in range(steps):
        if not env.agents:
            break
        live = set(env.agents)
        test.assertEqual(env.num_agents, len(live))
        test.assertLessEqual(live, set(env.possible_agents))
        for agent in env.agents:
            test.assertIs(env.observation_space(agent), env.observation_space(agent))
            test.assertIs(env.action_space(agent), env.action_space(agent))
            test.assertTrue(env.observation_space(agent).contains(observations[agent]), observations[agent])
        actions = {agent: act(env, agent) for agent in env.agents}
        observations, *others = env.step(actions)
        rewards, terminations, truncations, infos = others
        live |= set(env.agents)  # who was born
        for told in (observations, rewards, terminations, truncations, infos):
            test.assertEqual(set(told), live)
        for agent in live:
            test.assertIs(type(rewards[agent]), float)
            test.assertIs(type(terminations[agent]), bool)
            test.assertIs(type(truncations[agent]), bool)
            test.assertIsInstance(infos[agent], dict)
        over = {agent for agent in live if terminations[agent] or truncations[agent]}
        test.assertEqual(set(env.agents), live - over)
        test.assertFalse(finished & set(env.agents), "who has finished does not come back")
        finished |= over
        trace.append((sorted(live), [rewards[agent] for agent in sorted(live)]))
    return trace


class TheParallelInterface(InAFolder):
    def test_signatures(self):
        for name, parameters in PARALLEL.items():
            own = list(inspect.signature(getattr(ParallelEnv, name)).parameters)
            self.assertEqual(own, ["self", *parameters], name)
        env = ParallelEnv(room(), Short())
        for attribute in ("metadata", "agents", "possible_agents", "observation_spaces", "action_spaces", "num_agents",
                          "max_num_agents", "unwrapped"):
            self.assertTrue(hasattr(env, attribute), attribute)
        self.assertEqual(str(env), "troupe_v0")
        self.assertEqual(env.max_num_agents, 8)
        self.assertIs(env.unwrapped, env)

    def test_an_episode(self):
        env = ParallelEnv(room(), Short())
        trace = parallel_api(self, env, 100, lambda env, agent: env.action_space(agent).sample())
        self.assertEqual(len(trace), 5)  # 1 s of ticks of 0.2 s
        self.assertEqual(env.agents, [])
        self.assertEqual(env.step({}), ({}, {}, {}, {}, {}))
        self.assertEqual(trace[0][0], [f"r{i}" for i in range(6)])  # two are yet to be born
        env.close()
        with self.assertRaisesRegex(RuntimeError, "was closed"):
            env.reset()

    def test_agents_end_are_born_and_die(self):
        env = ParallelEnv(room(), South())
        env.reset(seed=3)
        env.simulation.find("r2").set_pose((0, -4.4, 0))
        env.simulation.remove(env.simulation.find("r4"))
        born = env.simulation.spawn("r", (3, -4.5, 0))
        self.assertEqual(born.name, "r6")
        born.set_pose((3, 3.5, 0))
        still = {agent: [0, 0] for agent in env.agents}
        observations, _, terminations, truncations, _ = env.step(still)
        self.assertEqual(set(observations), {f"r{i}" for i in range(7)})
        self.assertEqual({agent for agent, ends in terminations.items() if ends}, {"r2", "r4"})
        self.assertFalse(any(truncations.values()))
        self.assertEqual(env.agents, ["r0", "r1", "r3", "r5", "r6"])
        with self.assertRaisesRegex(ValueError, "actions for who is no agent now: r2, r4"):
            env.step(still)
        env.simulation.find("r2").set_pose((-3, 3.6, 0))
        self.assertNotIn("r2", env.step({})[0])

    def test_actions_drive(self):
        env = ParallelEnv(room(), Short())
        env.reset()
        env.step({agent: [1, -0.5] for agent in env.agents})
        self.assertEqual(env.simulation.find("r1").speed().forward, 0.5)
        self.assertEqual(env.simulation.find("r1").speed().turn, -0.5)
        env.step({"r1": [0.5, 0], "r2": [7, 0]})
        self.assertEqual(env.simulation.find("r0").speed().forward, 0.5)  # goes on
        self.assertEqual(env.simulation.find("r1").speed().forward, 0.25)
        self.assertEqual(env.simulation.find("r2").speed().forward, 0.5)  # clipped
        for wrong in ([0], [0, np.nan], np.zeros((2, 1))):
            with self.assertRaisesRegex(ValueError, "action of r1: give .2,. finite numbers"):
                env.step({"r1": wrong})
        self.assertEqual(env.state().shape, (8, 4))

    def test_rewards_are_what_is_free_and_less_for_the_stalled(self):
        env = ParallelEnv(room(), Lone())
        observations, _ = env.reset()
        self.assertEqual(observations["cart"].shape, (5,))
        env.simulation.find("cart").set_pose((4.55, 0, 0))
        rewards = env.step({"cart": [1, 0]})[1]
        rewards = env.step({"cart": [1, 0]})[1]
        self.assertLess(rewards["cart"], 0)
        self.assertTrue(env.simulation.find("cart").stalled())

    def test_controllers_of_the_world_do_not_interfere(self):
        types = copy.deepcopy(ROOM["types"])
        types["bot"]["controller"] = {"kind": "expand"}
        types["cart"]["controller"] = {"kind": "script", "legs": [{"until_s": 99, "forward_mps": 0.5}]}
        env = ParallelEnv(room(types=types), Short())
        env.reset()
        env.step({agent: [0, 0] for agent in env.agents})
        env.step({})
        self.assertEqual(env.simulation.find("r0").speed().forward, 0)
        self.assertNotEqual(tuple(env.simulation.find("cart").speed()), (0, 0, 0))  # not of the task

    def test_render(self):
        env = ParallelEnv(room(), Short())
        self.assertIsNone(env.render())
        env = ParallelEnv(room(), Short(), render_mode="rgb_array")
        env.reset()
        try:
            self.assertEqual(env.render().shape[2], 3)
        except RuntimeError as error:
            self.skipTest(str(error))
        with self.assertRaisesRegex(ValueError, "known: rgb_array"):
            ParallelEnv(room(), render_mode="human")


class Seeds(InAFolder):
    def episode(self, env, seed):
        observations, _ = env.reset(seed=seed)
        first = env.simulation.state_hash()
        for _ in range(3):
            observations = env.step({agent: [1, 0.5] for agent in env.agents})[0]
        return first, env.simulation.state_hash()

    def test_make_an_episode(self):
        env = ParallelEnv(room(), Short())
        first = self.episode(env, 7)
        second = self.episode(env, None)
        third = self.episode(env, None)
        self.assertEqual(len({first, second, third, self.episode(env, 8)}), 4)
        self.assertEqual([self.episode(env, 7), self.episode(env, None), self.episode(env, None)], [first, second, third])
        other = ParallelEnv(room(), Short(), threads=2)
        self.assertEqual(self.episode(other, 7), first)
        self.assertEqual(self.episode(ParallelEnv(room(), Short(), seed=7), None), first)

    def test_none_means_the_worlds_own(self):
        env = ParallelEnv(room(), Short())
        env.reset()
        world = troupe.Simulation(ROOM)
        world.swarm("bot").subscribe()
        world.step()
        self.assertEqual(env.simulation.state_hash(), world.state_hash())

    def test_of_copies_count_up(self):
        envs = VectorEnv(room(), 3, Short())
        envs.reset(seed=7)
        self.assertEqual([copy.options["seed"] for copy in envs.simulations], ["7", "8", "9"])
        hashes = [copy.state_hash() for copy in envs.simulations]
        envs.reset(seed=[9, None, 7])
        self.assertEqual([copy.state_hash() for copy in envs.simulations][::2], hashes[::-2])
        with self.assertRaisesRegex(ValueError, "2 seeds for 3 environments"):
            envs.reset(seed=[1, 2])


class TheVectorInterface(InAFolder):
    def test_signatures(self):
        for name, parameters in VECTOR.items():
            own = inspect.signature(getattr(VectorEnv, name)).parameters
            self.assertEqual(list(own), ["self", *parameters], name)
        for name in ("seed", "options"):
            parameter = inspect.signature(VectorEnv.reset).parameters[name]
            self.assertEqual((parameter.kind, parameter.default), (inspect.Parameter.KEYWORD_ONLY, None))
        envs = VectorEnv(room(), 2, Short())
        for attribute in ("metadata", "spec", "render_mode", "closed", "observation_space", "action_space",
                          "single_observation_space", "single_action_space", "num_envs", "np_random", "np_random_seed",
                          "unwrapped"):
            self.assertTrue(hasattr(envs, attribute), attribute)
        self.assertEqual(envs.metadata["autoreset_mode"], AutoresetMode.NEXT_STEP)
        self.assertEqual(repr(envs), "VectorEnv(num_envs=2)")

    def check(self, envs, told):
        observations, rewards, terminations, truncations, infos = told
        self.assertTrue(envs.observation_space.contains(observations))
        self.assertEqual((rewards.shape, rewards.dtype), ((envs.num_envs,), np.float64))
        for flags in (terminations, truncations):
            self.assertEqual((flags.shape, flags.dtype), ((envs.num_envs,), np.bool_))
        self.assertIsInstance(infos, dict)

    def test_episodes_follow_one_another(self):
        envs = VectorEnv(room(), 3, Lone())
        self.assertEqual(envs.single_observation_space.shape, (5,))  # one robot: no axis for robots
        self.assertEqual(envs.single_action_space.shape, (2,))
        self.assertEqual(envs.observation_space.shape, (3, 5))
        with self.assertRaisesRegex(RuntimeError, "reset.. comes before"):
            envs.step(np.zeros((3, 2)))
        observations, infos = envs.reset(seed=1)
        self.assertTrue(envs.observation_space.contains(observations))
        self.assertEqual(infos, {})
        envs.action_space.seed(4)
        first = []
        for step in range(12):
            told = envs.step(envs.action_space.sample())
            self.check(envs, told)
            ends = told[2] | told[3]
            self.assertEqual(ends.tolist(), [step % 6 == 4] * 3, step)  # 5 steps, then one that only resets
            if step % 6 == 5:
                self.assertEqual(told[1].tolist(), [0, 0, 0])
                first.append(envs.simulations[0].options["seed"])
        self.assertEqual(len({"1", *first}), 3)  # each episode has a seed of its own
        envs.close()
        self.assertTrue(envs.closed)
        with self.assertRaisesRegex(RuntimeError, "was closed"):
            envs.reset()

    def test_a_swarm_has_an_axis_for_robots(self):
        envs = VectorEnv(room(), 2, Short())
        self.assertEqual(envs.observation_space.shape, (2, 8, 3))
        self.assertEqual(envs.action_space.shape, (2, 8, 2))
        envs.reset()
        self.check(envs, envs.step(envs.action_space.sample()))
        for wrong in (np.zeros((2, 2)), np.full((2, 8, 2), np.inf)):
            with self.assertRaisesRegex(ValueError, "finite numbers of shape .2, 8, 2."):
                envs.step(wrong)

    def test_one_copy_ends_without_the_others(self):
        envs = VectorEnv(room(), 2, South())
        envs.reset()
        swarm = envs.simulations[1].swarm("bot")
        poses = swarm.poses()
        poses[:6, :2] = np.column_stack([np.arange(6) - 2.5, np.full(6, -4.4)])
        swarm.set_poses(poses, where=swarm.alive())
        still = np.zeros(envs.action_space.shape)
        self.assertEqual(envs.step(still)[2].tolist(), [False, True])
        told = envs.step(still)
        self.assertEqual(told[2].tolist(), [False, False])
        self.assertEqual(told[1][1], 0)
        self.assertEqual([copy.tick for copy in envs.simulations], [3, 1])

    def test_workers_change_nothing(self):
        ends = []
        for workers in (1, 2):
            envs = VectorEnv(room(), 3, Short(), workers=workers)
            envs.reset(seed=5)
            rewards = [envs.step(np.full((3, 8, 2), 0.7))[1].tolist() for _ in range(9)]
            ends.append((rewards, [copy.state_hash() for copy in envs.simulations]))
        self.assertEqual(ends[0], ends[1])

    def test_what_is_wrong_is_told(self):
        with self.assertRaisesRegex(ValueError, "num_envs=0: give 1 or more"):
            VectorEnv(room(), 0)
        with self.assertRaisesRegex(LookupError, "unknown type or population"):
            task = Short()
            task.robots = "nobody"
            VectorEnv(room(), 1, task)
        with self.assertRaises(troupe.InputError):
            VectorEnv("none.json", 1)
        with self.assertRaisesRegex(ValueError, "needs a robot"):
            ParallelEnv({"troupe": 1})


class TheExample(InAFolder):
    def test_learns_the_same_each_time(self):
        example = ROOT / "python" / "examples" / "learn_to_roam.py"
        world = pathlib.Path("room.json")  # takes less to load than a hospital
        population = {key: value for key, value in ROOM["populations"][0].items() if key != "reserve"}
        world.write_text(json.dumps(room(models=ROOM["models"][:1], populations=[population])))
        runs = [
            subprocess.run([sys.executable, example, "3", world], check=True, stdout=subprocess.PIPE, text=True).stdout
            for _ in range(2)
        ]
        self.assertEqual(runs[0], runs[1])
        best = [float(value) for value in re.findall(r"best +(-?[\d.]+)", runs[0])]
        self.assertEqual(len(best), 3)
        self.assertGreater(best[-1], 5)


class Boxes(unittest.TestCase):
    def test_hold_what_they_sample(self):
        box = Box(low=np.array([0, -1], np.float32), high=np.array([1, 2], np.float32), dtype=np.float32)
        box.seed(3)
        first = [box.sample() for _ in range(50)]
        self.assertTrue(all(box.contains(point) for point in first))
        box.seed(3)
        np.testing.assert_array_equal(first, [box.sample() for _ in range(50)])
        self.assertFalse(box.contains(np.array([0, 3], np.float32)))
        self.assertFalse(box.contains(np.zeros(3, np.float32)))
        self.assertIn(np.zeros(2, np.float32), box)
        self.assertEqual(box, Box(low=box.low, high=box.high, dtype=np.float32))
        self.assertNotEqual(box, Box(low=0, high=1, shape=(2,)))


class WithThePackages(InAFolder):
    """Stand-ins for the packages show that the classes derive from theirs."""

    def test_theirs_are_taken(self):
        packages = pathlib.Path("packages")
        for name, text in {
            "gymnasium/__init__.py": "",
            "gymnasium/spaces.py": "from troupe.envs.spaces import _Box\nclass Box(_Box): mark = 1\n",
            "gymnasium/vector.py": """
                import enum
                class AutoresetMode(enum.Enum): NEXT_STEP = "NextStep"
                class VectorEnv:
                    closed = False
                    seen = None
                    def reset(self, *, seed=None, options=None): self.seen = seed
                    def close(self, **kwargs): self.close_extras(**kwargs)
                """,
            "pettingzoo/__init__.py": "class ParallelEnv:\n    num_agents = property(lambda self: len(self.agents))\n",
        }.items():
            (packages / name).parent.mkdir(parents=True, exist_ok=True)
            (packages / name).write_text(textwrap.dedent(text))
        code = """
import gymnasium.vector, pettingzoo, troupe.envs
from support import ROOM
class Bots(troupe.envs.Task):
    robots = "bot"
parallel = troupe.envs.ParallelEnv(ROOM, Bots())
parallel.reset()
assert isinstance(parallel, pettingzoo.ParallelEnv) and parallel.num_agents == 6
envs = troupe.envs.VectorEnv(ROOM, 2, Bots())
envs.reset(seed=4)
assert isinstance(envs, gymnasium.vector.VectorEnv) and envs.seen == 4
assert envs.action_space.mark == 1
assert envs.metadata["autoreset_mode"] is gymnasium.vector.AutoresetMode.NEXT_STEP
envs.close()
"""
        path = os.pathsep.join([str(packages.resolve()), *sys.path])
        subprocess.run([sys.executable, "-c", code], check=True, env={**os.environ, "PYTHONPATH": path})


if __name__ == "__main__":
    unittest.main()
