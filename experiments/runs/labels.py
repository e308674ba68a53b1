"""Names of controllers as tables and figures print them."""

# Of the MOA paper, the IAFSA paper and that of Brand and Yu; R is for reconstruction.
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

# Families whose members are called after what they were fitted to.
FITTED = {
    "distilled": "rule",
    "learned": "learned",
    "open-loop": "open loop",
    "tuned": "tuned schedule",
}


def label(controller: str) -> str:
    """The display name: `fixed:60` is FA-60 and `spsfa` is SPSFA, as in the paper.

    A group of training seeds, `learned:three-cases/*`, is learned three-cases, without the parentheses of one
    policy; what learned it, PPO or an evolution strategy, is told by the policy. A price that it is told
    stays, after an @.
    """
    named, plus, rest = controller.partition("+")
    optimizer, several, iterations = named.rstrip(")").partition("(")
    if plus and optimizer in OPTIMIZER_LABELS:
        length = f", {iterations} iterations" if several else ""
        return f"{OPTIMIZER_LABELS[optimizer]}, {rest.removeprefix('fixed:')} members{length}"
    family, _, argument = controller.partition(":")
    recipe, several, price = argument.partition("/*")
    if several:
        return f"learned {recipe}{price}"
    if family == "fixed":
        return f"FA-{argument}"
    if family in FITTED and argument:
        return f"{FITTED[family]} ({argument})"
    if family.startswith("spsfa"):
        return f"{family.upper()} ({argument.replace(',', ', ')})" if argument else family.upper()
    return controller
