"""Display names of controllers in tables and figures."""

from swarm_gym.controllers.names import ALL_SEEDS, ControllerName

# From the MOA paper, the IAFSA paper and the paper of Brand and Yu; R stands for reconstruction.
OPTIMIZER_LABELS = {
    "ant-colony": "ants",
    "elite-genetic": "EGA",
    "fish-swarm": "AFSA",
    "generational-firefly": "FA (generational)",
    "glowworm": "glowworms",
    "hybrid-fish-swarm": "HAAFSA-R",
    "improved-fish-swarm": "IAFSA",
    "multivariate": "MOA",
    "particle-swarm": "PSO-w",
}

# Families whose members are called by the recipe or file that they were fitted with.
FITTED = {
    "distilled": "rule",
    "learned": "learned",
    "open-loop": "open loop",
    "tuned": "tuned schedule",
}


def label(controller: str) -> str:
    """Return the display name: `fixed:60` is FA-60 and `spsfa` is SPSFA, as in the SPSFA paper.

    A group of training seeds, `learned:three-cases/*`, is "learned three-cases", without the parentheses of a
    single policy. Its price, if any, follows after an @.
    """
    name = ControllerName.parse(controller)
    if name.optimizer in OPTIMIZER_LABELS:
        length = "" if name.iterations is None else f", {name.iterations} iterations"
        members = name.parameters if name.family == "fixed" else name.controller
        return f"{OPTIMIZER_LABELS[name.optimizer]}, {members} members{length}"
    return controller if name.optimizer is not None else _controller_label(name)


def _controller_label(name: ControllerName) -> str:
    if name.seed == ALL_SEEDS:
        return f"learned {name.recipe}{name.price_suffix}"
    if name.family == "fixed":
        return f"FA-{name.argument}"
    if name.family in FITTED and name.argument:
        return f"{FITTED[name.family]} ({name.argument})"
    if name.family in ("spsfa", "spsfa-tip"):
        family, parameters = name.family.upper(), name.argument.replace(",", ", ")
        return f"{family} ({parameters})" if parameters else family
    return str(name)
