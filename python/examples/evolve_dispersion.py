#!/usr/bin/env python3
"""Evolves a policy for the task Dispersion by CMA-ES, with the library cma (pip install cma).

    python3 python/examples/evolve_dispersion.py [--seeds 1 2 3] [--generations N] [--reach RETURN] [--out FOLDER]

The policy is linear: each action is a weighted sum of the 12 ranges and a constant. In each generation, each policy
drives all 12 robots of one copy of the world, and all copies have the same seed, which is a new one in each generation.
In the end, the mean of the search distribution of CMA-ES, which is also a policy, is tested in 8 copies with the seeds
1 to 8. The exit code is 1 if the test of a seed gives a mean return below RETURN. With --out, the script writes the
generations to FOLDER/dispersion.csv and the weights to FOLDER/dispersion-SEED.npz. The returns of given weights are the
same on every machine, but the arithmetic of cma is not.
"""

import argparse
import csv
import pathlib
import sys
import time

import cma
import numpy as np
import troupe.envs

ROBOTS, POLICIES, STEPS = 12, 16, 600
SHAPE = (2, 13)  # actions, ranges and a constant


def returns_of(weights, envs, seeds):
    """Returns the mean return of the robots of each copy. weights: one matrix per copy."""
    weights = np.repeat(weights, ROBOTS, axis=0)
    observations, _ = envs.reset(seed=seeds)
    total = np.zeros(envs.num_envs)
    for _ in range(STEPS):
        inputs = np.concatenate([observations - 0.5, np.ones((len(observations), 1))], axis=1)
        observations, rewards, *_ = envs.step(troupe.math.ordered_sum(weights * inputs[:, np.newaxis, :]))
        total += rewards
    return total.reshape(-1, ROBOTS).mean(axis=1)


def evolve(seed, generations):
    """Yields after each generation: the processor time, s, the returns of its policies, and the mean of the weights."""
    began = time.process_time()
    envs = troupe.envs.VectorEnv(troupe.envs.Dispersion(), ROBOTS * POLICIES)
    options = {"popsize": POLICIES, "seed": seed, "verbose": -9}
    search = cma.CMAEvolutionStrategy(np.zeros(SHAPE[0] * SHAPE[1]), 1.0, options)
    for generation in range(generations):
        policies = search.ask()
        episode = 1000 * seed + generation  # no episode of the test
        returns = returns_of(np.reshape(policies, (POLICIES, *SHAPE)), envs, [episode] * POLICIES)
        search.tell(policies, list(-returns))
        yield time.process_time() - began, returns, search.mean.reshape(SHAPE)
    envs.close()


def test(weights, copies=8):
    """Returns the mean return over all robots of one episode in each copy, with the seeds 1 to `copies`."""
    envs = troupe.envs.VectorEnv(troupe.envs.Dispersion(), ROBOTS * copies)
    result = returns_of(np.broadcast_to(weights, (copies, *SHAPE)), envs, 1).mean()
    envs.close()
    return result


def main():
    parser = argparse.ArgumentParser(description=__doc__.split("\n")[0])
    parser.add_argument("--seeds", type=int, nargs="+", default=[1, 2, 3], help="seeds, one training per seed (1 2 3)")
    parser.add_argument("--generations", type=int, default=40, help="number of generations per seed (40)")
    parser.add_argument("--reach", type=float, default=50.0, help="least mean return in the test of the last generation; if a seed gets less, the exit code is 1 (50)")
    parser.add_argument("--out", type=pathlib.Path, help="folder for the results")
    options = parser.parse_args()
    if not all(0 < seed < 2**32 for seed in options.seeds):
        parser.error("--seeds: give whole numbers from 1 to 4294967295 (cma would take a seed from the clock for 0)")
    if options.generations < 1:
        parser.error(f"--generations: found {options.generations}: give 1 or more")
    rows, missed = [], []
    for seed in options.seeds:
        for generation, (seconds, returns, weights) in enumerate(evolve(seed, options.generations)):
            rows.append((seed, generation, round(seconds, 1), round(np.median(returns), 4), round(returns.max(), 4)))
            print(f"seed {seed}, generation {generation}: {seconds:5.1f} s, median {rows[-1][3]:6.2f}", flush=True)
        result = test(weights)
        print(f"seed {seed}: return {result:.2f}", flush=True)
        if result < options.reach:
            missed.append(seed)
        if options.out:
            options.out.mkdir(parents=True, exist_ok=True)
            np.savez(options.out / f"dispersion-{seed}.npz", weights=weights)
            with open(options.out / "dispersion.csv", "w", newline="") as file:
                csv.writer(file).writerows([("seed", "generation", "processor_s", "median", "best"), *rows])
    if missed:
        sys.exit(f"the mean return of the last test is below {options.reach} for the seeds {missed}")


if __name__ == "__main__":
    main()
