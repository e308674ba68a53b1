"""One update of a policy by PPO's clipped objective, on tensors of any device.

Source: J. Schulman et al., "Proximal policy optimization algorithms", arXiv 1707.06347 (2017). The order of
operations is as in PPO of stable-baselines3, whose policy it updates: advantages are normalised in each
minibatch, and an update stops before the minibatch whose divergence exceeds the bound.
"""

from typing import Any, NamedTuple

import torch
from stable_baselines3.common.policies import ActorCriticPolicy

from swarm_gym.training.algorithms import GroupedOptions

VALUE_WEIGHT = 0.5  # of the critic's error in the loss
LARGEST_GRADIENT = 0.5  # norm to which gradients are clipped
SMALLEST_DEVIATION = 1e-8  # of the advantages of a minibatch
KL_MARGIN = 1.5  # an update stops at this multiple of target_kl


class Steps(NamedTuple):
    """N environment steps of a rollout, in any order.

    Attributes:
        observations: (N, n) observations of the policy.
        actions: (N, k) outputs of the policy.
        log_probs: (N,) logarithms of the densities of the actions under the policy that acted.
        advantages: (N,) advantages.
        returns: (N,) returns that the critic learns.
    """

    observations: torch.Tensor
    actions: torch.Tensor
    log_probs: torch.Tensor
    advantages: torch.Tensor
    returns: torch.Tensor


def update(policy: ActorCriticPolicy, steps: Steps, options: GroupedOptions) -> dict[str, float]:
    """Pass over the steps `epochs` times, or until the policy has moved too far, and change the policy.

    Minibatches are drawn by torch's generator of the device. The policy's optimizer has the step size.

    Args:
        policy: policy on the device of the steps.
        steps: steps of a rollout of this policy.
        options: options of the update.

    Returns:
        Scalars to plot, by name; `train/epochs` is the number of passes, counting one that was stopped.
    """
    policy.set_training_mode(True)
    number = len(steps.log_probs)
    found: list[dict[str, torch.Tensor]] = []
    passes, moved_too_far = 0, False
    while passes < options.epochs and not moved_too_far:
        order = torch.randperm(number, device=steps.log_probs.device)
        for rows in order.split(options.batch_size):
            loss, scalars = _loss(policy, Steps(*(column[rows] for column in steps)), options)
            found.append(scalars)
            # The only number of a minibatch that the host has to wait for.
            moved_too_far = scalars["train/approx_kl"].item() > KL_MARGIN * options.target_kl
            if moved_too_far:
                break
            policy.optimizer.zero_grad()
            loss.backward()
            torch.nn.utils.clip_grad_norm_(policy.parameters(), LARGEST_GRADIENT)
            policy.optimizer.step()
        passes += 1
    means = {name: torch.stack([scalars[name] for scalars in found]).mean().item() for name in found[0]}
    return {**means, "train/epochs": float(passes), "train/std": policy.log_std.exp().mean().item()}


def _loss(
    policy: ActorCriticPolicy, batch: Steps, options: GroupedOptions
) -> tuple[torch.Tensor, dict[str, torch.Tensor]]:
    """Return the loss of a minibatch, and its parts by name without their gradients."""
    distribution: Any = policy.get_distribution(batch.observations)
    log_ratio = distribution.log_prob(batch.actions) - batch.log_probs
    ratio = log_ratio.exp()
    advantages = batch.advantages
    if len(advantages) > 1:
        advantages = (advantages - advantages.mean()) / (advantages.std() + SMALLEST_DEVIATION)
    clipped = ratio.clamp(1.0 - options.clip_range, 1.0 + options.clip_range)
    parts = {
        "train/policy_gradient_loss": -torch.minimum(advantages * ratio, advantages * clipped).mean(),
        "train/entropy_loss": -distribution.entropy().mean(),
    }
    loss = parts["train/policy_gradient_loss"] + options.entropy_weight * parts["train/entropy_loss"]
    if options.critic:
        values = policy.predict_values(batch.observations).flatten()
        parts["train/value_loss"] = torch.nn.functional.mse_loss(values, batch.returns)
        loss = loss + VALUE_WEIGHT * parts["train/value_loss"]
    parts |= {
        "train/loss": loss,
        "train/clip_fraction": ((ratio - 1.0).abs() > options.clip_range).float().mean(),
        "train/approx_kl": (ratio - 1.0 - log_ratio).mean(),
    }
    return loss, {name: part.detach() for name, part in parts.items()}
