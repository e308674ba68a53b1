"""Packed replays for a report: recordings, quantised and compressed.

Coordinates are rounded to a grid of 2^bits points over the view of the map. They are stored as differences to
those of the same member in the frame before; `replay.js` unpacks them. A replay takes at most `MOST_BYTES` of
the report: if needed, the grid becomes coarser, paths get fewer points, and then members are left out.
"""

import base64
import json
import zlib
from collections.abc import Sequence
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from experiments.report.map_picture import extent_of
from experiments.report.recording import Frame, Recording
from experiments.runs.labels import label
from experiments.runs.run import Floats

Integers = NDArray[np.int64]

MOST_BYTES = 300_000
DIGITS = 6  # digits of the numbers beside the map
FEASIBLE, NEW, REMOVED = 1, 2, 4  # flags of a member; REMOVED: it is missing in the next frame


class Fineness(NamedTuple):
    """The precision with which a recording is kept.

    Attributes:
        bits: bits of a coordinate.
        points: greatest number of points of a path.
        every: one of this many members is kept.
    """

    bits: int
    points: int
    every: int


LADDER = (
    Fineness(10, 33, 1), Fineness(9, 33, 1), Fineness(9, 17, 1), Fineness(9, 17, 2), Fineness(8, 17, 4),
    Fineness(8, 9, 8), Fineness(7, 9, 16),
)  # fmt: skip


def pack(recording: Recording) -> dict[str, Any]:
    """Return a recording as a JSON value of at most `MOST_BYTES`."""
    for fineness in LADDER:
        packed = {**_facts(recording), **_populations(recording, fineness)}
        if len(json.dumps(packed)) <= MOST_BYTES:
            break
    return packed


def _facts(recording: Recording) -> dict[str, Any]:
    """Return names, iterations and courses of a recording."""
    run, frames = recording.run, recording.frames
    iterations = [frame.iteration for frame in frames]
    names = ("population_collision", "population_size", "repair_degree", "best_fitness", "evaluations")
    return {
        "controller": run.controller,
        "label": label(run.controller),
        "points": recording.are_points,
        "frames": iterations,
        "finalFitness": run.final_fitness,
        "courses": {
            name: [float(f"{value:.{DIGITS}g}") for value in run.course(name)[: iterations[-1] + 1]]
            for name in names
        },
    }


def _populations(recording: Recording, fineness: Fineness) -> dict[str, Any]:
    """Return the populations and best paths of a recording, packed."""
    bits, points, every = fineness
    frames = recording.frames
    paths = [
        _quantised(_with_points(frame.paths, min(frame.paths.shape[1], points))[::every], frame, bits)
        for frame in frames
    ]
    longest = min(points, max(len(frame.best_path) for frame in frames))
    best = [_quantised(_with_points(frame.best_path[None], longest), frame, bits) for frame in frames]
    varying, fixed = _columns(paths)
    streams = [_differences([frame[:, varying] for frame in paths]), _differences(best)]
    content = b"".join([*(_planes(stream) for stream in streams), _flags(frames, every)])
    robots = [frame.robot for frame in frames]
    packed = zlib.compress(content, level=9)
    return {
        "bits": bits,
        "every": every,
        "sizes": [len(frame) for frame in paths],
        "members": [len(frame.feasible) for frame in frames],
        "feasible": [int(frame.feasible.sum()) for frame in frames],
        "added": [int(frame.new.sum()) for frame in frames],
        "removed": [int(frame.removed.sum()) for frame in frames],
        "width": paths[0].shape[1],
        "bestWidth": best[0].shape[1],
        "varying": varying.tolist(),
        "fixed": fixed.tolist(),
        "robots": None
        if all(robot is None for robot in robots)
        else [
            None if robot is None else _quantised(robot[None, None], frame, bits)[0].tolist()
            for robot, frame in zip(robots, frames, strict=True)
        ],
        "data": base64.b64encode(packed).decode(),
    }


def _with_points(paths: Floats, number: int) -> Floats:
    """Return paths, (m, k, 2), with `number` points, evenly chosen; points repeat if there are too few."""
    return paths[:, np.linspace(0, paths.shape[1] - 1, number).round().astype(np.int64)]


def _quantised(paths: Floats, frame: Frame, bits: int) -> Integers:
    """Return coordinates as integers of `bits` bits, (m, 2 k); 0 is the lower end of the map."""
    low, high = np.reshape(extent_of(frame.scenario), (2, 2))
    steps = (1 << bits) - 1
    scaled = np.rint((paths - low) / (high - low) * steps)
    return np.clip(scaled, 0, steps).astype(np.int64).reshape(len(paths), -1)


def _columns(paths: Sequence[Integers]) -> tuple[Integers, Integers]:
    """Return the columns of the frames, (m, c), that vary, and the values of the others."""
    first = paths[0][0]
    differs = np.any([(frame != first).any(axis=0) for frame in paths], axis=0)
    return np.flatnonzero(differs), np.where(differs, 0, first)


def _differences(frames: Sequence[Integers]) -> Integers:
    """Return all values minus those of the same row in the frame before, 0 if it had no such row."""
    found = []
    before = np.zeros((0, frames[0].shape[1]), dtype=np.int64)
    for frame in frames:
        change = frame.copy()
        shared = min(len(frame), len(before))
        change[:shared] -= before[:shared]
        found.append(change.ravel())
        before = frame
    return np.concatenate(found)


def _planes(values: Integers) -> bytes:
    """Return all low bytes, then all high bytes, of the values in zigzag order: 0, -1, 1, -2, ..."""
    zigzag = ((values << 1) ^ (values >> 63)).astype(np.uint16)
    return (zigzag & 255).astype(np.uint8).tobytes() + (zigzag >> 8).astype(np.uint8).tobytes()


def _flags(frames: Sequence[Frame], every: int) -> bytes:
    """Return a byte of flags per kept member, frame by frame, then one per frame for its best path."""
    found = []
    for frame, later in zip(frames, [*frames[1:], None], strict=True):
        flags = FEASIBLE * frame.feasible + NEW * frame.new
        if later is not None and len(later.removed) == len(flags):
            flags = flags + REMOVED * later.removed
        found.append(flags[::every].astype(np.uint8))
    best = np.array([FEASIBLE * frame.best_feasible for frame in frames], dtype=np.uint8)
    return np.concatenate([*found, best]).tobytes()
