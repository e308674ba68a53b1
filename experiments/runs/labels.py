"""Display names of controllers in tables and figures."""

from swarm_gym.controllers.fixed import FIRST_SOURCE
from swarm_gym.controllers.names import ALL_SEEDS, BLINDED, ControllerName
from swarm_gym.controllers.parameters import parse_parameters
from swarm_gym.sources import SMOOTH, UNIFORM, Source

# From the MOA paper, the IAFSA paper, the paper of Brand and Yu and that of L-SHADE; R is reconstruction.
OPTIMIZER_LABELS = {
    "ant-colony": "ants",
    "cma-es": "CMA-ES",
    "differential-evolution": "L-SHADE",
    "elite-genetic": "EGA",
    "firefly": "FA",
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
    BLINDED: "blinded",
    "distilled": "rule",
    "learned": "learned",
    "open-loop": "open loop",
    "reacting-loop": "reacting loop",
    "tuned": "tuned schedule",
}
# Recipes with several training or tuning seeds; what is tuned in them need not be a schedule.
SEVERAL_SEEDS = {**FITTED, "tuned": "tuned"}


def label(controller: str) -> str:
    """Return the display name: `fixed:60` is FA-60 and `spsfa` is SPSFA, as in the SPSFA paper.

    A group of training seeds, `learned:three-cases/*`, is "learned three-cases", without the parentheses of a
    single policy; a group of tunings, `open-loop:a/*@1`, is "open loop a@1". A price follows after an @. The
    source of a first population follows in words: `fixed:60,smooth_share=1` is "FA-60 (smooth)".
    """
    name = ControllerName.parse(controller)
    if name.optimizer in OPTIMIZER_LABELS:
        length = "" if name.iterations is None else f", {name.iterations} iterations"
        if name.family != "fixed":
            return f"{OPTIMIZER_LABELS[name.optimizer]}, {_controller_label(name.controller)}{length}"
        members, parts = _members(name)
        source = "".join(f", {part}" for part in parts)
        return f"{OPTIMIZER_LABELS[name.optimizer]}, {members} members{source}{length}"
    return controller if name.optimizer is not None else _controller_label(name)


def _controller_label(name: ControllerName) -> str:
    if name.seed == ALL_SEEDS and name.family in FITTED:
        return f"{SEVERAL_SEEDS[name.family]} {name.recipe}{name.price_suffix}"
    if name.family == "fixed":
        members, parts = _members(name)
        return f"FA-{members} ({', '.join(parts)})" if parts else f"FA-{members}"
    if name.family in FITTED and name.argument:
        families = FITTED if name.seed is None else SEVERAL_SEEDS
        return f"{families[name.family]} ({name.argument})"
    if name.family in ("spsfa", "spsfa-tip"):
        family, parameters = name.family.upper(), name.argument.replace(",", ", ")
        return f"{family} ({parameters})" if parameters else family
    return str(name)


def _members(name: ControllerName) -> tuple[str, tuple[str, ...]]:
    """Return the constant size of a population and its source in words; no words if the name states none."""
    size, _, rest = name.argument.partition(",")
    if not rest:
        return size, ()
    stated = parse_parameters(rest, FIRST_SOURCE)
    source = Source(**stated)
    if source.name == UNIFORM:
        return size, (UNIFORM,)
    parts = [SMOOTH if source.name == SMOOTH else f"{100 * source.smooth_share:g} % {SMOOTH}"]
    if "amplitude" in stated:
        parts.append(f"amplitude {source.amplitude:g}")
    return size, tuple(parts)
