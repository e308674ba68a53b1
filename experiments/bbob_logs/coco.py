"""The format of COCO's logger `bbob`, which `cocopp` reads.

A folder has for each function a file `bbobexp_f<function>.info`, which lists instances, evaluations and final
precisions, and for each dimension two data files in `data_f<function>`: rows where the best value improved
(`.dat`) and rows of all iterations (`.tdat`). See N. Hansen et al., "COCO: a platform for comparing
continuous optimizers in a black-box setting", Optimization Methods and Software 36, 2021.
"""

from collections.abc import Sequence
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from experiments.bbob_logs.logged_run import LoggedGroup, LoggedRun
from swarm_gym.files import write_atomically

# Least precision that results are read for, as in COCO's own logs.
PRECISION = "1.000e-08"
DATA_FORMAT = "bbob-new2"
HEADER = (
    "% f evaluations | g evaluations | best noise-free fitness - Fopt ({:.12e}) + sum g_i+ | "
    "measured fitness | best measured fitness or single-digit g-values | x1 | x2..."
)


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
    identifier = algorithm.replace("'", "_")  # the file knows no quotation marks inside of texts
    lines = []
    for group in groups:
        stem = f"data_f{function}/bbobexp_f{function}_DIM{group.dimension}"
        for ending, all_rows in ((".dat", False), (".tdat", True)):
            text = "".join(_rows(run, all_rows) for run in group.runs)
            write_atomically(folder / f"{stem}{ending}", text)
        endings = [f"{run.instance}:{run.evaluations[-1]}|{run.precision[-1]:.1e}" for run in group.runs]
        lines += [
            f"suite = 'bbob', funcId = {function}, DIM = {group.dimension}, Precision = {PRECISION}, "
            f"algId = '{identifier}', logger = 'bbob', data_format = '{DATA_FORMAT}'",
            f"% {settings}",
            ", ".join([f"{stem}.dat", *endings]),
        ]
    # At last, so that it names only files that are complete.
    return write_atomically(folder / f"bbobexp_f{function}.info", "\n".join(lines) + "\n")


def _rows(run: LoggedRun, all_rows: bool) -> str:
    chosen: NDArray[np.bool_] = np.ones_like(run.improved) if all_rows else run.improved
    lines = [HEADER.format(run.least_value)]
    for evaluations, precision in zip(run.evaluations[chosen], run.precision[chosen], strict=True):
        value = precision + run.least_value
        lines.append(f"{evaluations} 0 {precision:+.9e} {value:+.9e} {value:+.9e}")
    return "\n".join(lines) + "\n"
