"""Height maps of generated terrains on the disk, since each takes seconds to make and 6.5 MB to keep.

They lie in the user's cache, in a folder for each version of NumPy and SciPy, on which their last digits
depend. The newest `MOST` files are kept.
"""

from contextlib import suppress
from io import BytesIO
from pathlib import Path

import numpy as np

from swarm_gym.files import user_cache, write_atomically
from swarm_gym.scenarios.terrain.generator import (
    SIDE,
    Floats,
    Terrain,
    TerrainDraws,
    heights_of,
    terrain_with,
)

MOST = 200  # files, 1.3 GB


def terrain_of(key: str, draws: TerrainDraws) -> Terrain:
    """Return the terrain of random numbers, whose height map is read from the cache if it is there.

    Args:
        key: name of the file in the cache, without its ending; it stands for these random numbers.
        draws: random numbers of the terrain.

    Raises:
        ScenarioError: if the generator cannot make the terrain.
    """
    path = _folder() / f"{key}.npy"
    heights = _read(path)
    if heights is None:
        heights = heights_of(draws)
        with suppress(OSError):  # a full or read-only disk only costs time
            _write(path, heights)
    return terrain_with(draws, heights)


def _folder() -> Path:
    import scipy

    return user_cache() / "terrain" / f"numpy-{np.__version__}-scipy-{scipy.__version__}"


def _read(path: Path) -> Floats | None:
    """Return the heights of a file; None if it is missing or damaged."""
    try:
        heights = np.load(path, allow_pickle=False)
    except (OSError, ValueError, EOFError):
        return None
    usable = isinstance(heights, np.ndarray) and heights.shape == (SIDE, SIDE) and heights.dtype == np.float64
    return heights if usable else None


def _write(path: Path, heights: Floats) -> None:
    content = BytesIO()
    np.save(content, heights)
    write_atomically(path, content.getvalue())
    files = sorted(path.parent.glob("*.npy"), key=lambda file: file.stat().st_mtime_ns)
    for old in files[:-MOST]:
        old.unlink(missing_ok=True)
