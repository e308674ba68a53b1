"""Logs of BBOB runs say what the runs did, in the forms that cocopp and IOHanalyzer read."""

import json
import re

import numpy as np
import pytest

from experiments.bbob import BbobConfig, run
from experiments.bbob_logs import coco, iohprofiler
from experiments.bbob_logs.logged_run import LoggedGroup, LoggedRun, folder_name
from helpers.refusals import refused
from swarm_gym.env import SwarmEnv
from swarm_gym.errors import SettingError, UnknownNameError
from swarm_gym.scenarios import make_scenario
from swarm_gym.worlds import make_problem

SMALL = {
    "functions": (1, 15), "dimensions": (2, 3), "instances": (1, 4), "budget": 60,
    # Other tests run it and particle swarms on these functions, too, so that both are compiled.
    "optimizer": "cma-es",
}  # fmt: skip


def made_up(instance, *precision):
    evaluations = 10 * np.arange(1, len(precision) + 1)
    return LoggedRun(instance, -50.25, evaluations, np.array(precision), np.array([0.5, -1.0]))


GROUPS = [LoggedGroup(8, 2, (made_up(1, 3.0, 3.0, 2e-9, 2e-9), made_up(7, 0.5, 0.25)))]


@pytest.fixture(scope="module")
def logs(tmp_path_factory):
    """The folder of logs of two entrants."""
    output = tmp_path_factory.mktemp("bbob")
    controllers = ("fixed:10", "particle-swarm+fixed:12")
    list(run(BbobConfig(controllers=controllers, output=output, seed=3, **SMALL)))
    return output


def rows_of(path):
    """Return the rows of a data file, an array for each run."""
    blocks = re.split(r"^[%e].*\n", path.read_text(), flags=re.MULTILINE)[1:]
    return [np.array([line.split() for line in block.splitlines()], dtype=float) for block in blocks]


def test_coco_rows_are_improvements_and_the_last_one(tmp_path):
    info = coco.write_function(tmp_path, "mine", "seed 0", GROUPS)
    assert info.name == "bbobexp_f8.info"
    assert info.read_text() == (
        "suite = 'bbob', funcId = 8, DIM = 2, Precision = 1.000e-08, algId = 'mine', logger = 'bbob', "
        "data_format = 'bbob-new2'\n"
        "% seed 0\n"
        "data_f8/bbobexp_f8_DIM2.dat, 1:40|2.0e-09, 7:20|2.5e-01\n"
    )
    first, second = rows_of(tmp_path / "data_f8/bbobexp_f8_DIM2.dat")
    np.testing.assert_allclose(first[:, :3], [[10, 0, 3], [30, 0, 2e-9], [40, 0, 2e-9]])
    np.testing.assert_allclose(first[:, 3:], [[-47.25] * 2, [-50.25] * 2, [-50.25] * 2])
    np.testing.assert_allclose(second[:, :3], [[10, 0, 0.5], [20, 0, 0.25]])
    assert [len(rows) for rows in rows_of(tmp_path / "data_f8/bbobexp_f8_DIM2.tdat")] == [4, 2]
    assert "Fopt (-5.025000000000e+01)" in (tmp_path / "data_f8/bbobexp_f8_DIM2.dat").read_text()


def test_iohprofiler_lists_the_best_of_each_run(tmp_path):
    listed = json.loads(iohprofiler.write_function(tmp_path, "mine", "seed 0", GROUPS).read_text())
    assert (listed["function_id"], listed["function_name"]) == (8, "Rosenbrock")
    assert listed["algorithm"] == {"name": "mine", "info": "seed 0"}
    (scenario,) = listed["scenarios"]
    assert scenario["runs"] == [
        {"instance": 1, "evals": 40, "best": {"evals": 30, "y": 2e-9, "x": [0.5, -1.0]}},
        {"instance": 7, "evals": 20, "best": {"evals": 20, "y": 0.25, "x": [0.5, -1.0]}},
    ]
    first, second = rows_of(tmp_path / scenario["path"])
    np.testing.assert_allclose(first, [[10, 3.0], [30, 2e-9], [40, 2e-9]])
    np.testing.assert_allclose(second, [[10, 0.5], [20, 0.25]])


def test_the_files_of_iohprofiler_are_like_those_of_its_own_logger(tmp_path):
    ioh = pytest.importorskip("ioh", reason="needs the extra `benchmarks`")
    logger = ioh.logger.Analyzer(root=str(tmp_path), folder_name="theirs", algorithm_name="mine")
    problem = ioh.get_problem(8, 1, 2, ioh.ProblemClass.BBOB)
    problem.attach_logger(logger)
    problem([0.5, -1.0])
    problem.reset()
    logger.close()
    ours = iohprofiler.write_function(tmp_path / "ours", "mine", "", GROUPS)
    files = {
        place: sorted(p.relative_to(tmp_path / place) for p in (tmp_path / place).rglob("*") if p.is_file())
        for place in ("ours", "theirs")
    }
    assert files["ours"] == files["theirs"]
    listed = [json.loads((tmp_path / place / ours.name).read_text()) for place in files]
    assert listed[0].keys() == listed[1].keys()
    runs = [made["scenarios"][0]["runs"][0] for made in listed]
    assert runs[0].keys() == runs[1].keys()
    assert runs[0]["best"].keys() == runs[1]["best"].keys()
    assert listed[0]["attributes"] == listed[1]["attributes"]
    headers = [(tmp_path / place / files["ours"][-1]).read_text().split("\n")[0] for place in files]
    assert headers[0] == headers[1]


def test_logs_say_what_the_runs_found(logs):
    folder = logs / "iohprofiler/cma-es_fixed_10"
    listed = json.loads((folder / "IOHprofiler_f15_RastriginRotated.json").read_text())
    assert [scenario["dimension"] for scenario in listed["scenarios"]] == [2, 3]
    assert listed["algorithm"]["name"] == "cma-es+fixed:10"
    assert "budget 60 D, seed 3" in listed["algorithm"]["info"]
    for scenario in listed["scenarios"]:
        dimension = scenario["dimension"]
        courses = rows_of(folder / scenario["path"])
        theirs = rows_of(logs / f"coco/cma-es_fixed_10/data_f15/bbobexp_f15_DIM{dimension}.dat")
        for listed_run, course, rows in zip(scenario["runs"], courses, theirs, strict=True):
            name = f"function:bbob-15-{dimension}-{listed_run['instance']}"
            assert make_problem(name).evaluate(listed_run["best"]["x"])[0] == listed_run["best"]["y"]
            assert (np.diff(course, axis=0)[:, 1] <= 0.0).all()
            assert course[0, 0] == 1.0
            assert course[-1, 0] == listed_run["evals"] <= 60 * dimension
            assert course[-1, 1] == pytest.approx(listed_run["best"]["y"], rel=1e-9)
            np.testing.assert_allclose(rows[:, [0, 2]], course, rtol=1e-8)
            f_opt = make_scenario(name).least_value
            np.testing.assert_allclose(rows[:, 3], course[:, 1] + f_opt, rtol=1e-8, atol=1e-8)


def test_the_first_row_is_the_first_member_of_the_first_population(logs):
    for k, instance in enumerate(SMALL["instances"]):
        env = SwarmEnv("particle-swarm", scenario=f"function:bbob-1-2-{instance}", initial_population_size=12)
        env.reset(seed=3 + k)
        first = env.simulation.swarms.fitness[0, 0]
        rows = rows_of(logs / "coco/particle-swarm_fixed_12/data_f1/bbobexp_f1_DIM2.tdat")[k]
        assert rows[0, [0, 2]].tolist() == pytest.approx([1.0, first], rel=1e-9)
        assert rows[1, [0, 2]].tolist() == pytest.approx(
            [12.0, env.simulation.swarms.best_fitness[0]], rel=1e-9
        )


def test_every_entrant_has_a_folder_in_both_forms(logs):
    for form in ("coco", "iohprofiler"):
        assert {place.name for place in (logs / form).iterdir()} == {
            "cma-es_fixed_10", "particle-swarm_fixed_12",
        }  # fmt: skip
    assert len(list(logs.glob("coco/*/bbobexp_f*.info"))) == 4


def test_same_seed_same_logs(logs, tmp_path):
    list(run(BbobConfig(controllers=("fixed:10",), output=tmp_path, seed=3, **SMALL)))
    for path in tmp_path.rglob("*.*dat"):
        assert path.read_bytes() == (logs / path.relative_to(tmp_path)).read_bytes()


def test_iterations_and_parameters_are_those_asked_for(tmp_path):
    config = BbobConfig(
        controllers=("particle-swarm+fixed:5",), output=tmp_path, iterations=3, functions=(1,),
        dimensions=(2,), instances=(1,), parameters={"cognitive": 0.25},
    )  # fmt: skip
    list(run(config))
    (path,) = tmp_path.glob("coco/*/data_f1/*.tdat")
    (rows,) = rows_of(path)
    assert rows[:2, 0].tolist() == [1, 5]
    assert len(rows) == 5  # the first evaluation, the first population, and three iterations
    assert "cognitive 0.25, iterations 3" in next(tmp_path.glob("coco/*/*.info")).read_text()


def test_logs_of_another_run_are_not_touched(logs):
    before = {path: path.read_bytes() for path in logs.rglob("*.*") if path.is_file()}
    config = BbobConfig(controllers=("fixed:10",), output=logs, functions=(2,), optimizer="cma-es")
    refused(lambda: list(run(config)), "cma-es_fixed_10", "--output", error=SettingError)
    assert before == {path: path.read_bytes() for path in logs.rglob("*.*") if path.is_file()}


@pytest.mark.parametrize(
    ("options", "words"),
    [
        ({"functions": (1, 25)}, ["functions 1 to 24", "25"]),
        ({"dimensions": (1,)}, ["dimensions 2 to 100", "1"]),
        ({"instances": (0,)}, ["instances 1 to 1000", "0"]),
        ({"budget": 0}, ["--budget", "0"]),
        ({"instances": ()}, ["--instances"]),
        ({"budget": 1, "controllers": ("fixed:40",)}, ["max_evaluations", "2"]),
    ],
)
def test_options_that_cannot_be_are_refused_and_leave_nothing(tmp_path, options, words):
    config = BbobConfig(**{"output": tmp_path / "new", "dimensions": (2,), **options})
    refused(lambda: list(run(config)), *words, error=ValueError)
    assert not (tmp_path / "new").exists()


def test_unknown_names_are_refused(tmp_path):
    for options in ({"controllers": ("fixd:4",)}, {"optimizer": "swarm"}, {"parameters": {"noise": 1.0}}):
        config = BbobConfig(output=tmp_path, **options)
        refused(lambda c=config: list(run(c)), "unknown", error=UnknownNameError)


def test_the_default_optimizer_is_the_one_that_the_help_names():
    assert BbobConfig().optimizer == "particle-swarm"


def test_folders_have_names_without_odd_characters():
    assert folder_name("open-loop:mine/0@1") == "open-loop_mine_0_1"
