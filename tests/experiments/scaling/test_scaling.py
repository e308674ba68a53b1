"""The model of clusters, and the measurements that it is made of."""

import dataclasses
import re
from itertools import pairwise

import pytest

from experiments.catalogue import get_suite
from experiments.runs.episode import Episode
from experiments.runs.runner import make_units
from experiments.scaling import overheads
from experiments.scaling.findings_page import Findings, write_page
from experiments.scaling.model import Overheads, Work, predict
from experiments.scaling.overheads import Timed
from experiments.scaling.study import EVALUATED, evaluations, time_runs
from experiments.speed.measurement import machine

OVERHEADS = Overheads(start=30.0, per_unit=0.01, units_per_second=100.0, rows_per_second=2000.0)


@pytest.mark.parametrize(
    ("work", "cores", "seconds", "bottleneck"),
    [
        (Work(1000, 0.19, 0.5), 10, 30 + 20 + 0.5, "cores"),
        (Work(1000, 0.19, 0.5), 100, 30 + 10, "driver"),
        (Work(1000, 0.19, 0.5, rows=30_000), 100, 30 + 15, "database"),
        (Work(20, 99.99, 200.0), 1000, 30 + 2 + 200, "longest unit"),
        (Work(1, 99.99, 99.99), 1, 30 + 100 + 99.99, "cores"),
    ],
)
def test_work_takes_as_long_as_what_bounds_it(work, cores, seconds, bottleneck):
    found = predict(work, OVERHEADS, cores)
    assert found.seconds == pytest.approx(seconds)
    assert found.bottleneck == bottleneck


def test_more_cores_never_take_longer():
    walls = [predict(Work(1000, 0.2, 0.5, 10_000), OVERHEADS, cores).seconds for cores in range(1, 2000)]
    assert all(more <= fewer for fewer, more in pairwise(walls))


def test_the_study_has_all_runs_of_its_suites():
    work = evaluations({name: [0.1, 0.3] for name in EVALUATED}, cores=10)
    runs = sum(len(get_suite(name).all_runs()) for name in EVALUATED)
    assert work.rows == runs
    assert work.units * work.seconds == pytest.approx(0.2 * runs)
    assert work.longest == pytest.approx(0.3 * 10)


@pytest.mark.parametrize(("workers", "most"), [(1, 10), (100, 10), (300, 5), (100_000, 1)])
def test_units_have_several_seeds_where_there_is_work_for_all(workers, most):
    suite = get_suite("headline")
    runs = dataclasses.replace(suite, controllers=suite.controllers[:20]).all_runs()
    assert len(runs) == 12_000
    units = make_units(runs, workers)
    assert {len(unit.seeds) for unit in units} == {most}
    assert sorted((u.controller, u.scenario, seed) for u in units for seed in u.seeds) == sorted(runs)
    firsts = [unit.seeds[0] for unit in units]
    assert firsts == sorted(firsts)


@pytest.mark.slow
def test_the_page_shows_what_was_measured(tmp_path):
    findings = Findings(
        machine(),
        [
            Timed(name, "compute", 2, 500, 0.2, wall)
            for name, wall in (("local", 51), ("Ray", 51), ("Ray", 53))
        ],
        [Timed("2 nodes of 4", "wait", 8, 400, 0.2, 11.0)],
        {"Ray is started here": 5.0},
        {"local": 1000.0, "Ray": 700.0},
        {"units per second": 80.0, "driver, seconds per unit": 0.004},
        {1: 2500.0, 10: 9000.0},
        {name: [0.05] for name in EVALUATED},
        {"evolution": 0.0003, "ppo": 0.0005},
    )
    page = write_page(findings, tmp_path).read_text()
    assert "| Ray | 2 | 1,000 | 104.0 | 100.0 | 4.0 % | 2.0 % to 6.0 % |" in page
    assert "| 2 nodes of 4 | wait | 400 | 11.0 | 10.0 | 10.0 % | 10.6 |" in page
    assert "| added to each unit by Ray | 8.0 | ms each |" in page
    assert len(re.findall(r"\| all evaluations of the study \| ", page)) == 3
    assert {path.name for path in tmp_path.glob("*.md")} == {
        "README.md", "overhead.md", "nodes.md", "parts.md", "work.md", "prediction.md"
    }  # fmt: skip
    assert (tmp_path / "scaling.svg").stat().st_size > 10_000


@pytest.mark.slow
def test_what_is_measured_takes_its_time(tmp_path):
    pytest.importorskip("ray", reason="needs the extra `ray`")
    for timed in overheads.time_backends(10, 0.1, 1):
        assert timed.ideal == pytest.approx(1.0)
        assert timed.wall > 0.99
    timed = overheads.time_nodes(2, 2, "wait", 5, 0.1)
    assert (timed.workers, timed.units) == (4, 20)
    assert timed.ideal == pytest.approx(0.5)
    assert timed.wall > 0.5
    suite = get_suite("paper")
    assert all(seconds > 0.001 for seconds in time_runs(suite, suite.all_runs(), 3))
    run = Episode(("spsfa-tip", "case1", 1), suite).run({})
    assert overheads.count_results(5, 1, run, tmp_path)["units per second"] > 0
    assert set(overheads.count_rows(100, run, tmp_path)) == {1, 10}
