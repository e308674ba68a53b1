"""Convert the file of 56 terrains: `python -m swarm_gym.scenarios.terrain.convert_uav56 Model56.pkl`."""

import argparse
import sys
from collections.abc import Sequence
from io import BytesIO
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from swarm_gym.command import command
from swarm_gym.errors import ScenarioError, shown
from swarm_gym.files import write_atomically
from swarm_gym.outputs import require_outputs
from swarm_gym.scenarios.formats.data_files import data_folder
from swarm_gym.scenarios.terrain.safe_pickle import load_arrays
from swarm_gym.scenarios.terrain.uav56 import COUNT, FILE, fault_of

# Names in the published file, by names in the one that is written.
PARTS = {"heights": "H", "threats": "threats", "start": "start", "goal": "end"}


def main(arguments: Sequence[str] | None = None) -> int:
    """Write the terrains of a pickle as arrays without code; return the exit status."""
    parser = argparse.ArgumentParser(
        prog="python -m swarm_gym.scenarios.terrain.convert_uav56",
        description="Convert Model56.pkl, the published file of 56 terrains, into arrays that hold no code. "
        "The pickle is read by a reader that refuses everything but arrays and numbers.",
    )
    parser.add_argument("file", type=Path, metavar="Model56.pkl", help="the published file")
    parser.add_argument(
        "--output",
        type=Path,
        metavar="FILE",
        help=f"file to write, .npz (default: {FILE} in the data folder, where uav56:0 is read from)",
    )
    options = parser.parse_args(arguments)
    target = options.output or data_folder() / FILE
    with command(ScenarioError):
        require_outputs([target], [options.file])
        arrays: dict[str, Any] = {**converted(options.file)}
        content = BytesIO()
        np.savez_compressed(content, **arrays)
        write_atomically(target, content.getvalue())
        print(f"{COUNT} terrains written to {target}")
    return 0


def converted(path: Path) -> dict[str, NDArray[np.float64]]:
    """Return the arrays of all terrains of a pickle by names such as `heights_0`.

    Raises:
        ScenarioError: if the pickle is refused, or has other terrains or arrays of other shapes.
    """
    found = load_arrays(path)
    if not isinstance(found, dict | list) or len(found) != COUNT:
        raise ScenarioError(
            f"{path}: expected {COUNT} terrains, got {shown(type(found).__name__)} of another size"
        )
    arrays: dict[str, NDArray[np.float64]] = {}
    for number in range(COUNT):
        if isinstance(found, dict) and number not in found:
            raise ScenarioError(f"{path}: expected terrains 0 to {COUNT - 1}, terrain {number} is missing")
        terrain = found[number]
        for part, name in PARTS.items():
            if not isinstance(terrain, dict) or name not in terrain:
                raise ScenarioError(f"{path}: terrain {number} has no {name!r}; is it the file of MetaBox?")
            try:
                values = np.array(terrain[name], dtype=np.float64)
            except (TypeError, ValueError) as error:
                raise ScenarioError(f"{path}: terrain {number}: {name} must be numbers") from error
            arrays[f"{part}_{number}"] = values.ravel() if part in ("start", "goal") else values
        if (fault := fault_of({part: arrays[f"{part}_{number}"] for part in PARTS})) is not None:
            raise ScenarioError(f"{path}: terrain {number}: {fault}")
    return arrays


if __name__ == "__main__":
    sys.exit(main())
