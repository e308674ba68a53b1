"""The commands of the package: `swarm-gym` after an installation, or `python -m swarm_gym`."""

import os
import sys
from collections.abc import Sequence
from contextlib import suppress
from importlib import import_module
from types import ModuleType
from typing import NamedTuple, NoReturn

from swarm_gym.command import INTERRUPTED, quiet_without_readers
from swarm_gym.errors import MissingExtraError


class Command(NamedTuple):
    """A command: its module and its purpose."""

    module: str
    purpose: str


COMMANDS = {
    "plan": Command("swarm_gym.plan", "plan a free path on a map"),
    "train": Command("swarm_gym.training.command_line", "train a policy (extra train)"),
    "tune": Command("swarm_gym.tuning.command_line", "tune a schedule or an open loop (extra train)"),
    "compare": Command("swarm_gym.comparing.command_line", "compare controllers, with intervals"),
    "verify": Command("experiments.verify", "run stored scores again (in a checkout)"),
    "warm-up": Command("swarm_gym.warm_up", "compile the kernels before they are needed"),
    "download": Command("swarm_gym.scenarios.download", "download public maps"),
    "optimum": Command("swarm_gym.reference.waypoint_optimum", "compute true optima"),
}


def main(arguments: Sequence[str] | None = None) -> None:
    """Run the command that is named first, with the other arguments; without one, print all commands.

    Args:
        arguments: the name of a command and its arguments; None takes the command line.

    Raises:
        SystemExit: with the status of the command, 1 if the installation lacks what it needs, or 2 for an
            unknown one; the message says what to do.
    """
    name, *rest = [*(sys.argv[1:] if arguments is None else arguments), ""]
    with quiet_without_readers():
        if name not in ("", "-h", "--help"):
            _run(name, rest[:-1])
        print("commands, each with --help:\n")
        for known, (module, purpose) in COMMANDS.items():
            print(f"  swarm-gym {known:9} {purpose}; also python -m {module}")


def _run(name: str, arguments: list[str]) -> NoReturn:
    if name not in COMMANDS:
        print(f"error: unknown command {name!r}; valid: {', '.join(COMMANDS)}", file=sys.stderr)
        sys.exit(2)
    sys.argv = [f"swarm-gym {name}", *arguments]
    if not sys.flags.safe_path:
        with suppress(FileNotFoundError):  # the folder may have been deleted
            sys.path.append(os.getcwd())  # for own code, as with `python -m`, but behind what is installed
    sys.exit(_module_of(name).main())


def _module_of(name: str) -> ModuleType:
    """Return the module of a command; end with a message if the installation lacks what it needs."""
    module = COMMANDS[name].module
    if module.startswith("experiments."):
        from swarm_gym.controllers import packaged

        if not packaged.has_laboratory():
            sys.exit(f"error: swarm-gym {name} {packaged.WITHOUT_LABORATORY}")
        sys.path.append(str(packaged.LABORATORY.parent))
    try:
        return import_module(module)
    except ModuleNotFoundError as error:
        if (error.name or "").startswith("swarm_gym"):
            raise
        sys.exit(f"error: {MissingExtraError(f'swarm-gym {name}', str(error.name), 'train')}")
    except KeyboardInterrupt:  # while it is imported; the commands themselves say what they have kept
        print("interrupted before it began", file=sys.stderr)
        sys.exit(INTERRUPTED)


if __name__ == "__main__":
    main()
