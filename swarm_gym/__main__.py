"""The commands of the package: `python -m swarm_gym`."""

COMMANDS = {
    "swarm_gym.plan": "plan a free path on a map",
    "swarm_gym.warm_up": "compile the kernels before they are needed",
    "swarm_gym.scenarios.download": "download public maps",
    "swarm_gym.reference.waypoint_optimum": "compute true optima",
}


def main() -> None:
    """Print the commands."""
    width = max(map(len, COMMANDS))
    print("commands, each with --help:\n")
    for name, purpose in COMMANDS.items():
        print(f"  python -m {name:{width}}  {purpose}")


if __name__ == "__main__":
    main()
