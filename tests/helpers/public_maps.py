"""Public maps, which tests need in the folder that SWARM_GYM_DATA names."""

from pathlib import PurePath

import pytest

from swarm_gym.errors import ScenarioError
from swarm_gym.scenarios.formats.data_files import find_data_file


def needed(name):
    """Return the path of a file in the data folder, or skip the test if the folder lacks it."""
    try:
        return find_data_file(name)
    except ScenarioError:
        pytest.skip(f"needs {PurePath(name).name} in the folder that SWARM_GYM_DATA names")
