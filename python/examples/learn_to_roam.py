#!/usr/bin/env python3
"""A robot learns to roam a hospital without stalling, by the cross-entropy method: in each generation, policies are
drawn from a normal distribution, which is then fitted to the best of these policies. Needs the package gymnasium.

    python3 python/examples/learn_to_roam.py [GENERATIONS [WORLD]]

Each policy of a generation drives the robot in one copy of the world (VectorEnv). Seeds are fixed and the arithmetic is
that of troupe.math, so a run prints the same numbers on every machine.
"""

import sys

import numpy as np
import troupe.envs


class Roam(troupe.envs.Task):
    """The reward of a step is the forward speed, m/s, minus 1 if the robot is stalled."""

    ticks = 2
    seconds = 20.0

    def __init__(self, world):
        self.world = world
        self.teams = [
            troupe.envs.Team(
                observation=[{"field": "ranges"}],
                arrays={"speed": [{"of": "speed"}, {"of": "stalled"}]},
                rewards=[{"array": "speed", "column": 0, "weight": 1.0}, {"array": "speed", "column": 3, "weight": -1.0}],
            )
        ]


def act(policies, observations):
    """Returns the actions of one policy per copy. A policy is a matrix with one row per action: a weight for each
    range, and a constant."""
    inputs = np.concatenate([observations / 2 - 0.5, np.ones((len(observations), 1))], axis=1)
    return troupe.math.ordered_sum(policies * inputs[:, np.newaxis, :])


def returns_of(policies, envs, seed):
    observations, _ = envs.reset(seed=[seed] * envs.num_envs)
    total = np.zeros(envs.num_envs)
    for _ in range(100):
        observations, rewards, *_ = envs.step(act(policies, observations))
        total += rewards
    return total


def main(generations="8", world="worlds/hospital.json"):
    envs = troupe.envs.VectorEnv(Roam(world), 16, robots=1)
    random = np.random.default_rng(1)
    mean = np.zeros((2, envs.single_observation_space.shape[0] + 1))
    spread = np.ones_like(mean)
    for generation in range(int(generations)):
        policies = mean + spread * random.standard_normal((envs.num_envs, *mean.shape))
        returns = returns_of(policies, envs, seed=generation + 1)
        best = policies[np.argsort(-returns, kind="stable")[:4]]
        mean, spread = best.mean(axis=0), best.std(axis=0) + 0.05
        print(f"generation {generation}: best {returns.max():7.2f}, median {np.median(returns):7.2f}", flush=True)
    envs.close()


if __name__ == "__main__":
    main(*sys.argv[1:])
