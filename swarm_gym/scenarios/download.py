"""Download public maps into the data folder: `python -m swarm_gym.scenarios.download [NAME ...]`."""

import argparse
import hashlib
import http.client
import sys
import urllib.error
import urllib.request
from collections.abc import Sequence
from pathlib import PurePosixPath
from typing import NamedTuple

from swarm_gym.command import command
from swarm_gym.files import write_atomically
from swarm_gym.scenarios.formats.data_files import data_folder

TIMEOUT = 30  # seconds to wait for an answer of the server


class RemoteFolder(NamedTuple):
    """A folder of one commit of a repository, so that its files do not change.

    Attributes:
        url: address of the folder.
        credit: authors and licence.
    """

    url: str
    credit: str


class RemoteFile(NamedTuple):
    """A file to download.

    Attributes:
        source: folder that has the file.
        path: path of the file below the url of the source.
        local: path of the file below the data folder.
        size: size in bytes.
        sha256: digest of the content, 64 hexadecimal digits.
    """

    source: RemoteFolder
    path: str
    local: str
    size: int
    sha256: str


class DownloadError(Exception):
    """A file could not be downloaded; the message names the file and the reason."""


MOVING_AI = RemoteFolder(
    "https://raw.githubusercontent.com/nathansttt/hog2/70842df4bb970ebba86c2c252c7fe7f7212fe909/",
    "Moving AI benchmarks (movingai.com), Open Data Commons Attribution License; cite N. R. Sturtevant, "
    "Benchmarks for grid-based pathfinding, IEEE TCIAIG 4(2):144-148, 2012",
)
TURTLEBOT3 = RemoteFolder(
    "https://raw.githubusercontent.com/ROBOTIS-GIT/turtlebot3/f5e572a5a7dd0d8d6f76b23848f8a0b9411b489f/",
    "ROBOTIS TurtleBot3, Apache License 2.0",
)
TURTLEBOT_SIMULATOR = RemoteFolder(
    "https://raw.githubusercontent.com/turtlebot/turtlebot_simulator/beae4b3cdf806fe82ab75fd933189c67e89ed8b0/",
    "TurtleBot simulator (github.com/turtlebot), BSD License",
)
TURTLEBOT_APPS = RemoteFolder(
    "https://raw.githubusercontent.com/turtlebot/turtlebot_apps/4bbafc7bfdfc5888ba03b52611bdb56d86b22967/",
    "TurtleBot applications (github.com/turtlebot), BSD License",
)


def _moving_ai(path: str, size: int, sha256: str) -> RemoteFile:
    return RemoteFile(MOVING_AI, path, f"movingai/{PurePosixPath(path).name}", size, sha256)


def _turtlebot3(name: str, size: int, sha256: str) -> RemoteFile:
    return RemoteFile(TURTLEBOT3, f"turtlebot3_navigation2/map/{name}", f"ros/{name}", size, sha256)


def _turtlebot(name: str, size: int, sha256: str) -> RemoteFile:
    return RemoteFile(TURTLEBOT_SIMULATOR, f"turtlebot_gazebo/maps/{name}", f"ros/{name}", size, sha256)


def _willow(ending: str, size: int, sha256: str) -> RemoteFile:
    name = f"willow-2010-02-18-0.10.{ending}"
    return RemoteFile(TURTLEBOT_APPS, f"turtlebot_navigation/maps/{name}", f"ros/{name}", size, sha256)


# Files of each map.
MAPS: dict[str, tuple[RemoteFile, ...]] = {
    "den400d": (
        _moving_ai(
            "maps/dao/den400d.map", 69717, "12a22ae77bdb13329d1921a72b09f0b8e5d5e9cc10ea5cd5034f15025af29184"
        ),
        _moving_ai(
            "scenarios/dao/den400d.map.scen",
            43701,
            "3fc22b12139391287aef732fc7d3c607f1437024d4b93b341ca33adba6b9e4fb",
        ),
    ),
    "arena": (
        _moving_ai(
            "maps/dao/arena.map", 2485, "9887c3022fb76d8e2b49db4a54641e31df79607cf96c2a0ec362702808113d4d"
        ),
        _moving_ai(
            "scenarios/dao/arena.map.scen",
            7269,
            "b631475cd551e2e5bb6d4585131197c13be27fcea18a19deb03c1ebf9fce2fc8",
        ),
    ),
    "random-64-64-20": (
        _moving_ai(
            "maps/mapf/random-64-64-20.map",
            4195,
            "0702bcc7df0529a819845c5d70050464c0946ae234881f27b9f4202b81f40c83",
        ),
    ),
    "room-64-64-8": (
        _moving_ai(
            "maps/mapf/room-64-64-8.map",
            4195,
            "56946a2411a64631f4ab7ca8dd17439e619ad066fc1d2bf2fd19516fc24f28dc",
        ),
    ),
    "maze-128-128-10": (
        _moving_ai(
            "maps/mapf/maze-128-128-10.map",
            16549,
            "2281ef15df0c94efc79b7c62f0c60ce4cb22c43c2cc584226d307c7676d53986",
        ),
    ),
    "Berlin_1_256": (
        _moving_ai(
            "maps/mapf/Berlin_1_256.map",
            65828,
            "c1be6a222e9b138e64d65ad50da92fca447f75191af9aa3022994fe3487abe56",
        ),
    ),
    "Paris_1_256": (
        _moving_ai(
            "maps/mapf/Paris_1_256.map",
            65829,
            "85ec535004685c9fb474954a24bd14395a21cea338bdcfdf7d9a2f21c587f87d",
        ),
    ),
    "warehouse-20-40-10-2-2": (
        _moving_ai(
            "maps/mapf/warehouse-20-40-10-2-2.map",
            55961,
            "eae2a3f5298b1e113bfc32b5b4404f5de5105365d237df63cc9dc9e2d1c73713",
        ),
    ),
    "turtlebot3_world": (
        _turtlebot3(
            "turtlebot3_world.yaml", 144, "4841b5cc958b92f192cf5cf58445ee7b5f1d94dc63b580e2bc676737050e247d"
        ),
        _turtlebot3(
            "turtlebot3_world.pgm", 147508, "57eaad9291fcf02e068cbcd1874990694838a74a3304755bae1bd7b726c4522f"
        ),
    ),
    "playground": (
        _turtlebot(
            "playground.yaml", 146, "97d1b8ca785e9c8c8fe0b8ff2adc041f7f75ad6485da0c263772173859b7c2f0"
        ),
        _turtlebot(
            "playground.pgm", 44868, "88bd66840425e395c238e220c8de88ef5684b8f82aa260466952f772540dd3d2"
        ),
    ),
    "willow-2010-02-18-0.10": (
        _willow("yaml", 145, "e10d1ba93e8f204a581641a5da85d6803c89c4216e619637a2fcfe0317d290af"),
        _willow("pgm", 344182, "d7644ea5eabbbc77dcb6f136774f9b159a6514151f9c411bbd6c383f592bd6e0"),
    ),
}


def download(file: RemoteFile, force: bool = False) -> str:
    """Download a file into the data folder unless it is there; it is written completely or not at all.

    Args:
        file: file to download.
        force: whether to replace a file of different content.

    Returns:
        What was done, for a message.

    Raises:
        DownloadError: if the file cannot be downloaded, its content differs from the expected one, or another
            file is in its place.
    """
    target = data_folder() / file.local
    try:
        if target.exists():
            if _digest(target.read_bytes()) == file.sha256:
                return "is there"
            if not force:
                raise DownloadError(f"{target} differs from the public file; replace it with --force")
        write_atomically(target, _fetch(file))
    except OSError as error:
        raise DownloadError(f"{target} cannot be written: {error}") from error
    return f"downloaded, {file.size} bytes"


def main(arguments: Sequence[str] | None = None) -> int:
    """Download the given maps, or all; return 0, or 1 if a download failed."""
    parser = argparse.ArgumentParser(
        prog="python -m swarm_gym.scenarios.download",
        description="Download public maps into the data folder (SWARM_GYM_DATA, or the user's data folder).",
    )
    parser.add_argument(
        "names",
        nargs="*",
        metavar="NAME",
        help=f"map to download, e.g. arena; without a name all: {', '.join(MAPS)}",
    )
    parser.add_argument(
        "--force", action="store_true", help="replace files whose content differs from the public one"
    )
    options = parser.parse_args(arguments)
    for name in options.names:
        if name not in MAPS:
            parser.error(f"unknown map {name!r}; valid: {', '.join(MAPS)}")
    files = [file for name in options.names or MAPS for file in MAPS[name]]
    print(f"into {data_folder()}")
    failed = 0
    with command(kept="complete files are kept"):
        for file in files:
            try:
                print(f"{file.local}: {download(file, options.force)}", flush=True)
            except DownloadError as error:
                failed += 1
                print(f"{file.local}: {error}", file=sys.stderr)
    for source in dict.fromkeys(file.source for file in files):
        print(source.credit)
    if failed:
        print(f"{failed} of {len(files)} files could not be downloaded", file=sys.stderr)
    return int(failed > 0)


def _fetch(file: RemoteFile) -> bytes:
    url = file.source.url + file.path
    try:
        with urllib.request.urlopen(url, timeout=TIMEOUT) as response:
            content = response.read(file.size + 1)
    except (OSError, http.client.HTTPException) as error:
        reason = error.reason if isinstance(error, urllib.error.URLError) else error
        raise DownloadError(
            f"{url} cannot be downloaded: {reason}; check the connection and try again"
        ) from error
    if len(content) != file.size or _digest(content) != file.sha256:
        raise DownloadError(f"{url} has changed: expected {file.size} bytes with SHA-256 {file.sha256}")
    return content


def _digest(content: bytes) -> str:
    return hashlib.sha256(content).hexdigest()


if __name__ == "__main__":
    sys.exit(main())
