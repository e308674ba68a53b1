"""Optimizers that other libraries keep, behind the environments of this package.

Each is an `Optimizer`, so that every scenario, layout, reward and controller works with it. Its name has
the form of own code, `module:Class`:

    from swarm_gym.env import SwarmEnv

    env = SwarmEnv("swarm_gym.adapters.pymoo:Genetic", scenario="case1")

| module | classes | extra |
|---|---|---|
| `swarm_gym.adapters.pymoo` | `Genetic`, `ParticleSwarm` | `adapters` |
| `swarm_gym.adapters.niapy` | `ParticleSwarm`, `Firefly` | `adapters` |

They also run on functions of the package `ioh`, which compiled optimizers cannot call: the scenarios
`ioh:<suite>-<function>-<dimension>-<instance>`, see `swarm_gym.scenarios.ioh_scenario`.

`swarm_gym.adapters.dacbench` goes the other way: it is a benchmark of DACBench, of any optimizer here.

docs/adapters.md shows how to add an algorithm of these libraries, and how to adapt another library.
"""
