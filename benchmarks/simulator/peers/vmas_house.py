# /// script
# requires-python = ">=3.11,<3.14"
# dependencies = ["vmas==1.5.2", "torch==2.15.0"]
# ///
"""VMAS, multi-agent simulation in PyTorch: ``uv run --no-project vmas_house.py``.

The settings are those of its authors: one batched world on the processor, no gradients, continuous actions,
lidars cast for the whole batch at once, episodes truncated at ``max_steps``. VMAS has no autoreset of its
own. Ended environments are reset as in TorchRL's ``VmasEnv``, its authors' own adapter: all at once if all
have ended, else one by one; then everything is observed once more.
"""

from itertools import cycle, islice

import house
import torch
import vmas
from rounds import Case, Play, measure, threads
from vmas.simulator.core import Agent, Box, Landmark, Line, Sphere, World
from vmas.simulator.dynamics.holonomic_with_rot import HolonomicWithRotation
from vmas.simulator.scenario import BaseScenario
from vmas.simulator.sensors import Lidar

EPISODE = 500


class VmasHouse(BaseScenario):
    """Scenario with one robot with a lidar, four rooms, and a goal."""

    def make_world(self, batch_dim, device, **_):
        """Return a world with robot, goal, walls and furniture; each reset sets their places."""
        world = World(batch_dim, device)
        half = torch.pi * house.FIELD / 360
        lidar = Lidar(
            world,
            angle_start=-half,
            angle_end=half,
            n_rays=house.RAYS,
            max_range=house.RANGE,
            entity_filter=lambda entity: entity.collide,
        )
        self.robot = Agent(
            "robot", shape=Sphere(house.RADIUS), sensors=[lidar], dynamics=HolonomicWithRotation()
        )
        world.add_agent(self.robot)
        self.goal = Landmark("goal", shape=Sphere(0.25), collide=False)
        world.add_landmark(self.goal)
        self.fixed = []
        for i, ((x1, y1), (x2, y2)) in enumerate(house.WALLS):
            wall = Landmark(f"wall {i}", shape=Line(length=abs(x2 - x1) + abs(y2 - y1)), collide=True)
            self.fixed.append((wall, (x1 + x2) / 2, (y1 + y2) / 2, torch.pi / 2 if x1 == x2 else 0.0))
        for i, ((x, y), (length, width)) in enumerate(house.BOXES):
            piece = Landmark(f"piece {i}", shape=Box(length, width), collide=True)
            self.fixed.append((piece, x, y, 0.0))
        for landmark, *_ in self.fixed:
            world.add_landmark(landmark)
        self.rooms = torch.tensor(house.ROOMS, device=device)
        return world

    def reset_world_at(self, env_index=None):
        """Place the robot in one room with any heading, and its goal in another."""
        count = self.world.batch_dim if env_index is None else 1
        room = torch.randint(4, (count,))
        other = (room + torch.randint(1, 4, (count,))) % 4
        self.robot.set_pos(self.rooms[room], batch_index=env_index)
        self.robot.set_rot(torch.rand(count, 1) * 2 * torch.pi, batch_index=env_index)
        self.goal.set_pos(self.rooms[other], batch_index=env_index)
        for landmark, x, y, turn in self.fixed:
            landmark.set_pos(torch.tensor([x, y]), batch_index=env_index)
            landmark.set_rot(torch.tensor([turn]), batch_index=env_index)

    def reward(self, agent):
        """Return 1 at the goal."""
        return self.done().float()

    def observation(self, agent):
        """Return the rays' lengths, and the goal relative to the robot: (E, 42) float32."""
        return torch.cat([agent.sensors[0].measure(), self.goal.state.pos - agent.state.pos], dim=-1)

    def done(self):
        """Return a mask (E,) bool of the robots at the goal."""
        return (self.robot.state.pos - self.goal.state.pos).norm(dim=-1) < 0.25


def build(scenario, **more):
    """Return the steps of a batch of one scenario, with random actions drawn beforehand."""

    def make(environments: int) -> Play:
        env = vmas.make_env(scenario, environments, max_steps=EPISODE, seed=0, **more)
        plan = cycle([[env.get_random_action(agent) for agent in env.agents] for _ in range(8)])
        steps = min(64, max(1, 4096 // environments))

        def play() -> int:
            for actions in islice(plan, steps):
                _, _, dones, _ = env.step(actions)
                if dones.all():
                    env.reset(return_observations=False)
                elif dones.any():
                    for index in dones.nonzero().flatten().tolist():
                        env.reset_at(index, return_observations=False)
                if dones.any():
                    env.get_from_scenario(
                        get_observations=True, get_rewards=False, get_infos=True, get_dones=True
                    )
            return steps * environments

        return play

    return make


SIZES = (1, 256, 4096, 16384)
CASES = (
    Case(
        "four rooms, 58 segments, one robot with a lidar of 40 beams, collisions, reward, reset",
        "Forces, drag and elastic collisions of a round robot that turns freely; exact rays, distances "
        "alone; one scene for all environments; episodes end at a goal or after 500 steps",
        SIZES,
        build(VmasHouse()),
    ),
    Case(
        "its own scenario navigation: four robots with lidars of 40 beams, collisions, reward, reset",
        "A step moves and sees for four robots; their rays meet robots alone, as there are no walls; they "
        "see 0.35 far, a robot's radius is 0.1; episodes end when all are at their goals or after 500 steps",
        SIZES,
        build("navigation", n_lidar_rays=house.RAYS),
    ),
)

if __name__ == "__main__":
    torch.set_num_threads(threads())
    with torch.no_grad():
        measure("VMAS", "vmas", CASES, libraries=["torch"])
