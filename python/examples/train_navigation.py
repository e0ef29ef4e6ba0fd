#!/usr/bin/env python3
"""Trains a shared policy for the task Navigation by PPO, with the library skrl (pip install "skrl[jax]").

    python3 python/examples/train_navigation.py [--seeds 1 2 3] [--samples N] [--reach RETURN] [--out FOLDER]

All 8 robots of all copies of the world use the same policy, and each robot is one environment of skrl's PPO. After
every tenth update, the policy is tested in 8 copies of the world. The exit code is 1 if the last test of a seed
gives a mean return below RETURN. With --out, the script writes the tests to FOLDER/navigation.csv, the policies to
FOLDER/navigation-SEED.npz, and, if matplotlib is installed, a picture of the tests to FOLDER/navigation.png.
"""

import argparse
import csv
import os
import pathlib
import sys
import time

os.environ.setdefault("JAX_PLATFORMS", "cpu")

import flax.linen as nn
import gymnasium
import jax.numpy as jnp
import numpy as np
import troupe.envs
from skrl import logger
from skrl.agents.jax.ppo import PPO
from skrl.envs.wrappers.jax import wrap_env
from skrl.memories.jax import RandomMemory
from skrl.models.jax import DeterministicMixin, GaussianMixin, Model
from skrl.resources.preprocessors.jax import RunningStandardScaler
from skrl.trainers.jax import SequentialTrainer
from skrl.utils import set_seed

COPIES = 32
ROLLOUT = 32  # steps of each environment between two updates
UPDATES_PER_TEST = 10


class PerRobot(gymnasium.vector.VectorWrapper):
    """Ends the episode of a robot for the learner when the robot is finished, not when its copy of the world is over.
    The step that begins the next episode of a copy ignores the actions. This step is therefore also marked as
    terminated, so that PPO estimates no value across it."""

    def reset(self, **options):
        self._begins = np.zeros(self.num_envs, bool)
        return self.env.reset(**options)

    def step(self, actions):
        observations, rewards, terminations, truncations, infos = self.env.step(actions)
        # There are no infos of single robots if one robot learns in each copy.
        terminated = infos.get("finished", terminations) | self._begins
        self._begins = terminations | truncations
        return observations, rewards, terminated, truncations & ~terminated, {}


def layers(inputs, outputs, scale):
    for _ in range(2):
        inputs = nn.tanh(nn.Dense(64, kernel_init=nn.initializers.orthogonal(2**0.5))(inputs))
    return nn.Dense(outputs, kernel_init=nn.initializers.orthogonal(scale))(inputs)


class Policy(GaussianMixin, Model):
    """The mean of the actions is the output of the network; their deviation does not depend on the observation."""

    def __init__(self, **spaces):
        Model.__init__(self, **spaces)
        GaussianMixin.__init__(self, min_log_std=-3, max_log_std=0.5)

    @nn.compact
    def __call__(self, inputs, role):
        log_std = self.param("log_std", lambda _: jnp.full(self.num_actions, -0.5))
        return layers(inputs["observations"], self.num_actions, 0.01), {"log_std": log_std}


class Value(DeterministicMixin, Model):
    def __init__(self, **spaces):
        Model.__init__(self, **spaces)
        DeterministicMixin.__init__(self)

    @nn.compact
    def __call__(self, inputs, role):
        return layers(inputs["observations"], 1, 1.0), {}


def make_agent(env):
    spaces = {"observation_space": env.observation_space, "action_space": env.action_space, "device": env.device}
    models = {"policy": Policy(**spaces), "value": Value(**spaces)}
    for role, model in models.items():
        model.init_state_dict(role=role)
    return PPO(
        models=models,
        memory=RandomMemory(memory_size=ROLLOUT, num_envs=env.num_envs, device=env.device),
        cfg={
            "rollouts": ROLLOUT,
            "learning_epochs": 4,
            "mini_batches": 4,
            "learning_rate": 1e-3,
            "discount_factor": 0.99,
            "gae_lambda": 0.95,
            "entropy_loss_scale": 0.001,
            "time_limit_bootstrap": True,
            "value_preprocessor": RunningStandardScaler,
            "value_preprocessor_kwargs": {"size": 1, "device": env.device},
            "experiment": {"write_interval": 0, "checkpoint_interval": 0},
        },
        **spaces,
    )


def weights_of(policy):
    """Returns the weights of the policy as NumPy arrays: kernel0, bias0, kernel1, ..., log_std."""
    params = policy.state_dict.params["params"]
    weights = {f"{name}{i}": np.asarray(params[f"Dense_{i}"][name], np.float64) for i in range(3) for name in ("kernel", "bias")}
    return {**weights, "log_std": np.asarray(params["log_std"], np.float64)}


def act(weights, observations, random):
    """Returns actions of the policy, drawn by the random generator `random`."""
    hidden = observations
    for i in range(2):
        hidden = np.tanh(hidden @ weights[f"kernel{i}"] + weights[f"bias{i}"])
    mean = hidden @ weights["kernel2"] + weights["bias2"]
    return mean + np.exp(weights["log_std"]) * random.standard_normal(mean.shape)


def test(weights, copies=8):
    """Tests a policy: runs one episode in each of `copies` copies of the world, which have the seeds 1 to `copies`.
    Returns the mean of the returns of all robots."""
    task = troupe.envs.Navigation()
    random = np.random.default_rng(1)
    envs = troupe.envs.VectorEnv(task, 8 * copies)
    observations, _ = envs.reset(seed=1)
    returns, running = np.zeros(envs.num_envs), np.ones(envs.num_envs, bool)
    while running.any():
        observations, rewards, terminations, truncations, _ = envs.step(act(weights, observations, random))
        returns += rewards * running
        running &= ~(terminations | truncations)
    envs.close()
    return returns.mean()


def train(seed, samples):
    """Trains a policy. Yields after each test: the samples so far (steps of all robots), the processor time, s, the
    mean return of the test, and the weights of the policy."""
    began = time.process_time()
    set_seed(seed)
    envs = troupe.envs.VectorEnv(troupe.envs.Navigation(), 8 * COPIES, threads=1)
    env = wrap_env(PerRobot(envs), wrapper="gymnasium", verbose=False)
    env._seed = 1000 * seed  # skrl passes this to its first reset(); no episode of the tests is trained on
    agent = make_agent(env)
    steps = ROLLOUT * UPDATES_PER_TEST
    trainer = SequentialTrainer(
        env=env,
        agents=agent,
        cfg={"timesteps": steps, "headless": True, "disable_progressbar": True, "close_environment_at_exit": False},
    )
    made = 0
    while made < samples:
        weights = weights_of(agent.policy)
        yield made, time.process_time() - began, test(weights), weights
        trainer.train()
        made += steps * env.num_envs
    weights = weights_of(agent.policy)
    yield made, time.process_time() - began, test(weights), weights
    env.close()


def draw(rows, file):
    """Draws the returns of the tests. rows: seed, samples, processor time and return of each test."""
    try:
        from matplotlib.figure import Figure
    except ImportError:
        return
    figure = Figure(figsize=(5, 3), layout="constrained")
    axis = figure.subplots()
    for seed, color in zip(sorted({row[0] for row in rows}), ("#0072b2", "#e69f00", "#009e73", "#d55e00", "#56b4e9", "#cc79a7")):
        own = [row for row in rows if row[0] == seed]
        axis.plot([row[1] / 1000 for row in own], [row[3] for row in own], marker=".", color=color, label=f"seed {seed}")
    axis.axhline(5.58, color="0.4", linestyle="--", label="hand-written")
    axis.set(xlabel="samples, thousands", ylabel="return")
    axis.legend(frameon=False, loc="lower right")
    figure.savefig(file, dpi=100)


def main():
    parser = argparse.ArgumentParser(description=__doc__.split("\n")[0])
    parser.add_argument("--seeds", type=int, nargs="+", default=[1, 2, 3], help="seeds, one training per seed (1 2 3)")
    parser.add_argument("--samples", type=int, default=1_000_000, help="number of robot steps per seed (1000000)")
    parser.add_argument("--reach", type=float, default=0.0,
                        help="least mean return in the last test; if a seed gets less, the exit code is 1 (0)")
    parser.add_argument("--out", type=pathlib.Path, help="folder for the results")
    options = parser.parse_args()
    logger.setLevel("ERROR")
    rows, last = [], {}
    for seed in options.seeds:
        for made, seconds, result, weights in train(seed, options.samples):
            print(f"seed {seed}: {made:8} samples, {seconds:6.1f} s, return {result:6.2f}", flush=True)
            rows.append((seed, made, round(seconds, 1), round(result, 4)))
            last[seed] = result
        if options.out:
            options.out.mkdir(parents=True, exist_ok=True)
            np.savez(options.out / f"navigation-{seed}.npz", **weights)
            with open(options.out / "navigation.csv", "w", newline="") as file:
                csv.writer(file).writerows([("seed", "samples", "processor_s", "return"), *rows])
            draw(rows, options.out / "navigation.png")
    missed = [seed for seed in options.seeds if last[seed] < options.reach]
    if missed:
        sys.exit(f"the mean return of the last test is below {options.reach} for the seeds {missed}")


if __name__ == "__main__":
    main()
