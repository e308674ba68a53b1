"""The commands of the package: `python -m swarm_gym`, or `swarm-gym` after an installation."""

import sys
from collections.abc import Sequence
from importlib import import_module

# Module and purpose of each command by its name.
COMMANDS = {
    "plan": ("swarm_gym.plan", "plan a free path on a map"),
    "warm-up": ("swarm_gym.warm_up", "compile the kernels before they are needed"),
    "download": ("swarm_gym.scenarios.download", "download public maps"),
    "optimum": ("swarm_gym.reference.waypoint_optimum", "compute true optima"),
}


def main(arguments: Sequence[str] | None = None) -> None:
    """Run the command that is named first, with the other arguments; without one, print all commands.

    Args:
        arguments: the name of a command and its arguments; None are those of the command line.

    Raises:
        SystemExit: with the status of the command, or 2 for an unknown one; the message lists the valid ones.
    """
    name, *rest = [*(sys.argv[1:] if arguments is None else arguments), ""]
    if name in ("", "-h", "--help"):
        print("commands, each with --help:\n")
        for known, (module, purpose) in COMMANDS.items():
            print(f"  swarm-gym {known:9} {purpose}; also python -m {module}")
        return
    if name not in COMMANDS:
        print(f"error: unknown command {name!r}; valid: {', '.join(COMMANDS)}", file=sys.stderr)
        sys.exit(2)
    sys.argv = [f"swarm-gym {name}", *rest[:-1]]
    sys.exit(import_module(COMMANDS[name][0]).main())


if __name__ == "__main__":
    main()
