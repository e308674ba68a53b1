"""The values that the playground is made of, and the requests that it refuses."""

import re

import pytest

from experiments.playground.__main__ import main
from experiments.playground.exported import POLICY, PORTED_OPTIONS, export, is_ported
from experiments.playground.playground_page import ASSETS, SCRIPTS, playground_for, playground_page
from swarm_gym.errors import SettingError, UnknownNameError
from swarm_gym.problem import AnalyticProblem
from swarm_gym.scenarios import make_scenario


def test_obstacles_over_segments_are_the_pairs_of_the_problem():
    for name in ("case1", "case2", "case3"):
        pairs = AnalyticProblem(make_scenario(name)).pairs
        segments = export([name], {})["cases"][0]["segments"]
        expected = [[0] * len(segments) for _ in range(2)]
        for pair in pairs:
            expected[pair.circle is None][pair.segment] += 1
        corners = [[obstacle["corners"] for obstacle in segment] for segment in segments]
        assert [sum(count == 0 for count in segment) for segment in corners] == expected[0]
        assert [sum(count > 0 for count in segment) for segment in corners] == expected[1]


@pytest.mark.parametrize(
    ("scenarios", "options", "policy", "message"),
    [
        ([], {}, POLICY, "playground: expected at least one scenario, got none"),
        (["function:rastrigin-2"], {}, POLICY, "fixed maps of circles and polygons, got scenario 'function"),
        (["rooms:0"], {}, POLICY, "fixed maps of circles and polygons, got scenario 'rooms:0'"),
        (["dynamic:case1-gate@5"], {}, POLICY, "fixed maps of circles and polygons, got scenario"),
        (["case1"], {"source": "smooth"}, POLICY, "expected options out of .*; got source"),
        (["case1"], {}, "fixed:60", "expected a feedforward policy .*; got 'fixed:60'"),
        (["case1"], {}, "learned:three-cases-extended/0", "got 'learned:three-cases-extended/0'"),
    ],
)
def test_what_the_port_lacks_is_refused(scenarios, options, policy, message):
    with pytest.raises(SettingError, match=message):
        export(scenarios, options, policy)


def test_a_scenario_that_does_not_exist_is_an_error():
    with pytest.raises(UnknownNameError, match="case9"):
        playground_page(["case9"])


@pytest.mark.parametrize(
    ("scenario", "ported"),
    [("case1", True), ("random-fields:test:0", True), ("rooms:0", False), ("dynamic:case1-gate@5", False)],
)
def test_fixed_maps_of_circles_and_polygons_are_ported(scenario, ported):
    assert is_ported(scenario, {}) == ported


def test_a_suite_has_a_playground_where_its_runs_can_be_steered():
    mixed = playground_for(["rooms:0", "case2", "case1"], "firefly", {"iterations": 12})
    assert re.findall(r'<option value="\d">([^<]*)<', mixed.section) == ["case2", "case1"]
    assert '"iterations":12' in mixed.section
    assert playground_for(["case1"], "particle-swarm", {}) is None
    assert playground_for(["case1"], "firefly", {"max_evaluations": 1000}) is None
    assert playground_for(["rooms:0"], "firefly", {}) is None


def test_options_that_are_ported_reach_the_page():
    changed = dict.fromkeys(PORTED_OPTIONS, 0.5) | {"iterations": 7, "num_waypoints": 12}
    data = export(["case1"], changed)
    assert data["settings"] == {
        "iterations": 7, "meanWeight": 0.5, "referenceEvaluations": 100_000,
        "noise": 0.5, "attractiveness": 0.5, "absorption": 0.5,
    }  # fmt: skip
    [case] = data["cases"]
    assert (len(case["line"]), case["lengthWeight"]) == (14, 0.5)


def test_the_command_writes_one_small_file(tmp_path, capsys, monkeypatch):
    file = tmp_path / "folder" / "play.html"
    monkeypatch.setattr("sys.argv", ["playground", str(file)])
    main()
    text = file.read_text(encoding="utf-8")
    assert capsys.readouterr().out == f"playground: {file} ({len(text.encode()) / 1e3:.0f} kB)\n"
    assert text == playground_page()
    assert len(text.encode()) < 120_000
    assert not re.search(r"https?://(?!www\.w3\.org)|url\(|@import|<link(?! rel=\"icon\")", text)
    monkeypatch.setattr("sys.argv", ["playground", str(file), "--scenarios", "rooms:0"])
    with pytest.raises(SystemExit, match=r"^error: playground: expected fixed maps"):
        main()
    assert capsys.readouterr().out == ""
    assert file.read_text(encoding="utf-8") == text


def test_every_asset_is_used():
    assets = {path.name for path in ASSETS.iterdir()}
    assert assets == {*SCRIPTS, "playground.css", "section.html.jinja", "page.html.jinja"}
