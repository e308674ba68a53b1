"""The study of OneMax: readings of the one-fifth rule, choice of tables."""

import numpy as np
import pytest

from experiments.onemax import OneMaxConfig, write
from experiments.studies.onemax.one_fifth import READINGS, expected_of_reading
from experiments.studies.onemax.runtimes import best_constant
from experiments.tables import Table
from swarm_gym.comparing.onemax import expected_runtime
from swarm_gym.controllers import make_controller
from swarm_gym.errors import UnknownNameError


def test_the_first_reading_is_the_rule_of_the_package_and_all_others_differ():
    found = [expected_of_reading(reading, 60) for reading in READINGS.values()]
    assert found[0] == pytest.approx(expected_runtime(make_controller("one-fifth"), 60), rel=1e-12)
    assert len(np.unique(np.round(found, 6))) == len(READINGS)


def test_a_table_is_written_by_its_name_alone(tmp_path):
    [file] = write(OneMaxConfig(output=tmp_path, tables=("counting",)))
    assert sorted(path.name for path in tmp_path.iterdir()) == [
        f"counting.{suffix}" for suffix in ("csv", "json", "md", "tex")
    ]
    assert file == tmp_path / "counting.md"
    rows = {row[0]: row[1] for row in Table.read(tmp_path / "counting.json").rows}
    assert rows["theory"].numbers["value"] == pytest.approx(583.832, abs=1e-3)


def test_a_table_that_does_not_exist_is_refused_with_those_that_do(tmp_path):
    with pytest.raises(UnknownNameError, match="one-parameter"):
        write(OneMaxConfig(output=tmp_path, tables=("nothing",)))


def test_no_constant_lambda_is_better_than_the_best_one():
    number, evaluations = best_constant(50)
    rivals = [expected_runtime(make_controller(f"static:mutants={k},children={k}"), 50) for k in (1, 2, 4, 8)]
    assert 1 <= number <= 64
    assert evaluations <= min(rivals) * (1.0 + 1e-12)
