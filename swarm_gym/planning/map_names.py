"""Names of maps on command lines and in calls: a file of a kind that is read, a scenario, or neither."""

import os
from collections.abc import Sequence
from pathlib import Path, PurePath

from swarm_gym.errors import ScenarioError, shown
from swarm_gym.own_code import is_own
from swarm_gym.scenarios.formats.ros_image import PICTURES
from swarm_gym.scenarios.formats.ros_map import ENDINGS
from swarm_gym.scenarios.registry import is_known

MAX_LISTED = 3  # maps of a folder in a message
EXPECTED = "a map: .yaml or .yml of ROS's map_server, .map of Moving AI, .geojson or .json"


def ending_of(name: str | Path) -> str:
    """Return the ending of a file's name in small letters, such as `.yaml`."""
    return PurePath(name).suffix.lower()


def is_map_file(name: str, endings: Sequence[str]) -> bool:
    """Return whether a name stands for a map file, and not for a scenario.

    A file that exists and has one of the endings is a map file, whatever else its name has. Of the other
    names, scenarios are no map files, and names with one of the endings are.

    Args:
        name: name of a file, here or in the data folder, or of a scenario.
        endings: endings of map files, in small letters.

    Raises:
        ScenarioError: if it is neither; the message says what the name stands for, and which to give.
    """
    ending = ending_of(name)
    exists = os.path.isfile(name)
    if exists and ending in endings:
        return True
    if is_known(name) or is_own("scenario", name):
        return False
    if ending in endings and not os.path.isdir(name):
        return True
    if os.path.isdir(name):
        raise ScenarioError(f"map {shown(name)}: a folder; {_maps_in(name, endings)}")
    if ending in PICTURES:
        what = "a picture" if exists else "no such file, and by its ending a picture"
        raise ScenarioError(f"map {shown(name)}: {what}; {_description_of(name)}")
    if ending == ".scen":
        named = f", such as {shown(name[: -len(ending)])}" if os.path.isfile(name[: -len(ending)]) else ""
        raise ScenarioError(f"map {shown(name)}: a file of problems; name their map, a .map file{named}")
    if exists or ending or os.sep in name:
        what = "the file is not" if exists else "no file or scenario of this name; expected"
        raise ScenarioError(f"map {shown(name)}: {what} {EXPECTED}; or name a scenario such as case1")
    return False


def _maps_in(folder: str, endings: Sequence[str]) -> str:
    try:
        found = sorted(name for name in os.listdir(folder) if ending_of(name) in endings)
    except OSError as error:
        return f"it cannot be read: {error.strerror}"
    if not found:
        return f"it has no map; expected {EXPECTED}"
    listed = ", ".join(shown(os.path.join(folder, name)) for name in found[:MAX_LISTED])
    more = f" and {len(found) - MAX_LISTED} more" if len(found) > MAX_LISTED else ""
    return f"name a map in it: {listed}{more}"


def _description_of(picture: str) -> str:
    """Return which YAML file describes a picture, for a message."""
    stem = os.path.splitext(picture)[0]
    beside = [stem + ending for ending in ENDINGS if os.path.isfile(stem + ending)]
    if beside:
        return f"name the YAML file that describes it: {shown(beside[0])}"
    return (
        "name the YAML file that describes it, with image, resolution, origin, negate, occupied_thresh and "
        "free_thresh, as map_saver of ROS writes it"
    )
