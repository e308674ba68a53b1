"""The base that a policy corrects, for observations and actions that are tensors.

An open loop decides by the iteration alone, so its decisions are one table on the device. Any other
controller decides on the host: observations are copied there in every step, and its decisions are copied
back. On the CPU neither copies.
"""

from typing import NamedTuple

import torch

from swarm_gym.controllers.learned.residual import Base
from swarm_gym.controllers.open_loop import OpenLoop
from swarm_gym.observation import ITERATION


class TensorProposal(NamedTuple):
    """Decisions of the base for B swarms, as in `residual.Proposal`.

    Attributes:
        actions: (B, k) decisions in [-1, 1], float32.
        correctable: (B,) True where corrections are added already.
        seen: (B, n) observations of the policy, float32.
    """

    actions: torch.Tensor
    correctable: torch.Tensor
    seen: torch.Tensor

    def corrected(self, corrections: torch.Tensor) -> torch.Tensor:
        """Return (B, k) actions: decisions plus corrections (B, k), both clipped to [-1, 1]."""
        allowed = torch.where(self.correctable[:, None], corrections.clamp(-1.0, 1.0), 0.0)
        return (self.actions + allowed).clamp(-1.0, 1.0)


class TensorBase:
    """A controller whose decisions a policy corrects, on a device.

    Args:
        base: the controller with the layouts of its observations and actions.
        device: device of all tensors.
    """

    def __init__(self, base: Base, device: torch.device):
        self._base = base
        self._device = device
        self._table: torch.Tensor | None = None
        # A subclass may decide by more than the iteration.
        if type(base.controller) is OpenLoop:
            encoded = base.layout.encode(base.controller.decisions)
            self._table = torch.as_tensor(encoded, dtype=torch.float32, device=device)

    def reset(self, num_swarms: int) -> None:
        """Begin an episode of every swarm."""
        self._base.controller.reset(num_swarms)

    def propose(self, observations: torch.Tensor) -> TensorProposal:
        """Return the controller's decisions, given the columns of both layouts (B, m)."""
        if self._table is None:
            found = self._base.propose(observations.cpu().numpy())
            return TensorProposal(*(torch.as_tensor(array, device=self._device) for array in found))
        iteration = observations[:, ITERATION].long()
        actions = self._table[iteration.clamp(max=len(self._table) - 1)]
        seen = torch.cat([observations[:, self._base.columns :].float(), actions], dim=1)
        return TensorProposal(actions, iteration >= self._base.corrected_from, seen)


def carried_out(decided: torch.Tensor, proposal: TensorProposal | None) -> torch.Tensor:
    """Return (B, k) actions in [-1, 1] from a policy's outputs: corrections of a proposal, or all of them."""
    return decided.clamp(-1.0, 1.0) if proposal is None else proposal.corrected(decided)
