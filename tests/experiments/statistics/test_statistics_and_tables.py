"""Statistics against SciPy and by hand; tables say what the runs say."""

import csv
import io
import re

import numpy as np
import pytest
from scipy import stats

from experiments.documents.suite_page import make_tables, write_page
from experiments.runs.suite import Suite
from experiments.statistics import compare, holm, mean_interval, summarise
from experiments.studies.spsfa.published import FITNESS, SECONDS
from experiments.tables import Table
from experiments.tables.cell import (
    MISSING,
    Cell,
    count_of,
    interval_cell,
    number,
    number_in,
    share,
    share_in,
    signed_p,
    superiority_cell,
    verdict,
)
from helpers.stored_runs import cells_of, stored_run


def test_a_summary_has_the_moments_of_its_sample():
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


def test_a_comparison_is_the_one_computed_by_hand():
    found = compare(np.array([1.0, 2.0, 3.0]), np.array([2.0, 2.0, 5.0]))
    assert found.difference == -1.0
    # Of the nine pairs five are smaller and two are equal.
    assert found.superiority == pytest.approx((5 + 0.5 * 2) / 9)
    assert found.p_value == stats.wilcoxon([-1.0, 0.0, -2.0]).pvalue
    assert found.direction == -1
    # One large rise has the smallest rank of three when the falls are larger.
    assert compare(np.array([1.0, 0.0, 0.0, 9.0]), np.array([0.0, 2.0, 3.0, 9.0])).direction == -1
    # Three small rises, of ranks 1 to 3, weigh less than two large falls, of ranks 4 and 5.
    assert compare(np.array([1.0, 2.0, 3.0, 0.0, 0.0]), np.array([0.0, 0.0, 0.0, 8.0, 9.0])).direction == -1
    assert compare(np.array([2.0, 2.0, 5.0]), np.array([1.0, 2.0, 3.0])).direction == 1
    same = compare(np.ones(4), np.ones(4))
    assert (same.p_value, same.direction) == (1.0, 0)


def test_p_values_carry_their_sign_and_a12_says_where_it_disagrees_with_the_mean():
    assert [str(signed_p(0.0021, direction)) for direction in (-1, 0, 1)] == [
        "0.0021 (−)",
        "0.0021",
        "0.0021 (+)",
    ]
    assert str(superiority_cell(0.62, -0.3)) == "0.62"
    assert str(superiority_cell(0.62, 0.3)) == "0.62 ≠ mean"
    assert str(superiority_cell(0.38, -0.3)) == "0.38 ≠ mean"
    assert str(superiority_cell(0.502, 0.3)) == "0.50"


def test_holm_is_holm():
    assert holm([0.01, 0.04, 0.03, 0.005]) == pytest.approx([0.03, 0.06, 0.06, 0.02])
    assert holm([0.5, 0.9]) == [1.0, 1.0]
    assert holm([]) == []


def made_run(controller, scenario, seed, fitness, evaluations, seconds):
    collision = 0.0 if fitness < 400 else 5.0
    of = {"final_collision": collision, "evaluations": evaluations, "seconds": seconds}
    return stored_run((controller, scenario, seed), np.zeros((3, 5)), final_fitness=fitness, **of)


@pytest.fixture
def written(database, tmp_path):
    suite = Suite("made", ("fixed:60", "spsfa-tip"), ("case1",), 4, "spsfa-tip")
    for seed, (fixed, schedule) in enumerate([(310, 306), (320, 305.5), (330, 307), (440, 305)]):
        database.add(made_run("fixed:60", "case1", seed, fixed, 1000, 2.0))
        database.add(made_run("spsfa-tip", "case1", seed, schedule, 500, 0.5 + seed))
    write_page(suite, make_tables(suite, database), [], tmp_path / "out")
    return tmp_path / "out"


def printed(folder, name):
    """Return the printed rows of a stored table."""
    return cells_of([Table.read(folder / f"{name}.json")], name)


def numbers(folder, name):
    """Return the rows of a table's CSV."""
    return list(csv.DictReader(io.StringIO((folder / f"{name}.csv").read_text())))


FA_60 = {"controller": "FA-60", "max": "440.0000", "min": "310.0000", "mean": "350.0000", "feasible": "75 %",
         "paper mean": "316.0910"}  # fmt: skip
TIMES = {"mean": "2.0000", "evaluations / FA-60": "0.50", "paper time / FA-60": f"{177.1657 / 164.6528:.2f}"}


# Some cells of each row.
@pytest.mark.parametrize(
    ("table", "rows"),
    [
        ("table-03-optimal-solutions-case1", [FA_60, {"controller": "SPSFA-TIP", "paper min": "305.0436"}]),
        ("table-04-running-times-case1", [{"controller": "FA-60"}, TIMES]),
        ("reproduction", [{"min off by": "2.3 %", "min within": "**no**"}, {"min off by": "-0.0 %"}]),
        ("comparison", [{"difference": "+44.1", "A12": "0.00", "evaluations ratio": "2.00"}]),
    ],
)
def test_tables_have_our_numbers_beside_the_papers(written, table, rows):
    for found, cells in zip(printed(written, table), rows, strict=True):
        assert {column: found[column] for column in cells} == cells


def test_the_reproduction_table_says_once_that_the_paper_is_missed(written):
    assert (written / "reproduction.md").read_text().count("**no**") == 1


def test_latex_is_escaped_and_balanced(written):
    text = (written / "table-03-optimal-solutions-case1.tex").read_text()
    assert r"75 \%" in text
    assert not re.search(r"(?<!\\)%", text)
    widths = {line.count("&") for line in text.splitlines() if line.endswith(r"\\")}
    assert widths == {13}


def test_markdown_rows_have_the_width_of_the_head():
    table = Table("t", "A caption", ("a", "b"), [("1", "2"), ("3", number(4.0, ".0f"))])
    assert table.markdown().splitlines()[2:] == ["| a | b |", "| --- | --- |", "| 1 | 2 |", "| 3 | 4 |"]


def test_csv_has_the_numbers_in_full(written):
    fixed, schedule = numbers(written, "table-03-optimal-solutions-case1")
    assert fixed["controller"] == "FA-60"
    assert [float(fixed[c]) for c in ("max", "min", "mean", "feasible")] == [440.0, 310.0, 350.0, 0.75]
    low, high = (float(schedule[f"95 % interval of the mean {end}"]) for end in ("low", "high"))
    assert (low, high) == summarise(np.array([306, 305.5, 307, 305])).interval
    fixed, _ = numbers(written, "reproduction")
    assert float(fixed["min off by"]) == 310.0 / 303.0075 - 1.0
    assert fixed["min within"] == "no"
    text = "".join(path.read_text().partition("\n")[2] for path in written.glob("*.csv"))
    assert "**" not in text
    assert "±" not in text
    assert not re.search(r"\d %|\[|\dk,|\d to ", text)


def test_csv_has_a_column_for_each_number():
    rows = [
        ("one", share_in(0.5, (0.25, 0.75)), count_of(3, 4), verdict(False), number(1.0), MISSING),
        ("two", MISSING, count_of(4, 4), verdict(True), number(2.0), interval_cell((0.0, np.inf))),
    ]
    table = Table("t", "A caption", ("name", "a", "b", "c", "d", "d"), rows)
    assert table.csv().splitlines() == [
        "name,a,a low,a high,b,b total,c,d,d low,d high",
        "one,0.5,0.25,0.75,3,4,no,1.0,,",
        "two,,,,4,4,yes,2.0,0.0,inf",
    ]
    twice = Table("t", "", ("d", "d"), [(number(1.0), number(2.0))])
    assert twice.csv() == "d,d (2)\n1.0,2.0\n"


@pytest.mark.parametrize(
    ("cell", "text"),
    [
        (number(1234.5, ",.1f"), "1,234.5"),
        (number(np.nan), "–"),
        (number(None), "–"),
        (number(True, "d"), "1"),
        (share(0.123), "12.3 %"),
        (share(np.nan), "–"),
        (share(-0.0004, "+.1f"), "-0.0 %"),
        (number_in(1.0, (0.5, 2.0), ".2f"), "1.00 [0.50, 2.00]"),
        (share_in(0.01, (-0.02, 0.03), "+.2f"), "+1.00 % [-2.00, +3.00]"),
        (interval_cell((1.0, 2.0)), "1.0 to 2.0"),
        (count_of(3, 4), "3 of 4"),
        (verdict(True), "yes"),
        (verdict(False), "**no**"),
        (Cell.of("at {value:k.0f}k", value=12_345.0), "at 12k"),
    ],
)
def test_a_cell_prints_its_numbers(cell, text):
    assert str(cell) == text


def test_a_table_is_read_as_it_was_written(tmp_path):
    rows = [("a {b}", share_in(1 / 3, (0.1, np.inf))), ("**c**", number(np.int64(7), "d"))]
    table = Table("t", "Ä caption", ("x", "y"), rows, "case1")
    table.write(tmp_path)
    assert {path.name for path in tmp_path.iterdir()} == {"t.md", "t.tex", "t.csv", "t.json"}
    assert Table.read(tmp_path / "t.json") == table
    no_rows = Table("t", "", ("x",), [])
    (tmp_path / "t.json").write_text(no_rows.json())
    assert Table.read(tmp_path / "t.json") == no_rows


@pytest.mark.parametrize(
    "damaged",
    ["", "{}", "[]", "null", '{"name": "t", "caption": "", "scenario": null, "columns": ["x"], "rows": [[]]}',
     '{"name": "t", "caption": "", "scenario": null, "columns": ["x"], "rows": [[3]]}'],
)  # fmt: skip
def test_what_is_no_table_is_named(tmp_path, damaged):
    (tmp_path / "t.json").write_text(damaged)
    with pytest.raises(ValueError, match=r"t\.json is not a table"):
        Table.read(tmp_path / "t.json")


def test_a_table_knows_the_scenario_that_it_is_about(written):
    scenarios = {table.name: table.scenario for table in map(Table.read, written.glob("*.json"))}
    assert (
        scenarios["table-03-optimal-solutions-case1"] == scenarios["table-04-running-times-case1"] == "case1"
    )
    assert scenarios["summary"] is scenarios["comparison"] is scenarios["reproduction"] is None


def test_the_papers_numbers_are_consistent():
    assert set(FITNESS) == set(SECONDS)
    assert len(FITNESS) == 15
    for row in (*FITNESS.values(), *SECONDS.values()):
        assert row.minimum < row.mean < row.maximum
        assert row.deviation < row.maximum - row.minimum
