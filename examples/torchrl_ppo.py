"""TorchRL in Vitruvius: PPO with generalised advantages.

./run python examples/torchrl_ppo.py houses.jsonl --avoid
"""

from dataclasses import dataclass

import torch
import tyro
from task import Task
from tensordict.nn import TensorDictModule
from torch import Tensor, nn
from torch.distributions import Categorical
from torchrl.collectors import Collector
from torchrl.envs import GymWrapper
from torchrl.modules import ProbabilisticActor, ValueOperator
from torchrl.objectives import ClipPPOLoss
from torchrl.objectives.value import GAE


def body(inputs: int, outputs: int) -> nn.Module:
    """Return a network from observations (B, inputs) to numbers (B, outputs)."""
    return nn.Sequential(
        nn.Linear(inputs, 128), nn.Tanh(), nn.Linear(128, 128), nn.Tanh(), nn.Linear(128, outputs)
    )


@dataclass(frozen=True)
class Example(Task):
    """Train an agent of TorchRL and compare it with the oracle."""

    def run(self) -> None:
        """Train for all steps, then evaluate."""
        torch.manual_seed(self.seed)
        env = GymWrapper(self.make_envs(), categorical_action_encoding=True)
        network = TensorDictModule(body(self.numbers, 3), in_keys=["observation"], out_keys=["logits"])
        actor = ProbabilisticActor(
            network, in_keys=["logits"], distribution_class=Categorical, return_log_prob=True
        )
        critic = ValueOperator(body(self.numbers, 1), in_keys=["observation"])
        advantages = GAE(gamma=0.99, lmbda=0.95, value_network=critic)
        loss = ClipPPOLoss(actor, critic, entropy_coeff=0.01, critic_coeff=0.5, normalize_advantage=True)
        optimizer = torch.optim.Adam(loss.parameters(), lr=1e-3, eps=1e-5)

        batch = max(1, min(64, self.steps // self.environments)) * self.environments
        steps = max(1, self.steps // batch) * batch
        collector = Collector(
            env, actor, frames_per_batch=batch, total_frames=steps, auto_register_policy_transforms=True
        )
        for frames in collector:
            for _ in range(4):
                with torch.no_grad():
                    advantages(frames)
                flat = frames.reshape(-1)
                for part in torch.randperm(len(flat)).split(1024):
                    losses = loss(flat[part])
                    (losses["loss_objective"] + losses["loss_critic"] + losses["loss_entropy"]).backward()
                    nn.utils.clip_grad_norm_(loss.parameters(), 0.5)
                    optimizer.step()
                    optimizer.zero_grad()

        def act(observation: Tensor) -> Tensor:
            """Return log-probabilities with Gumbel noise: their argmax is a sample."""
            logits = network(observation)
            return logits - (-torch.rand_like(logits).log()).log()

        self.score("TorchRL PPO", act)


if __name__ == "__main__":
    tyro.cli(Example).run()
