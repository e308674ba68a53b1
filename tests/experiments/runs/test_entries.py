"""Results that grow: a controller that has changed is a new entry, and entries can be listed and moved."""

import dataclasses
from contextlib import closing

import numpy as np
import pytest

from agents import make_controller
from experiments.entries import CarryOver, Drop, List, Merge, Rename, carry_out, main
from experiments.evaluate import EvaluateConfig, evaluate
from experiments.runs.configuration import identity
from experiments.runs.database import Results, ResultsError
from experiments.runs.entries import FROM_CONTENT, IDENTITIES, EntryError, entries_of, is_aside
from helpers.stored_runs import stored_run

NAME = "learned:mine.safetensors"


def filled(path, weights, names=(NAME, "fixed:60"), seeds=3, settings=7):
    """Return an open database with runs of some controllers, one of which has these weights."""
    configuration = {"settings": settings, **{f"controller {name}": name for name in names}}
    results = Results(path, {**configuration, f"controller {NAME}": weights})
    runs = [
        stored_run((name, "case1", seed), {}, final_fitness=len(weights) + seed)
        for name in names
        for seed in range(seeds)
    ]
    results.add(*runs)
    return results


def names_of(path):
    with closing(Results.stored(path)) as results:
        return {entry.name: entry.num_runs for entry in entries_of(results.connection)}


def test_runs_of_a_controller_that_has_changed_are_kept_aside(tmp_path):
    path = tmp_path / "a.sqlite"
    filled(path, "first").close()
    with closing(filled(path, "first", seeds=4)) as same:
        assert same.changed == []
        before = [run.final_fitness for run in same.runs(NAME, "case1", 4)]
    with closing(filled(path, "second", seeds=2)) as changed:
        (notice,) = changed.changed
        assert notice.count("\n") == 1
        assert len(notice) < 400
        assert "its 4 runs are kept as" in notice
        (kept,) = [name for name in names_of(path) if is_aside(name)]
        assert notice.endswith(f"{kept}, and new ones are made")
        assert [run.final_fitness for run in changed.runs(kept, "case1", 4)] == before
        assert len(changed.runs(NAME, "case1", 4)) == 2
    # Changed back: what was kept aside is used again; runs between are kept.
    for seeds, expected in ((1, [2, 4, 4]), (5, [2, 5, 5])):
        with closing(filled(path, "first", seeds=seeds)) as back:
            assert len(back.changed) == (seeds == 1)
            assert all("its 4 runs of before are used again" in notice for notice in back.changed)
            assert [run.final_fitness for run in back.runs(NAME, "case1", 4)] == before
        assert sorted(names_of(path).values()) == expected
    # Runs of both versions stay, whichever comes back how often.
    for version in ("second", "first", "second"):
        with closing(filled(path, version, seeds=3)) as changed:
            assert len(changed.changed) == 1
    assert sorted(names_of(path).values()) == [3, 5, 5]


def test_runs_that_were_kept_aside_come_back_after_a_version_without_runs(tmp_path):
    path = tmp_path / "a.sqlite"
    filled(path, "first", seeds=4).close()
    for version, seeds in (("second", 2), ("third", 0), ("first", 1)):
        with closing(filled(path, version, seeds=seeds)) as results:
            pass
    assert len(names_of(path)) == 3
    with closing(Results.stored(path)) as results:
        assert len(results.runs(NAME, "case1", 4)) == 4


def test_runs_of_a_controller_that_another_process_has_changed_are_refused(tmp_path):
    path = tmp_path / "a.sqlite"
    with closing(filled(path, "first", seeds=1)) as slow:
        filled(path, "second", seeds=1).close()
        before = names_of(path)
        with pytest.raises(ResultsError, match=f"{NAME} has changed meanwhile.*run the command again"):
            slow.add(*(dataclasses.replace(run, seed=7) for run in slow.runs(NAME, "case1", 1)))
    assert names_of(path) == before


def read_all(path):
    """Read all runs of a database."""
    with closing(Results.stored(path)) as results:
        return results.finished(), results.runs(NAME, "case1", 40)


def test_a_damaged_database_is_named_in_a_line(tmp_path):
    path = tmp_path / "a.sqlite"
    with closing(filled(path, "first", seeds=40)) as results:
        results.connection.execute("PRAGMA wal_checkpoint(TRUNCATE)")
    whole = bytearray(path.read_bytes())
    whole[8192 : len(whole) - 4096] = bytes(len(whole) - 12288)
    path.write_bytes(whole)
    with pytest.raises(ResultsError, match=r"a\.sqlite: (cannot be read|not a usable results database)"):
        read_all(path)


def test_a_run_without_a_number_is_refused(tmp_path):
    with closing(filled(tmp_path / "a.sqlite", "first", seeds=1)) as results:
        [run] = results.runs(NAME, "case1", 1)
        with pytest.raises(ResultsError, match="final_fitness"):
            results.add(dataclasses.replace(run, seed=3, final_fitness=float("nan")))


def test_other_settings_are_refused_in_few_words_and_change_nothing(tmp_path):
    path = tmp_path / "a.sqlite"
    many = list(range(20_000))
    filled(path, "first", settings=many).close()
    before = names_of(path)
    with pytest.raises(ResultsError, match="another configuration: settings was") as error:
        filled(path, "second", settings=[*many[:-1], -5])
    assert "-5]" in str(error.value)
    assert "19999]" in str(error.value)
    assert len(str(error.value)) < 1_500
    assert names_of(path) == before


def test_entries_are_listed_renamed_and_dropped(tmp_path):
    path = tmp_path / "a.sqlite"
    filled(path, "first").close()
    filled(path, "second", seeds=1).close()
    lines = carry_out(List(path))
    assert lines[0].split() == ["digest", "runs", "scenarios", "commits", "name"]
    assert {line.split()[-1]: int(line.split()[1]) for line in lines[1:]} == names_of(path)
    end = lines[0].index("scenarios") + len("scenarios")
    assert [line[end - 2 : end + 1] for line in lines[1:]] == [" 1 "] * 3  # numbers end where their head does
    (kept,) = [name for name in names_of(path) if is_aside(name)]
    carry_out(Rename(path, kept, "mine, first training"))
    assert names_of(path) == {NAME: 1, "fixed:60": 3, "mine, first training": 3}
    for config, expected in (
        (Rename(path, "fixed:60", NAME), f"an entry '{NAME}' already"),
        (Rename(path, "fixed:61", "x"), "no entry 'fixed:61'; there are fixed:60, learned:mine.safetensors"),
        (Drop(path, "fixed:61"), "no entry 'fixed:61'"),
    ):
        with pytest.raises(EntryError, match=expected):
            carry_out(config)
    assert carry_out(Drop(path, "fixed:60")) == ["fixed:60: 3 runs deleted"]
    assert names_of(path) == {NAME: 1, "mine, first training": 3}
    with pytest.raises(ResultsError, match="no such results database"):
        carry_out(Drop(tmp_path / "b.sqlite", "fixed:60"))
    assert not (tmp_path / "b.sqlite").exists()


def test_databases_are_merged_without_mixing_controllers(tmp_path):
    ours, theirs = tmp_path / "ours.sqlite", tmp_path / "theirs.sqlite"
    filled(ours, "first", seeds=2).close()
    filled(theirs, "second", names=(NAME, "fixed:60", "spsfa"), seeds=5).close()
    lines = carry_out(Merge(ours, theirs))
    found = names_of(ours)
    (kept,) = [name for name in found if is_aside(name)]
    assert found == {NAME: 2, "fixed:60": 5, kept: 5, "spsfa": 5}
    assert sorted(lines) == sorted(
        ["fixed:60: 3 runs copied", f"{kept}: 5 runs copied", "spsfa: 5 runs copied"]
    )
    assert carry_out(Merge(ours, theirs))[0] == "fixed:60: 0 runs copied"
    other = tmp_path / "other.sqlite"
    filled(other, "first", settings=8).close()
    with pytest.raises(EntryError, match="different environments: settings differs"):
        carry_out(Merge(ours, other))
    assert names_of(ours) == found
    filled(ours, "first", names=(NAME, "spsfa")).close()  # the identity of what was merged is known


def test_the_command_lists_and_refuses(tmp_path, capsys, monkeypatch):
    path = tmp_path / "a.sqlite"
    filled(path, "first").close()
    monkeypatch.setattr("sys.argv", ["entries", "list", str(path)])
    main()
    assert capsys.readouterr().out.count("\n") == 3
    monkeypatch.setattr("sys.argv", ["entries", "drop", str(path), "nobody"])
    with pytest.raises(SystemExit, match="error: there is no entry 'nobody'"):
        main()


def test_a_policy_trained_again_under_its_name_needs_no_other_database(tmp_path, monkeypatch):
    from agents.backends import BackendOptions
    from experiments.catalogue import SUITES
    from experiments.runs import episode
    from experiments.runs.suite import Suite
    from helpers.trainings import make_policy

    policy = tmp_path / "mine.safetensors"
    suite = Suite("tiny", ("fixed:5", f"learned:{policy}"), ("case3",), 2, "fixed:5", tables=("summary",))
    monkeypatch.setitem(SUITES, "tiny", suite)
    config = EvaluateConfig("tiny", output=tmp_path, where=BackendOptions(jobs=1), figures=False)
    for seed in range(2):
        make_policy(policy, np.random.default_rng(seed))
        episode._controller.cache_clear()
        evaluate(config)
    counts = names_of(tmp_path / "tiny.sqlite")
    assert sorted(counts.values()) == [2, 2, 2]


def earlier(name):
    """Return what earlier versions stored of a controller, computed on another processor."""
    controller = make_controller(name)
    if name.startswith("open-loop"):
        decisions = controller.decisions * (1.0 + 4e-16)
        return [controller.initial_population_size, decisions.tolist()]
    if name.startswith("learned:three-cases/"):
        return [controller.manifest["weights_sha256"], 15, earlier("open-loop:three-cases")]
    return name


def earlier_database(path, **changes):
    """Make a database of an earlier version, with two runs of each controller."""
    names = ("spsfa-tip", "open-loop:three-cases", "learned:three-cases/0@1", "learned:lost/0")
    stored = {**{name: "lost" if "lost" in name else earlier(name) for name in names}, **changes}
    with closing(
        Results(path, {"optimizer": "firefly", **{f"controller {n}": v for n, v in stored.items()}})
    ) as results:
        results.add(
            *(stored_run((name, "case1", seed), {}, final_fitness=1.0) for name in names for seed in range(2))
        )
    return names


def now(names):
    """Return the configuration that a suite with these controllers has in this version."""
    return {
        IDENTITIES: FROM_CONTENT,
        **{f"controller {name}": identity(name, make_controller(name)) for name in names},
    }


def test_a_database_of_an_earlier_version_is_refused_then_carried_over_with_all_its_runs(tmp_path):
    path = tmp_path / "a.sqlite"
    *names, lost = earlier_database(path)
    before = names_of(path)
    with pytest.raises(ResultsError, match=f"carry-over {path}"):
        Results(path, now(names))
    assert names_of(path) == before
    lines = carry_out(CarryOver(path))
    assert lines[0].endswith("the runs of 3 controllers go on")
    assert len(lines) == 2
    assert lines[1].startswith(f"{lost}: its runs are left as they are")
    with closing(Results(path, now(names))) as results:
        assert results.changed == []
    assert names_of(path) == before
    assert carry_out(CarryOver(path)) == [f"{path}: the runs of 0 controllers go on"]


def test_a_controller_that_has_changed_since_is_not_carried_over(tmp_path):
    path = tmp_path / "a.sqlite"
    decisions = make_controller("open-loop:three-cases").decisions.copy()
    decisions[3, 0] += 1e-3
    changed = [make_controller("open-loop:three-cases").initial_population_size, decisions.tolist()]
    *names, _ = earlier_database(path, **{"open-loop:three-cases": changed})
    lines = carry_out(CarryOver(path))
    assert lines[0].endswith("the runs of 2 controllers go on")
    assert "open-loop:three-cases: its runs are left as they are (it has changed since its runs)" in lines
    with closing(Results(path, now(names))) as results:
        assert len(results.changed) == 1
    assert sum(is_aside(name) for name in names_of(path)) == 1
    assert sum(names_of(path).values()) == 8


def test_databases_of_different_versions_are_not_merged(tmp_path):
    ours, theirs = tmp_path / "ours.sqlite", tmp_path / "theirs.sqlite"
    names = earlier_database(theirs)
    Results(ours, now(names[:2])).close()
    with pytest.raises(EntryError, match="carry it over first"):
        carry_out(Merge(ours, theirs))
    carry_out(CarryOver(theirs))
    assert f"{names[0]}: 2 runs copied" in carry_out(Merge(ours, theirs))
