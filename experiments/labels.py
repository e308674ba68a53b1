"""Names of controllers as tables and figures print them."""


def label(controller: str) -> str:
    """The display name: `fixed:60` is FA-60 and `spsfa` is SPSFA, as in the paper."""
    family, _, argument = controller.partition(":")
    if family == "fixed":
        return f"FA-{argument}"
    if family == "ppo":
        return f"PPO ({argument})"
    if family.startswith("spsfa"):
        return f"{family.upper()} ({argument.replace(',', ', ')})" if argument else family.upper()
    return controller
