"""Reports: numbers as in the database, replays as the runs were, and what is missing or mixed is said."""

import base64
import dataclasses
import html
import json
import re
import sqlite3
import zlib
from contextlib import closing
from html.parser import HTMLParser

import numpy as np
import pytest

from experiments.catalogue import SUITES
from experiments.documents.suite_page import make_tables
from experiments.report.__main__ import ReportConfig, write_report
from experiments.report.completeness import complete_part
from experiments.report.map_picture import describe_map, extent_of
from experiments.report.recording import Recording, record
from experiments.report.replay import LADDER, MOST_BYTES, NEW, REMOVED, pack
from experiments.runs.database import Results, ResultsError
from experiments.runs.episode import Episode
from experiments.tables.cell import plain_text
from helpers.reports import SUITE
from helpers.stored_runs import make_database
from swarm_gym.errors import UnknownNameError
from swarm_gym.scenarios import make_scenario, world_at

MADE_WITH = {"commit": "c" * 40, "numba": "1"}


@pytest.fixture(scope="module")
def stored(tmp_path_factory):
    return make_database(tmp_path_factory.mktemp("results") / "tiny.sqlite", SUITE)


@pytest.fixture
def database(stored, tmp_path, monkeypatch):
    """A copy that may be changed, of a suite that is known by name."""
    monkeypatch.setitem(SUITES, "tiny", SUITE)
    copy = tmp_path / "tiny.sqlite"
    copy.write_bytes(stored.read_bytes())
    return copy


class Page(HTMLParser):
    """The tables of a page by name, and its text."""

    def __init__(self, text):
        super().__init__()
        self.tables, self.attributes, self.text = {}, [], ""
        self._cells = None
        self.feed(text)

    def handle_starttag(self, tag, attrs):
        self.attributes += [(tag, *attr) for attr in attrs]
        if tag == "table":
            self.rows = self.tables[dict(attrs)["data-name"]] = []
        elif tag == "tr":
            self._cells = []
            self.rows.append(self._cells)
        elif tag in ("td", "th") and self._cells is not None:
            self._cells.append("")

    def handle_endtag(self, tag):
        if tag == "tr":
            self._cells = None

    def handle_data(self, data):
        self.text += data
        if self._cells:
            self._cells[-1] += data


def page_of(database, replays=(), figures=False, **options):
    path = write_report(ReportConfig(database, replays=replays, figures=figures, **options))
    return Page(path.read_text())


@pytest.fixture(scope="module")
def whole_page(stored):
    """The page with all figures and replays."""
    with pytest.MonkeyPatch.context() as patch:
        patch.setitem(SUITES, "tiny", SUITE)
        return page_of(stored, replays=None, figures=True)


def change(database, command):
    """Carry out a command of SQL and return its rows."""
    with closing(sqlite3.connect(database)) as connection, connection:
        return connection.execute(command).fetchall()


def test_the_page_lies_beside_the_suites_tables(database, tmp_path):
    asked = ReportConfig(database, replays=(), figures=False)
    assert write_report(asked) == tmp_path / "tiny" / "report.html"
    other = tmp_path / "elsewhere" / "page.html"
    assert write_report(dataclasses.replace(asked, output=other)) == other
    assert sorted(path.name for path in other.parent.iterdir()) == ["page.html"]


def test_every_number_of_the_tables_is_that_of_the_database(database):
    page = page_of(database)
    with closing(Results.stored(database)) as results:
        for table in make_tables(SUITE, results):
            shown = page.tables[table.name]
            assert shown[0] == list(table.columns)
            assert shown[1:] == [list(map(plain_text, row)) for row in table.rows]
    runs = change(
        database, "SELECT scenario, seed, final_fitness, final_collision, evaluations, seconds FROM runs"
    )
    shown = [(scenario, int(k), float(f), float(c), int(e), float(s))
             for _, scenario, k, f, c, e, s in page.tables["runs"][1:]]  # fmt: skip
    assert sorted(shown) == sorted(runs)
    means = {row[0]: row[1] for row in page.tables["summary"][1:]}
    fitness = [f for scenario, _, f, *_ in runs if scenario == "case1"]
    assert len(fitness) == 9
    fixed = "controller = 'fixed:8' AND scenario = 'case1'"
    [(mean,)] = change(database, f"SELECT AVG(final_fitness) FROM runs WHERE {fixed}")
    assert means["FA-8"].startswith(f"{mean:.1f} (")


def test_a_page_has_all_kinds_of_figures_with_titles_of_their_own(whole_page):
    for caption in ("Convergence on case1", "Population size on case1", "Best path on case1", "Final fitness",
                    "Mean E(P)", "Performance profiles", "Quality against cost"):  # fmt: skip
        assert caption in whole_page.text
    identifiers = [value for _, name, value in whole_page.attributes if name == "id"]
    assert len(identifiers) == len(set(identifiers))
    for _, name, value in whole_page.attributes:
        if name in ("aria-labelledby", "href", "xlink:href") and value.startswith("#"):
            assert value[1:] in identifiers
    assert whole_page.text.count("Convergence on case1") == 2  # for those who see the figure, and for others


def test_a_page_refers_to_nothing_outside_itself(whole_page):
    links = [v for _, name, v in whole_page.attributes if name in ("src", "href", "xlink:href", "action")]
    assert links
    assert all(link.startswith(("#", "data:")) for link in links)
    assert not re.search(r"url\((?!#)", whole_page.text)
    assert "@import" not in whole_page.text


def test_a_page_says_what_was_run_and_how_to_run_it_again(database):
    page = page_of(database)
    assert "python -m experiments.evaluate --suite tiny --seeds 3" in page.text
    assert "python -m experiments.report tiny.sqlite" in page.text
    for part in ("spsfa-tip", "random-fields:test:0", "0 to 2", "iterations=12", "numba", "commit"):
        assert part in page.text
    with closing(Results.stored(database)) as results:
        stored = json.loads(re.search(r"\{\n \"controller fixed:8\".*?\n\}", page.text, re.DOTALL)[0])
        assert stored == results.configuration()


def test_the_same_database_gives_the_same_page_and_stays_as_it_is(database):
    before = database.read_bytes()
    pages = [write_report(ReportConfig(database, figures=False)).read_bytes() for _ in range(2)]
    assert pages[0] == pages[1]
    assert database.read_bytes() == before


# The complete seeds of a stopped suite are shown. A controller that was only begun does not cost the others
# their seeds, and a scenario that some controllers lack is left out.
@pytest.mark.parametrize(
    ("missing", "shown", "said"),
    [
        ("TRUE", 0, ["The database holds no runs yet."]),
        (
            "seed > 0",
            0,
            ["too few to compare: at most 1 seeds of a controller on a scenario, 3 are asked for"],
        ),
        (
            "seed = 2 AND controller = 'spsfa' AND scenario = 'case1'",
            12,
            [
                "This database is partial: the report is about 12 of its 17 runs.",
                "Every controller has 2 seeds on every scenario; some have 3.",
                "2 seeds each",
            ],
        ),
        (
            "seed > 0 AND controller = 'spsfa'",
            12,
            ["Controllers left out because runs are missing: SPSFA.", "3 seeds each"],
        ),
        (
            "controller = 'spsfa' AND scenario = 'random-fields:test:0'",
            9,
            ["Scenarios left out because runs are missing: random-fields:test:0."],
        ),
    ],
    ids=[
        "all",
        "all but one seed",
        "a run",
        "of a controller all but one seed",
        "a scenario of a controller",
    ],
)
def test_a_page_says_which_runs_are_missing_and_shows_the_others(database, missing, shown, said):
    change(database, f"DELETE FROM runs WHERE {missing}")
    page = page_of(database)
    assert [text for text in said if text not in page.text] == []
    assert (len(page.tables["runs"]) == 1 + shown) if shown else (page.tables == {})


def test_where_each_scenario_has_its_own_seeds_the_first_scenarios_are_kept(stored):
    scenarios = ("case1", "case2", "random-fields:test:0")
    suite = dataclasses.replace(SUITE, scenarios=scenarios, seed_step=1, num_seeds=1)
    with closing(Results.stored(stored)) as results:
        part, _ = complete_part(suite, results)
    assert part.scenarios == ("case1",)
    assert part.seeds["case1"].start == 0


def test_runs_of_several_versions_are_told_apart(database):
    change(database, f"UPDATE runs SET provenance = '{json.dumps(MADE_WITH)}' WHERE seed = 1")
    page = page_of(database)
    assert "The runs are of 2 versions, so they may not be comparable." in page.text
    assert "commits " in page.text
    assert "cccccccccc" in page.text
    assert "git checkout" not in page.text


@pytest.mark.parametrize(
    ("changes", "controller", "why"),
    [
        (["runs SET trace = zeroblob(length(trace))"], "spsfa", "spsfa on case1, seed 0"),
        (
            [f"{table} SET controller = 'learned:gone'" for table in ("runs", "snapshots")],
            "learned:gone",
            "learned:gone on case1: policy 'gone': neither",
        ),
    ],
    ids=["another trace", "no policy"],
)
def test_a_run_that_cannot_be_repeated_is_not_replayed(database, changes, controller, why):
    for each in changes:
        change(database, f"UPDATE {each} WHERE controller = 'spsfa'")
    page = page_of(database, replays=(f"{controller},case1,0", "fixed:8,case1,0"))
    assert f"A replay is left out, since the run cannot be repeated: {why}" in page.text
    [group] = replays_of(page)
    assert [replay["controller"] for replay in group["replays"]] == ["fixed:8"]


@pytest.mark.parametrize(
    ("spoil", "message"),
    [
        (lambda path: path.unlink(), "there is no such results database"),
        (lambda path: path.write_text("nothing of the kind" * 99), "not a usable results database"),
        (lambda path: path.write_bytes(b""), "no table of runs"),
        (
            lambda path: change(path, "ALTER TABLE runs DROP COLUMN way"),
            r"columns controller, .*columns, expected .*columns, way",
        ),
        (lambda path: change(path, "UPDATE configuration SET value = '1'"), "another configuration: "),
    ],
)
def test_a_file_that_cannot_be_used_is_an_error_that_names_it(database, spoil, message):
    spoil(database)
    with pytest.raises(ResultsError, match=rf"tiny\.sqlite.*{message}"):
        write_report(ReportConfig(database))
    assert not (database.parent / "tiny").exists()


def test_the_suite_is_that_of_the_files_name_or_one_that_is_given(database, tmp_path):
    other = database.rename(tmp_path / "other.sqlite")
    with pytest.raises(UnknownNameError, match="suite 'other'"):
        write_report(ReportConfig(other))
    assert write_report(ReportConfig(other, suite="tiny", replays=(), figures=False)).exists()


NO_RUNS = ("spsfa", "spsfa,case1", "spsfa,case1,first", "spsfa,case1,-1", "case1,0")


@pytest.mark.parametrize(
    ("text", "message"),
    [*((text, f"CONTROLLER,SCENARIO,SEED.*{text}") for text in NO_RUNS),
     ("spsfa,case1,99", r"no run of spsfa on case1 with seed 99 .*its seeds there are 0 to [0-9]+$"),
     ("fixed:9,case1,0", "no run of fixed:9 .*it has runs of fixed:8, "),
     ("spsfa,case9,0", "on case9 .*it has runs on case1")],
)  # fmt: skip
def test_what_is_no_run_to_replay_is_refused(database, text, message):
    with pytest.raises(ResultsError, match=message):
        write_report(ReportConfig(database, replays=(text,)))


def replays_of(page):
    return json.loads(re.search(r"\[\{\"scenario\".*\]", page.text)[0])


def test_the_runs_asked_for_are_replayed_by_scenario_and_seed(database):
    asked = ("spsfa,case1,2", "fixed:8,case1,2", "fixed:8,random-fields:test:0,1")
    groups = replays_of(page_of(database, replays=asked))
    found = [(g["scenario"], g["seed"], [r["controller"] for r in g["replays"]]) for g in groups]
    assert found == [("case1", 2, ["spsfa", "fixed:8"]), ("random-fields:test:0", 1, ["fixed:8"])]


def test_by_default_the_suites_controllers_are_replayed_on_their_first_seeds(database):
    groups = replays_of(page_of(database, replays=None))
    assert [(g["scenario"], g["seed"]) for g in groups] == [(name, 0) for name in SUITE.scenarios]
    assert [r["controller"] for r in groups[0]["replays"]] == list(SUITE.replayed)


def unpack(packed):
    """Members (frames of (m, k, 2)), best paths and flags of a replay, by plain loops over its bytes."""
    data = zlib.decompress(base64.b64decode(packed["data"]))
    place = 0

    def read(rows_of_frames, width):
        nonlocal place
        count = sum(rows * width for rows in rows_of_frames)
        low, high = data[place : place + count], data[place + count : place + 2 * count]
        place += 2 * count
        frames, at, before = [], 0, []
        for rows in rows_of_frames:
            values = []
            for k in range(rows * width):
                zigzag = low[at] + 256 * high[at]
                difference = zigzag // 2 if zigzag % 2 == 0 else -(zigzag + 1) // 2
                values.append(difference + (before[k] if k < len(before) else 0))
                at += 1
            frames.append(np.array(values).reshape(rows, width))
            before = values
        return frames

    moved = read(packed["sizes"], len(packed["varying"]))
    best = read([1] * len(packed["sizes"]), packed["bestWidth"])
    flags = []
    for size in packed["sizes"]:
        flags.append(list(data[place : place + size]))
        place += size
    assert len(data) == place + len(packed["sizes"])
    members = []
    for frame in moved:
        whole = np.tile(packed["fixed"], (len(frame), 1))
        whole[:, packed["varying"]] = frame
        members.append(whole.reshape(len(frame), -1, 2))
    return members, [path.reshape(-1, 2) for path in best], flags


def recording_of(controller="spsfa-tip", scenario="case1", seed=0, **changes):
    suite = dataclasses.replace(SUITE, scenarios=(scenario,), **changes)
    return record(Episode((controller, scenario, seed), suite).run({}), suite)


def test_a_replay_shows_every_population_as_it_was():
    recording = recording_of("spsfa")
    packed = pack(recording)
    members, best, flags = unpack(packed)
    grid = 2 ** packed["bits"] - 1
    for frame, shown, path, marks in zip(recording.frames, members, best, flags, strict=True):
        low, high = np.reshape(extent_of(frame.scenario), (2, 2))
        unit = (high - low) / grid
        for these, those in ((shown, frame.paths), (path, frame.best_path)):
            seen = np.clip(those, low, high)  # the rest is cut off
            np.testing.assert_array_less(np.abs(low + these * unit - seen) / unit, 0.5001)
        np.testing.assert_array_equal(np.bitwise_and(marks, 1) == 1, frame.feasible)
        np.testing.assert_array_equal(np.bitwise_and(marks, NEW) == NEW, frame.new)
    assert packed["frames"] == list(range(13))
    assert packed["members"] == packed["sizes"] == [len(frame.paths) for frame in recording.frames]
    assert packed["courses"]["population_size"] == recording.run.course("population_size").tolist()


def test_new_and_removed_members_are_those_that_make_the_size():
    recording = recording_of("spsfa")
    _, _, flags = unpack(pack(recording))
    sizes = [len(frame.paths) for frame in recording.frames]
    assert max(np.diff(sizes)) > 0 > min(np.diff(sizes))
    for frame, before, size, later in zip(recording.frames[1:], flags, sizes, sizes[1:], strict=False):
        assert frame.new.sum() == max(later - size, 0)
        assert frame.removed.sum() == max(size - later, 0)
        np.testing.assert_array_equal(np.bitwise_and(before, REMOVED) == REMOVED, frame.removed)
        if frame.removed.any() and not frame.removed.all():
            at = recording.frames.index(frame)
            feasible = recording.frames[at - 1].feasible
            assert feasible[~frame.removed].mean() >= feasible[frame.removed].mean()


def test_members_that_stay_are_followed_through_a_shrinking_population():
    """With no moves at all (no attraction, no noise), whoever stays is where it was."""
    still = {"iterations": 4, "noise": 0.0, "attractiveness": 0.0}
    recording = recording_of("linear-reduction", options=still)
    shrunk = 0
    for before, after in zip(recording.frames, recording.frames[1:], strict=False):
        shrunk += after.removed.sum()
        np.testing.assert_array_equal(before.paths[~after.removed], after.paths[: (~after.removed).sum()])
    assert shrunk > 0


@pytest.mark.slow
@pytest.mark.parametrize(("members", "points"), [(400, 400), (5000, 2)])
def test_a_replay_never_takes_more_than_its_share_of_the_page(members, points):
    rng = np.random.default_rng(1)
    recording = recording_of("fixed:8")
    frames = [
        dataclasses.replace(
            frame,
            paths=rng.uniform(0, 600, (members, points, 2)),
            feasible=rng.random(members) < 0.5,
            new=np.zeros(members, bool),
            removed=np.zeros(members, bool),
        )
        for frame in recording.frames
        for _ in range(2)
    ]
    packed = pack(dataclasses.replace(recording, frames=frames))
    assert len(json.dumps(packed)) <= MOST_BYTES
    assert packed["every"] > 1
    assert packed["members"] == [members] * len(frames)
    [most] = {fineness.points for fineness in LADDER if fineness.every == packed["every"]}
    assert unpack(packed)[0][0].shape[:2] == (-(-members // packed["every"]), min(points, most))


@pytest.mark.slow
@pytest.mark.parametrize(
    ("controller", "scenario", "options"),
    [
        ("particle-swarm+fixed:9", "rooms:0", {"encoding": "bezier"}),
        ("multivariate+fixed:9", "random-fields:test:1", {}),
        ("glowworm+fixed:9", "block:50", {}),
        ("ant-colony+fixed:9", "caves:0", {}),
        ("fish-swarm+fixed:9", "function:booth-2", {}),
        ("spsfa-tip", "dynamic:case1-gate@5", {}),
    ],
)
def test_runs_on_every_kind_of_map_can_be_replayed(controller, scenario, options):
    recording = recording_of(controller, scenario, options={"iterations": 10, **options})
    members, _, _ = unpack(pack(recording))
    assert [len(frame) for frame in members] == [len(frame.paths) for frame in recording.frames]
    for frame in recording.frames:
        json.dumps(describe_map(frame.scenario), allow_nan=False)
    changed = [
        frame.iteration for frame in recording.frames if frame.scenario != recording.frames[0].scenario
    ]
    assert changed == (list(range(5, 11)) if "dynamic" in scenario else [])
    worlds = make_scenario(scenario)
    assert all(world_at(worlds, frame.iteration) == frame.scenario for frame in recording.frames)


def test_the_page_escapes_what_names_could_smuggle_in(stored, tmp_path, monkeypatch):
    name = "tiny</script><b>"
    monkeypatch.setitem(SUITES, name, dataclasses.replace(SUITE, name=name))
    output = tmp_path / "page.html"
    asked = ReportConfig(stored, suite=name, output=output, replays=("spsfa,case1,0",), figures=False)
    text = write_report(asked).read_text()
    assert name not in text
    assert html.escape(name) in text


def test_a_recording_of_one_frame_can_be_packed():
    recording = recording_of("fixed:8")
    members, _, _ = unpack(pack(Recording(recording.run, recording.frames[:1], are_points=False)))
    assert len(members) == 1


@pytest.mark.slow
def test_where_an_optimum_is_not_known_nothing_is_said_of_gaps(database, monkeypatch):
    assert {"gaps", "front"} <= page_of(database).tables.keys()
    monkeypatch.setattr(
        "experiments.runs.outcomes.optima_of", lambda scenarios, _: np.full(len(scenarios), np.nan)
    )
    page = page_of(database, figures=True)
    assert page.tables.keys().isdisjoint({"gaps", "front"})
    assert "Tables and figures of optimality gaps are left out: gaps need the optimum" in page.text
    assert "Convergence on case1" in page.text
    assert "Performance profiles" not in page.text
