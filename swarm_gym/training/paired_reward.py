"""The names of the paired reward of trainings, and of the reward that it is computed from.

It is the policy's final result relative to a reference controller's from the same start, see
`swarm_gym.wrappers.paired_reward`.
"""

PAIRED = "paired"  # name of this reward in a training configuration
ENV_REWARD = "final-gap"  # reward of the environments from which it is computed
