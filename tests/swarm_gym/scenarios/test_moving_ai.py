import math
import os
import tracemalloc
from collections import Counter
from contextlib import suppress

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from helpers.mutations import fuzzed, mutated
from helpers.public_maps import needed
from helpers.refusals import refused
from swarm_gym.errors import ScenarioError
from swarm_gym.scenarios import expand_name, make_scenario, make_scenarios
from swarm_gym.scenarios.formats.data_files import find_data_file
from swarm_gym.scenarios.formats.moving_ai import MAX_PROBLEMS, read_map, read_scenarios
from swarm_gym.scenarios.papers.moa import TASKS

# Passable cells: column 0, and the right part of the middle row.
MAP = b"type octile\nheight 3\nwidth 4\nmap\n.@OT\nGS..\n.W@.\n"
BLOCKED = [[0, 1, 1, 1], [0, 0, 0, 0], [0, 1, 1, 0]]

PROBLEMS = (
    b"version 1\n"
    b"0\tmaps/small.map\t4\t3\t0\t0\t0\t2\t2\n"
    b"1\tmaps/small.map\t4\t3\t0\t1\t3\t2\t4\n"
    b"1\tmaps/small.map\t4\t3\t3\t2\t0\t0\t5.5\n"
)

INSERTIONS = (b"\n", b"\r\n", b"0", b"9" * 30, b"-1", b"\t", b"nan", b".")


@pytest.fixture
def folder(tmp_path, monkeypatch):
    monkeypatch.setenv("SWARM_GYM_DATA", str(tmp_path))
    return tmp_path


@pytest.fixture
def small(folder):
    """Write the map and its problems into the data folder."""
    (folder / "small.map").write_bytes(MAP)
    (folder / "small.map.scen").write_bytes(PROBLEMS)
    return folder


def written(folder, content, name="small.map"):
    path = folder / name
    path.write_bytes(content)
    return path


# Maps.


@pytest.mark.parametrize(
    "content",
    [
        pytest.param(MAP, id="as it is"),
        pytest.param(MAP.replace(b"\n", b"\r\n"), id="CR LF"),
        pytest.param(MAP[:-1], id="no newline at the end"),
        pytest.param(MAP + b"\n \r\n", id="blank lines at the end"),
        pytest.param(MAP.replace(b"height 3", b"height\t3 "), id="white space in the header"),
    ],
)
def test_a_map_is_read(folder, content):
    made = read_map(written(folder, content))
    assert made.blocked.tolist() == np.array(BLOCKED, bool).tolist()
    assert (made.name, made.resolution, made.origin, made.y_up) == ("small", 1.0, (0.0, 0.0), False)


@pytest.mark.parametrize(
    ("content", "line", "reason"),
    [
        (b"", 1, "'type octile'"),
        (MAP.replace(b"octile", b"tile"), 1, "b'type tile'"[1:]),
        (MAP.replace(b"height 3", b"rows 3"), 2, "height"),
        (MAP.replace(b"height 3", b"height 0"), 2, "height 0"),
        (MAP.replace(b"height 3", b"height -3"), 2, "height -3"),
        (MAP.replace(b"height 3", b"height 3.0"), 2, "height 3.0"),
        (MAP.replace(b"width 4", b"width 4097"), 3, "4097"),
        (MAP.replace(b"width 4", b"width 99999999999"), 3, "99999999999"),
        (MAP.replace(b"map\n", b"", 1), 4, "'map'"),
        (MAP[:33], 5, "expected 3 rows, but the file ends after 0"),
        (MAP[:43], 7, "expected 3 rows, but the file ends after 2"),
        (MAP[:-2], 7, "row of 4 cells, got 3"),
        (MAP.replace(b".@OT", b".@O"), 5, "row of 4 cells, got 3"),
        (MAP.replace(b"GS..", b"GS..."), 6, "row of 4 cells, got more"),
        (MAP.replace(b"GS..", b"GS.." + b"." * 99), 6, "row of 4 cells, got more"),
        (MAP + b"....\n", 8, "to end after 3 rows, but it goes on"),
        (MAP + b"\n" * 1000, 8, "to end after 3 rows, but it goes on"),
        (MAP.replace(b"W", b"w"), 7, "column 2, got b'w'"),
        (MAP.replace(b"W", b"\xff"), 7, r"column 2, got b'\xff'"),
        (MAP.replace(b"W", b"\0"), 7, r"column 2, got b'\x00'"),
        (MAP.replace(b"\n", b"\r"), 1, "type octile"),
    ],
)
def test_a_malformed_map_is_refused_with_file_line_and_reason(folder, content, line, reason):
    path = written(folder, content)
    refused(lambda: read_map(path), f"{path}, line {line}:", reason)


def test_a_map_that_announces_more_than_it_has_is_not_given_memory(folder):
    path = written(folder, MAP.replace(b"height 3", b"height 4096").replace(b"width 4", b"width 4096"))
    tracemalloc.start()
    refused(lambda: read_map(path), "line 5")
    peak = tracemalloc.get_traced_memory()[1]
    tracemalloc.stop()
    assert peak < 2**20


@pytest.mark.parametrize("read", [read_map, read_scenarios])
def test_what_is_no_file_is_refused(folder, read):
    refused(lambda: read(folder / "none"), "none", "no such file")
    refused(lambda: read(folder), str(folder), "not a regular file")
    if hasattr(os, "mkfifo"):  # Windows has no named pipes in folders
        os.mkfifo(folder / "pipe")
        refused(lambda: read(folder / "pipe"), "pipe", "not a regular file")


@given(content=mutated(MAP, *INSERTIONS) | st.binary(max_size=60))
@fuzzed
def test_a_map_of_any_bytes_is_read_or_refused(folder, content):
    made = None
    with suppress(ScenarioError):
        made = read_map(written(folder, content))
    assert made is None or made.blocked.size <= len(content)


# Problems.


@pytest.mark.parametrize(
    "content",
    [
        pytest.param(PROBLEMS, id="as it is"),
        pytest.param(PROBLEMS.replace(b"\n", b"\r\n"), id="CR LF"),
        pytest.param(PROBLEMS.replace(b"version 1", b"version 1.0"), id="version 1.0"),
        pytest.param(PROBLEMS.replace(b"\t", b" "), id="spaces"),
        pytest.param(PROBLEMS.replace(b"\n", b"\n\n"), id="blank lines"),
        pytest.param(PROBLEMS[:-1], id="no newline at the end"),
    ],
)
def test_problems_are_read(folder, content):
    found = read_scenarios(written(folder, content, "small.scen"))
    assert len(found) == 3
    assert found[2] == (1, "maps/small.map", 4, 3, (3, 2), (0, 0), 5.5)


def test_a_name_of_a_map_may_have_spaces_between_tabs(folder):
    content = PROBLEMS.replace(b"maps/small", b"my maps/small")
    assert read_scenarios(written(folder, content))[0].map == "my maps/small.map"


@pytest.mark.parametrize(
    ("content", "line", "reason"),
    [
        (b"", 1, "version 1"),
        (PROBLEMS.replace(b"version 1", b"version 2"), 1, "version 2"),
        (PROBLEMS.replace(b"\t4\n", b"\n"), 3, "9 fields, got 8"),
        (PROBLEMS.replace(b"\t4\n", b"\t4\t4\n"), 3, "9 fields, got 10"),
        (PROBLEMS.replace(b"\t5.5", b"\tnan"), 4, "length, got 'nan'"),
        (PROBLEMS.replace(b"\t5.5", b"\t-5"), 4, "length, got '-5'"),
        (PROBLEMS.replace(b"\t3\t2\t4", b"\t3\t2.0\t4"), 3, "integer, got '2.0'"),
        (PROBLEMS.replace(b"\t3\t2\t4", b"\t-3\t2\t4"), 3, "integer, got '-3'"),
        (PROBLEMS.replace(b"\t3\t2\t4", b"\t3\t3\t4"), 3, "expected a cell on the map of 4 x 3, got (3, 3)"),
        (PROBLEMS.replace(b"\t4\t3\t3\t2", b"\t0\t3\t3\t2"), 4, "0 x 3"),
        (PROBLEMS.replace(b"\t4\t3\t3\t2", b"\t4\t5000\t3\t2"), 4, "4 x 5000"),
        (PROBLEMS.replace(b"maps/small", b"maps/sm\xe4ll", 1), 2, "ASCII"),
    ],
)
def test_a_malformed_problem_is_refused_with_file_line_and_reason(folder, content, line, reason):
    path = written(folder, content, "small.scen")
    refused(lambda: read_scenarios(path), f"{path}, line {line}:", reason)


def test_a_file_without_problems_is_refused(folder):
    path = written(folder, b"version 1\n\n", "small.scen")
    refused(lambda: read_scenarios(path), str(path), "expected at least one problem")


@given(content=mutated(PROBLEMS, *INSERTIONS) | st.binary(max_size=60))
@fuzzed
def test_problems_of_any_bytes_are_read_or_refused(folder, content):
    found = []
    with suppress(ScenarioError):
        found = read_scenarios(written(folder, content, "small.scen"))
    assert all(math.isfinite(problem.length) for problem in found)


# Names.


def test_a_problem_is_found_by_its_number(small):
    made = make_scenario("moving-ai:small#1")
    assert made.name == "moving-ai:small#1"
    assert (made.start, made.target) == ((0.0, 1.0), (3.0, 2.0))
    assert made.map == read_map(small / "small.map")


def test_a_range_stands_for_all_its_problems_on_one_map(small):
    made = make_scenarios("moving-ai:small#0-2")
    assert [scenario.name for scenario in made] == [f"moving-ai:small#{number}" for number in range(3)]
    assert all(scenario.map is made[0].map for scenario in made)


def test_start_and_goal_may_be_given_as_cells(small):
    name = "moving-ai:small?start=3,1&goal=0,2"
    made = make_scenario(name)
    assert (made.name, made.start, made.target) == (name, (3.0, 1.0), (0.0, 2.0))
    assert expand_name(name) == (name,)


def test_a_map_may_be_given_by_its_absolute_path(small, monkeypatch, tmp_path):
    monkeypatch.setenv("SWARM_GYM_DATA", str(tmp_path / "elsewhere"))
    assert make_scenario(f"moving-ai:{small}/small.map#1").start == (0.0, 1.0)
    assert make_scenario(f"moving-ai:{small}/small.map?start=3,1&goal=0,2").start == (3.0, 1.0)


@pytest.mark.parametrize(
    "name", ["moving-ai:small.map#1", " moving-ai: small #1 ", "moving-ai:small.map # 1"]
)
def test_a_problem_has_one_name_however_it_is_written(small, name):
    assert expand_name(name) == ("moving-ai:small#1",)
    assert make_scenario(name).name == "moving-ai:small#1"


def test_cells_may_have_spaces_between_them(small):
    name = "moving-ai:small.map ? start = 3, 1 & goal = 0, 2"
    assert make_scenario(name).name == "moving-ai:small?start=3,1&goal=0,2"


def test_spaces_inside_the_path_of_a_map_stay(small):
    for file in ("small.map", "small.map.scen"):
        (small / file).rename(small / file.replace("small", "floor 2, b # c"))
    assert make_scenario("moving-ai: floor 2, b # c.map # 1").name == "moving-ai:floor 2, b # c#1"
    name = "moving-ai: floor 2, b # c.map ? start = 3, 1 & goal = 0, 2"
    assert make_scenario(name).name == "moving-ai:floor 2, b # c?start=3,1&goal=0,2"


def test_problems_of_a_range_in_blocked_cells_are_left_out_with_one_warning(small):
    blocked = b"2\tmaps/small.map\t4\t3\t1\t0\t0\t0\t9\n" + b"2\tmaps/small.map\t4\t3\t0\t0\t2\t2\t9\n"
    written(small, PROBLEMS + blocked, "small.map.scen")
    with pytest.warns(UserWarning, match="left out") as caught:
        made = make_scenarios("moving-ai:small#0-4")
    assert [scenario.name for scenario in made] == [f"moving-ai:small#{number}" for number in range(3)]
    assert len(caught) == 1
    assert "2 of 5 problems begin or end in a blocked cell" in str(caught[0].message)
    refused(lambda: make_scenario("moving-ai:small#3"), "line 5", "not free")
    refused(lambda: expand_name("moving-ai:small#3-4"), "blocked cell")


def test_problems_may_be_in_a_file_without_map_in_its_name(small):
    (small / "small.map.scen").rename(small / "small.scen")
    assert make_scenario("moving-ai:small#1").start == (0.0, 1.0)


def test_a_map_that_changed_is_read_again(small):
    before = make_scenario("moving-ai:small#0")
    written(small, MAP.replace(b"W@.", b"..."))
    assert make_scenario("moving-ai:small#0").map != before.map


NO_NUMBERS = ("", "#", "#-1", "#01", "#2-1", "#1.0", f"#{MAX_PROBLEMS}", f"#0-{MAX_PROBLEMS}")
NO_CELLS = ("start=0,0", "start=0,0&goal=0.5,1", "start=0,0&goal=-1,1", "goal=0,1&start=0,0")
NO_NAMES = [
    *("moving-ai", "moving-ai:", "moving-ai:#0", "moving-ai:/small#0"),
    *(f"moving-ai:small{end}" for end in NO_NUMBERS),
    *(f"moving-ai:small?{cells}" for cells in NO_CELLS),
]


@pytest.mark.parametrize("name", NO_NAMES)
def test_a_name_of_another_form_is_refused(small, name):
    refused(lambda: expand_name(name), repr(name), "expected" if "/" not in name else ".map")


def test_a_missing_file_or_problem_is_reported_with_what_there_is(small):
    refused(lambda: make_scenario("moving-ai:other#0"), "other.map")
    refused(lambda: make_scenario("moving-ai:small#3"), "moving-ai:small#3", "0 to 2")
    (small / "small.map.scen").unlink()
    refused(lambda: make_scenario("moving-ai:small#0"), "small.map.scen or small.scen")


@pytest.mark.parametrize(
    ("instead", "words"),
    [
        (b"\t5\t3\t0\t1\t3\t2", ["5 x 3", "4 x 3"]),  # the size of another map
        (b"\t4\t3\t1\t0\t3\t2", ["cell (1, 0)", "not free"]),  # in a wall
    ],
)
def test_a_problem_that_does_not_fit_its_map_is_refused_with_its_line(small, instead, words):
    path = written(small, PROBLEMS.replace(b"\t4\t3\t0\t1\t3\t2", instead), "small.map.scen")
    refused(lambda: make_scenario("moving-ai:small#1"), f"{path}, line 3:", *words)


# Maps of the benchmark, if they have been downloaded.


@pytest.fixture
def den400d():
    return needed("den400d.map")


def test_den400d_is_the_map_of_the_paper(den400d):
    made = read_map(den400d)
    assert (made.width, made.height) == (259, 268)
    assert Counter(made.components.ravel().tolist()) == {1: 30182, 0: 259 * 268 - 30182}


def test_all_problems_of_den400d_have_a_path(den400d):
    made = make_scenarios("moving-ai:den400d#0-799")
    listed = read_scenarios(find_data_file("den400d.map.scen"))
    assert len(made) == len(listed) == 800
    assert all(
        scenario.straight_line < problem.length + 1e-3 for scenario, problem in zip(made, listed, strict=True)
    )


def test_the_tasks_of_the_moa_paper_are_problems_of_the_benchmark(den400d):
    problems = {(p.start, p.goal): p.length for p in read_scenarios(find_data_file("den400d.map.scen"))}
    lengths = [problems[ends] for ends in TASKS.values()]
    assert lengths == [160.782, 141.799, 223.593, 203.811, 283.463, 253.836]
    assert [made.name for made in make_scenarios("den400d:P1-P6")] == [f"den400d:{task}" for task in TASKS]
    assert make_scenario("den400d:P5").start == (11.0, 189.0)


@pytest.mark.parametrize(
    "name", ["den400d", "den400d:", "den400d:P0", "den400d:P7", "den400d:P2-P1", "den400d:1"]
)
def test_a_task_that_there_is_not_is_refused(name):
    refused(lambda: make_scenario(name), repr(name), "P1-P6")


def test_the_tasks_are_refused_on_another_map_of_the_name(small):
    (small / "small.map").rename(small / "den400d.map")
    refused(lambda: make_scenario("den400d:P1"), "den400d:P1", "is not the map den400d")
