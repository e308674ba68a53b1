"""Distil a trained policy into a rule of at most ten numbers: `python -m agents.distil --help`.

The policy's decisions are collected over episodes of its training scenarios, together with inputs that a
person can read (`swarm_gym.controllers.distilled.INPUTS`). Each decision is fitted by a weighted sum of a
few of them. A rule leads to states that the policy does not visit. In further rounds, the policy therefore
decides in the states that the last rule visits, and rules are fitted to all rounds together. The result is
the rule with the highest mean return on validation seeds, among rules of all rounds and lengths.
"""

import tyro

from agents.distillation.run import DistilConfig, describe, run_distillation
from swarm_gym.command import command
from swarm_gym.controllers.names import ControllerName


def main() -> None:
    """Distil a policy with the options of the command line."""
    config = tyro.cli(DistilConfig, description=__doc__)
    with command():
        rule, scores = run_distillation(config)
    print("\n".join([f"\n{rule.num_numbers} numbers:", *rule.lines(), ""]))
    for name, score in scores.items():
        print(f"{name}: {describe(score)}")
    print(f"use it as controller {ControllerName.of('distilled', str(config.output))}")


if __name__ == "__main__":
    main()
