"""The format of IOHprofiler's logger `Analyzer`, which IOHanalyzer and `iohinspector` read.

A folder has for each function a file `IOHprofiler_f<function>_<name>.json`, which lists runs, and for each
dimension a data file in `data_f<function>_<name>`: evaluations and the best value above f_opt, a block for
each run. See J. de Nobel et al., "IOHexperimenter: benchmarking platform for iterative optimization
heuristics", Evolutionary Computation 32, 2024.
"""

import json
from collections.abc import Sequence
from pathlib import Path
from typing import Any

from experiments.bbob_logs.logged_run import LoggedGroup, LoggedRun
from swarm_gym.files import write_atomically
from swarm_gym.scenarios.bbob.instance import FUNCTION_NAMES

# Version of IOHexperimenter whose files these are like.
VERSION = "0.4.2"
COLUMNS = ("evaluations", "raw_y")


def write_function(folder: Path, algorithm: str, settings: str, groups: Sequence[LoggedGroup]) -> Path:
    """Write the runs of one function in all dimensions; return the file that lists them.

    Args:
        folder: folder of the algorithm.
        algorithm: name of the algorithm.
        settings: a line on how the runs were made.
        groups: runs of one function, a group for each dimension.

    Raises:
        OSError: if a file cannot be written.
    """
    function = groups[0].function
    name = FUNCTION_NAMES[function - 1]
    scenarios = []
    for group in groups:
        path = f"data_f{function}_{name}/IOHprofiler_f{function}_DIM{group.dimension}.dat"
        write_atomically(folder / path, "".join(map(_block, group.runs)))
        runs = [_listed(run) for run in group.runs]
        scenarios.append({"dimension": group.dimension, "path": path, "runs": runs})
    listed = {
        "version": VERSION,
        "suite": "BBOB",
        "function_id": function,
        "function_name": name,
        "maximization": False,
        "algorithm": {"name": algorithm, "info": settings},
        "attributes": list(COLUMNS),
        "scenarios": scenarios,
    }
    # At last, so that it names only files that are complete.
    return write_atomically(
        folder / f"IOHprofiler_f{function}_{name}.json", json.dumps(listed, indent="\t") + "\n"
    )


def _listed(run: LoggedRun) -> dict[str, Any]:
    best = {
        "evals": int(run.evaluations[run.first_best]),
        "y": float(run.precision[-1]),
        "x": run.best_vector.tolist(),
    }
    return {"instance": run.instance, "evals": int(run.evaluations[-1]), "best": best}


def _block(run: LoggedRun) -> str:
    rows = zip(run.evaluations[run.improved], run.precision[run.improved], strict=True)
    lines = [" ".join(COLUMNS), *(f"{evaluations} {precision:.10e}" for evaluations, precision in rows)]
    return "\n".join(lines) + "\n"
