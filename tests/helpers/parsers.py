"""Parsers of files as functions of any bytes, for the fuzzer and for the test of its finds.

`parse(name, content)` reads the content and ignores the documented errors; any other error is a find.
"""

import io
import itertools
import json
import math
import os
import pickle
import warnings
from collections.abc import Callable
from pathlib import Path
from typing import NamedTuple

import numpy as np
import pytest
import safetensors.numpy  # noqa: F401, so that the fuzzer sees what it does

from agents import make_controller
from swarm_gym.controllers.controller import SizeLimits
from swarm_gym.controllers.distilled import DISTILLED, DistilledFileError
from swarm_gym.controllers.learned.manifest import PolicyFileError, check_manifest, tensor_shapes
from swarm_gym.controllers.learned.policy_file import MAX_FILE, POLICIES, encode_policy, load_policy
from swarm_gym.controllers.open_loop import OPEN_LOOPS, OpenLoopFileError
from swarm_gym.controllers.packaged import Packaged
from swarm_gym.controllers.registry import load_learned
from swarm_gym.controllers.tuned import TUNED, TunedFileError
from swarm_gym.errors import ScenarioError, SwarmGymError
from swarm_gym.observation import make_observation
from swarm_gym.planning.feature_map import read_feature_map
from swarm_gym.scenarios import expand_name
from swarm_gym.scenarios.formats import esri_grid
from swarm_gym.scenarios.formats.moving_ai import read_map, read_scenarios
from swarm_gym.scenarios.formats.ros_map import read_graded_ros_map, read_ros_map
from swarm_gym.scenarios.formats.threat_file import read_threats
from swarm_gym.scenarios.graded_map import Grading
from swarm_gym.scenarios.terrain.safe_pickle import load_arrays
from swarm_gym.training.presets import PRESETS, PresetError, load_preset

for _package in ("PIL.PngImagePlugin", "PIL.PpmImagePlugin", "pyproj", "shapely", "yaml"):
    pytest.importorskip(_package, reason="needs the extra `maps`")

LONGEST_MESSAGE = 5000  # characters

MAP = b"type octile\nheight 3\nwidth 4\nmap\n..@.\nGSTW\n.O..\n"
PROBLEMS = b"version 1\n0\tsmall.map\t4\t3\t1\t1\t3\t1\t2.41421356\n\n1 small.map 4 3 0 0 3 0 3\n"
YAML = (
    b"image: small.pgm\nresolution: 0.05\norigin: [-10.0, 1e1, 0]\nnegate: 0\noccupied_thresh: 0.65\n"
    b"free_thresh: 0.196 # a comment\nmode: trinary\n"
)
GRID = (
    b"ncols 3\nnrows 2\nxllcorner 0.5\nyllcenter -1e1\ncellsize 25\nNODATA_value -9999\n"
    b"1 2.5 3\n-9999 5 6e2\n"
)
THREATS = (
    b'{"type": "FeatureCollection", "features": [{"type": "Feature", '
    b'"properties": {"radius": 75, "height": 30.5}, '
    b'"geometry": {"type": "Point", "coordinates": [7.5, 46.5]}}]}'
)
IMAGE = b"P5\n# a comment\n4 3\n255\n" + bytes([254, 205, 0] * 4)
NAMES = (
    b"random-fields:train:0-9", b"rooms:0-7", b"dynamic:case1-gate@9-drive@1,every=2,distance=3.5",
    b"function:rastrigin-10-shifted:0-3", b"function:bbob-15-10-1-5", b"moving-ai:den400d#0-799",
    b"metabox-bbob:4-10-biased-seed:1-5", b"terrain:train-few:0-3", b"uav56:0-55",
    b"terrain-file:a.asc?start=0.5,-1,150&goal=2,0,150&altitude=90-200.5&turn=30&threats=t.geojson",
    b"moving-ai:a?start=0,0&goal=2,0",
    b"ros:a?start=0.5,-1&goal=2,0&inflate=0.1", b"routes:turtlebot3-A-B", b"block:5-5", b"P1",
)  # fmt: skip


def decides(name: str) -> None:
    """Assert that the decisions of a controller are valid.

    Raises:
        ValueError: if no controller has that name, or its file is not readable.
    """
    controller = make_controller(name)
    controller.reset(2)
    width = len(make_observation(controller.observation).features)
    assert np.isfinite(controller.act(np.tile(np.linspace(0, 1, width), (2, 1)))).all()
    assert type(controller.initial_population_size) is int


class Parser(NamedTuple):
    """A parser of files."""

    suffix: str
    seeds: Callable[[], list[bytes]]  # whole files, which the fuzzer begins with
    read: Callable[[Path], object]
    refusals: tuple[type[Exception], ...]  # what it is documented to raise
    words: tuple[str, ...] = ()  # that malformed files are made of


def parse(name: str, content: bytes, folder: Path) -> bool:
    """Return whether a parser accepts the content, which is written to a file in the folder."""
    parser = PARSERS[name]
    # Some readers keep what they have read, and know a file that has changed by a clock that ticks slowly.
    path = folder / f"{next(_numbers)}{parser.suffix}"
    path.write_bytes(content)
    try:
        parser.read(path)
    except parser.refusals as error:
        if len(str(error)) > LONGEST_MESSAGE:
            raise AssertionError("a message longer than a screen") from error
        return False
    finally:
        path.unlink()
    return True


_numbers = itertools.count()


def _read_image(path: Path) -> object:
    described = path.with_suffix(".yaml")
    described.write_bytes(YAML.replace(b"small.pgm", path.name.encode()))
    try:
        return read_ros_map(described)
    finally:
        described.unlink()


def _read_yaml(path: Path) -> object:
    image = path.with_name("small.pgm")
    if not image.exists():
        image.write_bytes(IMAGE)
    return read_ros_map(path)


def _read_array(path: Path) -> object:
    described = path.with_suffix(".yaml")
    described.write_bytes(YAML.replace(b"small.pgm", path.name.encode()) + b"mode: raw\n")
    try:
        return read_graded_ros_map(described, Grading(unknown="dear"))
    finally:
        described.unlink()


def _read_features(path: Path) -> object:
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        return read_feature_map(path, (-20.0, -20.0), (20.0, 20.0), 0.1, None, None)


def _expand(path: Path) -> object:
    return expand_name(os.fsdecode(path.read_bytes()))


def _deciding(family: str) -> Callable[[Path], None]:
    def decide(path: Path) -> None:
        decides(f"{family}:{path}")

    return decide


def _read_manifest(path: Path) -> object:
    """Read a policy file whose manifest is any JSON and whose tensors fit it."""
    try:
        manifest = json.loads(path.read_bytes())
    except (ValueError, RecursionError) as error:
        raise PolicyFileError("no JSON") from error
    if not isinstance(manifest, dict):
        raise PolicyFileError("no manifest")
    check_manifest(path, {**manifest, "weights_sha256": "0" * 64, "manifest_sha256": "0" * 64})
    shapes = tensor_shapes(manifest)
    if 4 * sum(map(math.prod, shapes.values())) > MAX_FILE / 64:  # to be fast
        raise PolicyFileError("large")
    path.write_bytes(
        encode_policy({name: np.zeros(shape, np.float32) for name, shape in shapes.items()}, manifest)
    )
    load_policy(path)
    limits = SizeLimits(manifest["min_population_size"], manifest["max_population_size"])
    return load_learned(path, limits)


def _files(packaged: Packaged) -> list[Path]:
    """Return all files, those of the laboratory too, the smallest first."""
    found = [path for folder in packaged.folders for path in folder.rglob(f"*{packaged.suffix}")]
    return sorted(found, key=lambda path: (path.stat().st_size, path.name))


def _packaged_json(packaged: Packaged) -> list[bytes]:
    files = _files(packaged)
    found = [json.loads(path.read_text(encoding="utf-8")) for path in files[:3]]
    return [json.dumps({**content, "manifest": {}}).encode() for content in found]


def _presets() -> list[bytes]:
    return [path.read_bytes() for path in _files(PRESETS)]


def _policies() -> list[bytes]:
    return [_files(POLICIES)[0].read_bytes()]


def _manifests() -> list[bytes]:
    found = [load_policy(path)[1] for path in _files(POLICIES) if path.stem == "0"]
    return [json.dumps({**manifest, "config": {}, "provenance": {}}).encode() for manifest in found]


def _features() -> list[bytes]:
    ring = [[0, 0], [4, 0], [4, 4], [1, 1], [0, 0]]
    shapes = {
        "Polygon": [ring, [[3, 1], [3.5, 1], [3.5, 2], [3, 1]]],
        "MultiPolygon": [[ring[:3] + ring[:1]], []],
        "MultiLineString": [[[0, 0, 1], [1e0, -1]]],
        "Point": [7.25, 8],
    }
    geometries = [{"type": kind, "coordinates": one} for kind, one in shapes.items()]
    features = [
        {"type": "Feature", "id": 1, "properties": {"name": "a"}, "geometry": one} for one in geometries
    ]
    features.append({"type": "Feature", "geometry": {"type": "GeometryCollection", "geometries": geometries}})
    crs = {"type": "name", "properties": {"name": "urn:ogc:def:crs:OGC:1.3:CRS84"}}
    collected = {"type": "FeatureCollection", "features": [*features, None]}
    return [
        json.dumps(one).encode() for one in (collected, {**collected, "crs": crs}, features[0], geometries[1])
    ]


def _picture(kind: str, mode: str) -> bytes:
    from PIL import Image

    content = io.BytesIO()
    Image.fromarray(np.array([[0, 254], [205, 254]], np.uint8)).convert(mode).save(content, kind)
    return content.getvalue()


def _arrays() -> list[bytes]:
    found = []
    for array in (np.zeros((3, 5), np.int8), np.full((2, 2), 255, np.uint8), np.zeros((2, 3), np.int16)):
        with io.BytesIO() as file:
            np.save(file, array)
            found.append(file.getvalue())
    return found


def _pictures() -> list[bytes]:
    kinds = [("PNG", "L"), ("PNG", "RGBA"), ("PNG", "P"), ("PNG", "I;16"), ("BMP", "L"), ("BMP", "RGB")]
    return [_picture(*kind) for kind in (*kinds, ("JPEG", "L"), ("JPEG", "RGB"))]


_JSON = (
    "null", "-1", "[", "{", "1e999", "NaN", "Infinity", "9" * 18, "0.5", "[]", "{}", '""', "true", "\\u0000",
    "\\ud800",
)  # fmt: skip
_YAML = (
    "!!python/object", "!!int", "&a", "*a", "<<: ", "- ", "{", "[", "? ", "|\n", ">\n", "---", "%YAML 1.1\n",
    "image", "origin", "nan", "1e999", "../", "..", "/etc/passwd", "\\x00", "true", "scale", "raw",
)  # fmt: skip
_IMAGE = (
    "P1", "P2", "P3", "P4", "P6", "Pf", "P7", "65535", "99999999", "IHDR", "IDAT", "IEND", "PLTE", "tRNS",
    "iCCP", "zTXt", "iTXt", "acTL", "fcTL", "eXIf",
)  # fmt: skip
_TOML = (
    "like = ", "'''", '"""', "inf", "nan", "0x", "1979-05-27", "[[", "]]", "\\U0010FFFF", "= {", "true",
)  # fmt: skip

PARSERS = {
    "moving-ai-map": Parser(".map", lambda: [MAP], read_map, (ScenarioError,), ("height ", "width ", "\r\n")),
    "moving-ai-problems": Parser(
        ".scen", lambda: [PROBLEMS], read_scenarios, (ScenarioError,), ("1e9", "\t")
    ),
    "ros-yaml": Parser(".yaml", lambda: [YAML], _read_yaml, (ScenarioError,), _YAML),
    "ros-image": Parser(
        ".pgm",
        lambda: [IMAGE, IMAGE.replace(b"P5", b"P2"), *_pictures()],
        _read_image,
        (ScenarioError,),
        _IMAGE,
    ),
    "ros-array": Parser(
        ".npy", _arrays, _read_array, (ScenarioError,), ("fortran_order", "'|u1'", "(9999,9999)", "V2", "O")
    ),
    "geojson": Parser(
        ".geojson",
        _features,
        _read_features,
        (ScenarioError,),
        (*_JSON, "LineString", "MultiPoint", "EPSG:3857", "geometries", "features", "1e-300", "179.9"),
    ),
    "esri-grid": Parser(
        ".asc",
        lambda: [GRID],
        esri_grid.read,
        (ScenarioError,),
        ("xllcenter ", "dx ", "dy ", "nan", "1e999", "\r\n"),
    ),
    "threats": Parser(
        ".geojson", lambda: [THREATS], read_threats, (ScenarioError,), (*_JSON, "top", "crs", "EPSG:32632")
    ),
    "pickle": Parser(
        ".pkl",
        lambda: [pickle.dumps({"H": np.eye(3), "n": np.float64(2.5)}, protocol) for protocol in (2, 4, 5)],
        load_arrays,
        (ScenarioError,),
        ("cos\nsystem\n", "(S'x'\ntR.", "c__builtin__\neval\n", "numpy", "dtype", "ndarray", "latin1"),
    ),
    "scenario-name": Parser(
        ".txt", lambda: list(NAMES), _expand, (SwarmGymError,), ("-shifted:", "0-999999", "@", "#")
    ),
    "preset": Parser(".toml", _presets, lambda path: load_preset(str(path)), (PresetError,), _TOML),
    "policy": Parser(".safetensors", _policies, load_learned, (PolicyFileError,), _JSON),
    "manifest": Parser(
        ".json", _manifests, _read_manifest, (PolicyFileError,), (*_JSON, "priced", "base", "lstm")
    ),
    "open-loop": Parser(
        ".json", lambda: _packaged_json(OPEN_LOOPS), _deciding("open-loop"), (OpenLoopFileError,), _JSON
    ),
    # What a file of a tuned controller names may be unknown or out of range.
    "tuned": Parser(
        ".json", lambda: _packaged_json(TUNED), _deciding("tuned"), (TunedFileError, ValueError), _JSON
    ),
    "distilled": Parser(
        ".json", lambda: _packaged_json(DISTILLED), _deciding("distilled"), (DistilledFileError,), _JSON
    ),
}
