#!/usr/bin/env python3
"""Compares the speed of troupe.BatchEnv with that of VMAS (https://github.com/proroklab/VectorizedMultiAgentSimulator) on one
core, in the task of perf/learning.py. In both simulators, 8 robots with lidars of 12 beams drive in the same room, with the
same random actions, ranges, speeds and tick length. One step of one copy of the world counts as one step of a copy. For each
number of copies, the script prints the steps of a copy per second. At the end it prints the best rate of Troupe divided by
the best rate of VMAS.

    pip install "vmas==1.5.2" "numpy<2"
    PYTHONPATH=build/release/lib/python3/dist-packages taskset -c 1 python3 perf/learning_vmas.py [COPIES...]

This script installs nothing. VMAS needs torch, which pip downloads as well (some GB, because of its libraries for GPUs). The
script uses one processor and no GPU. Robots are discs with a diameter of 0.3 m in VMAS, and squares with edges of 0.3 m in
Troupe. VMAS computes contact forces; in Troupe, motions that would end in an overlap are blocked.
"""

import math
import statistics
import sys

from learning import ACTIONS_KEPT, BEAMS, EPISODE_S, ROBOTS, Batched, copies_of, random_actions, rate, troupe, world

try:
    import torch
    import vmas
    from vmas.simulator.core import Agent, Landmark, Line, Sphere, World
    from vmas.simulator.dynamics.diff_drive import DiffDrive
    from vmas.simulator.scenario import BaseScenario
    from vmas.simulator.sensors import Lidar
    from vmas.simulator.utils import ScenarioUtils
except ImportError as error:
    copies_of()  # --help and wrong arguments need no libraries
    sys.exit(f'learning_vmas.py: error: {error}; install VMAS and torch with: pip install "vmas==1.5.2" "numpy<2"')

TICK_S = 0.1  # the tick length of a Troupe world without the key tick_s
RADIUS_M, RANGE_M, ROOM_M, NEAR_M = 0.15, 3.0, 8.0, 0.3


class Room(BaseScenario):
    """The task of perf/learning.py in VMAS."""

    def make_world(self, batch_dim, device, **options):
        ScenarioUtils.check_kwargs_consumed(options)
        made = World(batch_dim, device, dt=TICK_S, drag=0)
        for side in range(4):
            wall = Landmark(f"wall{side}", shape=Line(length=ROOM_M), movable=False, collide=True)
            made.add_landmark(wall)
        half = math.radians(330) / 2
        for i in range(ROBOTS):
            lidar = Lidar(made, angle_start=-half, angle_end=half, n_rays=BEAMS, max_range=RANGE_M, render=False,
                          entity_filter=lambda entity: not entity.name.startswith("goal"))
            robot = Agent(f"r{i}", shape=Sphere(RADIUS_M), sensors=[lidar], u_range=[0.5, 1.5],
                          dynamics=DiffDrive(made, integration="euler"))
            robot.goal = Landmark(f"goal{i}", shape=Sphere(0.1), movable=False, collide=False)
            robot.before = torch.zeros(batch_dim, device=device)
            made.add_agent(robot)
            made.add_landmark(robot.goal)
        return made

    def reset_world_at(self, env_index=None):
        reach = (-ROOM_M / 2 + 0.5, ROOM_M / 2 - 0.5)
        ScenarioUtils.spawn_entities_randomly(self.world.agents, self.world, env_index, 2 * RADIUS_M, reach, reach)
        goals = [robot.goal for robot in self.world.agents]
        ScenarioUtils.spawn_entities_randomly(goals, self.world, env_index, 0, reach, reach)
        for side, wall in enumerate(self.world.landmarks[:4]):
            x, y = [(-ROOM_M / 2, 0), (ROOM_M / 2, 0), (0, -ROOM_M / 2), (0, ROOM_M / 2)][side]
            wall.set_pos(torch.tensor([x, y], dtype=torch.float32), batch_index=env_index)
            wall.set_rot(torch.tensor([math.pi / 2 if side < 2 else 0.0]), batch_index=env_index)
        for robot in self.world.agents:
            distance = (robot.goal.state.pos - robot.state.pos).norm(dim=-1)
            if env_index is None:
                robot.before = distance
            else:
                robot.before[env_index] = distance[env_index]

    def reward(self, agent):
        distance = (agent.goal.state.pos - agent.state.pos).norm(dim=-1)
        reward = agent.before - distance + 5 * (distance < NEAR_M)
        agent.before = distance
        return reward

    def observation(self, agent):
        to_goal = agent.goal.state.pos - agent.state.pos
        cos, sin = agent.state.rot.cos(), agent.state.rot.sin()
        x = cos * to_goal[:, :1] + sin * to_goal[:, 1:]
        y = cos * to_goal[:, 1:] - sin * to_goal[:, :1]
        distance = to_goal.norm(dim=-1, keepdim=True)
        return torch.cat([agent.sensors[0].measure() / RANGE_M, x, y, distance, agent.state.vel, agent.state.ang_vel], dim=-1)

    def done(self):
        distances = [(robot.goal.state.pos - robot.state.pos).norm(dim=-1) for robot in self.world.agents]
        return (torch.stack(distances) < NEAR_M).all(0)


class OfVmas:
    """A VMAS environment with many copies of a world, whose robots get the random actions of perf/learning.py."""

    def __init__(self, copies):
        self.copies = copies
        self.env = vmas.make_env(Room(), num_envs=copies, device="cpu", seed=1, max_steps=round(EPISODE_S / TICK_S))
        table = torch.tensor(random_actions(), dtype=torch.float32)
        table = torch.stack([0.25 + 0.25 * table[..., 0], 1.5 * table[..., 1]], dim=-1)
        self.table = table[:, :, None, :].repeat(1, 1, copies, 1)  # 64 x robots x copies x 2

    def step(self, made):
        _, _, done, _ = self.env.step(list(self.table[made // ACTIONS_KEPT % len(self.table)]))
        if done.all():
            self.env.reset()
        elif done.any():
            for copy in done.nonzero().flatten().tolist():
                self.env.reset_at(copy)


def main(*sizes):
    torch.set_num_threads(1)
    alone = troupe.Simulation(world(), threads=1)
    best = {"Troupe": 0.0, "VMAS": 0.0}
    print(f"VMAS {vmas.__version__}, torch {torch.__version__}; steps of a copy per second, medians of three runs")
    for size in sizes:
        measured = {"Troupe": Batched(alone, size), "VMAS": OfVmas(size)}
        rates = {name: [] for name in measured}
        for _ in range(3):  # in turn, so that other load affects both equally
            for name, batch in measured.items():
                rates[name].append(size * rate(batch.step, least_s=2))
        medians = {name: statistics.median(found) for name, found in rates.items()}
        best = {name: max(best[name], median) for name, median in medians.items()}
        print(f"{size:6} copies: " + ", ".join(f"{name} {median:,.0f}" for name, median in medians.items()), flush=True)
    print(f"best rate of Troupe / best rate of VMAS: {best['Troupe'] / best['VMAS']:.1f}")


if __name__ == "__main__":
    main(*copies_of((32, 128, 512, 1024, 2048, 4096)))
