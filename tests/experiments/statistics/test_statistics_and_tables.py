"""Statistics against SciPy and by hand; tables say what the runs say."""

import csv
import io
import re

import numpy as np
import pytest
from scipy import stats

from experiments.catalogue import Suite
from experiments.documents.page import write_page
from experiments.runs.database import Results
from experiments.runs.labels import label
from experiments.runs.run import Run
from experiments.statistics import compare, holm, mean_interval, summarise
from experiments.studies.spsfa.published import FITNESS, SECONDS
from experiments.tables import Table, make_tables


def test_summary_of_a_sample():
    values = np.array([4.0, 1.0, 3.0, 12.0])
    found = summarise(values)
    assert (found.maximum, found.minimum, found.mean, found.median) == (12, 1, 5, 3.5)
    assert found.deviation == pytest.approx(np.sqrt((1 + 16 + 4 + 49) / 3))
    assert found.interval[0] < 5 < found.interval[1]


def test_interval_covers_the_mean_as_often_as_it_says():
    rng = np.random.default_rng(0)
    hits = 0
    for _ in range(100):
        low, high = mean_interval(rng.exponential(size=60))
        hits += low <= 1.0 <= high
    assert 86 <= hits <= 99


def test_interval_of_a_constant_is_a_point():
    assert mean_interval(np.full(5, 2.5)) == (2.5, 2.5)


def test_comparison_by_hand():
    found = compare(np.array([1.0, 2.0, 3.0]), np.array([2.0, 2.0, 5.0]))
    assert found.difference == -1.0
    # Of the nine pairs five are smaller and two are equal.
    assert found.superiority == pytest.approx((5 + 0.5 * 2) / 9)
    assert found.p_value == stats.wilcoxon([-1.0, 0.0, -2.0]).pvalue
    assert compare(np.ones(4), np.ones(4)).p_value == 1.0


def test_holm_is_holm():
    assert holm([0.01, 0.04, 0.03, 0.005]) == pytest.approx([0.03, 0.06, 0.06, 0.02])
    assert holm([0.5, 0.9]) == [1.0, 1.0]
    assert holm([]) == []


def made_run(controller, scenario, seed, fitness, evaluations, seconds):
    trace = np.zeros((3, 5))
    return Run(controller, scenario, seed, fitness, 0.0 if fitness < 400 else 5.0, evaluations,
               seconds, np.zeros((4, 2)), trace, {})  # fmt: skip


@pytest.fixture
def written(tmp_path):
    suite = Suite("made", ("fixed:60", "spsfa-tip"), ("case1",), 4, "spsfa-tip")
    results = Results(tmp_path / "made.sqlite")
    for seed, (fixed, schedule) in enumerate([(310, 306), (320, 305.5), (330, 307), (440, 305)]):
        results.add(made_run("fixed:60", "case1", seed, fixed, 1000, 2.0))
        results.add(made_run("spsfa-tip", "case1", seed, schedule, 500, 0.5 + seed))
    write_page(suite, make_tables(suite, results), [], tmp_path / "out")
    results.close()
    return tmp_path / "out"


def read(path):
    return list(csv.DictReader(io.StringIO(path.read_text())))


def test_fitness_table_has_our_numbers_and_the_papers(written):
    fixed, schedule = read(written / "table-03-optimal-solutions-case1.csv")
    assert fixed["controller"] == label("fixed:60") == "FA-60"
    assert [fixed[c] for c in ("max", "min", "mean")] == ["440.0000", "310.0000", "350.0000"]
    assert fixed["feasible"] == "75 %"
    assert fixed["paper mean"] == "316.0910"
    assert schedule["controller"] == "SPSFA-TIP"
    assert schedule["paper min"] == "305.0436"


def test_time_table_relates_evaluations_and_the_papers_times_to_fa_60(written):
    _, schedule = read(written / "table-04-running-times-case1.csv")
    assert schedule["mean"] == "2.0000"
    assert schedule["evaluations / FA-60"] == "0.50"
    assert schedule["paper time / FA-60"] == f"{177.1657 / 164.6528:.2f}"


def test_reproduction_table_says_where_the_paper_is_missed(written):
    fixed, schedule = read(written / "reproduction.csv")
    assert fixed["min off by"] == "2.3 %"
    assert "no" in fixed["min within"]
    assert schedule["min off by"] == "-0.0 %"
    rows = (written / "reproduction.md").read_text()
    assert rows.count("**no**") == 1


def test_comparison_is_paired(written):
    (row,) = read(written / "comparison.csv")
    assert row["difference"] == "+44.1"
    assert row["A12"] == "0.00"
    assert row["evaluations ratio"] == "2.00"


def test_latex_is_escaped_and_balanced(written):
    text = (written / "table-03-optimal-solutions-case1.tex").read_text()
    assert r"75 \%" in text
    assert not re.search(r"(?<!\\)%", text)
    widths = {line.count("&") for line in text.splitlines() if line.endswith(r"\\")}
    assert widths == {13}


def test_markdown_rows_have_the_width_of_the_head():
    table = Table("t", "A caption", ("a", "b"), [("1", "2"), ("3", "4")])
    assert table.markdown().splitlines()[2:] == ["| a | b |", "| --- | --- |", "| 1 | 2 |", "| 3 | 4 |"]


def test_the_papers_numbers_are_consistent():
    assert set(FITNESS) == set(SECONDS)
    assert len(FITNESS) == 15
    for row in (*FITNESS.values(), *SECONDS.values()):
        assert row.minimum < row.mean < row.maximum
        assert row.deviation < row.maximum - row.minimum
