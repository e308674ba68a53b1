"""A suite on a Ray cluster of several nodes has the rows of this machine, whatever is killed meanwhile."""

import json
import os
import signal
import subprocess
import sys
import threading
import time
from contextlib import closing

import numpy as np
import pytest

from agents.backends.local import LocalBackend
from agents.backends.many_runs import carry_out, configs_of_seeds, train
from agents.backends.packing import files_of
from agents.backends.ray_backend import RayBackend
from experiments.runs.configuration import configuration
from experiments.runs.database import Results
from experiments.runs.runner import missing_runs, run_missing
from experiments.runs.suite import Suite
from experiments.scaling.overheads import logical_cluster
from helpers.own_files import let_own_files_be_imported
from helpers.small_commands import CONTROLLERS, IMITATION, rows
from helpers.stored_runs import make_database
from helpers.trainings import STEPS, TINY, assert_same_weights, make_policy, tiny_config
from swarm_gym.controllers.learned.policy_file import load_policy
from swarm_gym.training.run import TrainingRun

if not sys.platform.startswith("linux"):
    pytest.skip("needs Linux: it looks at processes", allow_module_level=True)
pytest.importorskip("ray", reason="needs the extra `ray`")

pytestmark = pytest.mark.slow

SUITE = Suite("paper", CONTROLLERS, ("case1", "case2", "case3"), num_seeds=12, baseline="spsfa-tip")


@pytest.fixture
def cluster():
    """A cluster of two nodes with one processor each; the head has none, so that no work is lost with it."""
    with logical_cluster(0, 1) as (_, made):
        made.workers = [made.add_node(num_cpus=1) for _ in range(2)]
        yield made


class Watched(Results):
    """A database that calls a function when it has a given number of runs."""

    def __init__(self, path, suite, after, what):
        super().__init__(path, configuration(suite))
        self.after, self.what, self.stored = after, what, []

    def add(self, *runs):
        super().add(*runs)
        self.stored += [(run.controller, run.scenario, run.seed) for run in runs]
        if self.what and len(self.stored) >= self.after:
            what, self.what = self.what, None
            what()


@pytest.fixture(scope="module")
def whole(tmp_path_factory):
    """The folder of a database with all runs, computed by this machine."""
    return make_database(tmp_path_factory.mktemp("whole") / "paper.sqlite", SUITE, LocalBackend(2)).parent


@pytest.mark.parametrize("killed", ["nothing", "worker", "node"])
def test_rows_are_those_made_here_whatever_is_killed(tmp_path, cluster, whole, killed):
    def kill_a_worker():  # of this cluster; other tests have theirs meanwhile
        raylets = [str(node.all_processes["raylet"][0].process.pid) for node in cluster.workers]
        find = ["pgrep", "-P", ",".join(raylets), "-f", "ray::_carry_out"]
        for _ in range(100):
            found = subprocess.run(find, capture_output=True, text=True, check=False).stdout.split()
            if found:
                os.kill(int(found[0]), signal.SIGKILL)
                return
            time.sleep(0.02)
        pytest.fail("no worker is at work")

    def kill_a_node():
        cluster.remove_node(cluster.workers[0], allow_graceful=False)

    what = {"nothing": None, "worker": kill_a_worker, "node": kill_a_node}[killed]
    with (
        closing(Watched(tmp_path / "paper.sqlite", SUITE, 20, what)) as results,
        closing(RayBackend(cluster.address, 0)) as backend,
    ):
        assert backend.workers() == 2
        run_missing(SUITE, results, backend)
    assert results.what is None
    assert len(results.stored) == len(set(results.stored)) == 3 * 3 * 12
    assert rows(tmp_path) == rows(whole)


def test_what_one_backend_began_another_one_ends(tmp_path, cluster, whole):
    class StoppedError(Exception):
        pass

    def stop():
        raise StoppedError

    path = tmp_path / "paper.sqlite"
    with closing(Watched(path, SUITE, 20, stop)) as first, pytest.raises(StoppedError):
        run_missing(SUITE, first, LocalBackend(2))
    with (
        closing(Watched(path, SUITE, 0, None)) as results,
        closing(RayBackend(cluster.address, 0)) as backend,
    ):
        lacking = missing_runs(SUITE, results)
        assert 0 < len(lacking) < 3 * 3 * 12
        run_missing(SUITE, results, backend)
    assert sorted(results.stored) == sorted(lacking)
    assert rows(tmp_path) == rows(whole)


def test_workers_find_maps_and_policies_of_the_command(tmp_path, cluster, monkeypatch):
    """Workers have another working directory and another environment than the command."""
    monkeypatch.chdir(tmp_path)
    monkeypatch.setenv("SWARM_GYM_DATA", str(tmp_path / "data"))
    (tmp_path / "data").mkdir()
    (tmp_path / "data" / "room.map").write_text(
        "type octile\nheight 8\nwidth 8\nmap\n" + ("." * 8 + "\n") * 3 + "...@@@..\n" + ("." * 8 + "\n") * 4
    )
    make_policy(tmp_path / "mine.safetensors", np.random.default_rng(0))
    controllers = ("spsfa-tip", "learned:mine.safetensors")
    suite = Suite("paper", controllers, ("moving-ai:room?start=0,0&goal=7,7",), 3, "spsfa-tip")
    with closing(RayBackend(cluster.address, 0, list(files_of(controllers)))) as backend:
        for name, by in (("here", LocalBackend(1)), ("there", backend)):
            make_database(tmp_path / name / "paper.sqlite", suite, by)
    assert rows(tmp_path / "here") == rows(tmp_path / "there")
    assert len(rows(tmp_path / "there")) == 6


def test_workers_get_the_own_code_that_a_command_names(tmp_path, cluster, monkeypatch):
    monkeypatch.chdir(tmp_path)
    let_own_files_be_imported(tmp_path, monkeypatch)
    suite = Suite("paper", ("my_swarms.rule:ByThirds", "spsfa-tip"), ("my_swarms.hall:HALL",), 3, "spsfa-tip")
    with closing(RayBackend(cluster.address, 0)) as backend:
        for name, by in (("here", LocalBackend(1)), ("there", backend)):
            make_database(tmp_path / name / "paper.sqlite", suite, by)
    assert rows(tmp_path / "here") == rows(tmp_path / "there")
    assert len(rows(tmp_path / "there")) == 6


def test_a_training_whose_node_is_lost_goes_on_from_its_checkpoint(tmp_path, cluster):
    long = {"warm_start": "none", "total_steps": 15 * STEPS}
    begun = [tmp_path / "many" / seed / "latest.safetensors" for seed in ("0", "1")]

    def kill_a_node():
        while not all(path.exists() for path in begun):
            time.sleep(0.02)
        cluster.remove_node(cluster.workers[0], allow_graceful=False)

    killer = threading.Thread(target=kill_a_node, daemon=True)
    killer.start()
    configs = configs_of_seeds(tiny_config(tmp_path, **long, name="many"), [0, 1])
    with closing(RayBackend(cluster.address, 0)) as backend:
        outcomes = list(carry_out(train, configs, backend))
    killer.join(10)
    assert not killer.is_alive()
    for outcome in outcomes:
        seed = int(outcome.folder.name)
        single = TrainingRun(tiny_config(tmp_path, **long, seed=seed, name=f"single{seed}"))
        assert_same_weights(single.run(), outcome.finished.result)


@pytest.fixture
def search():
    """Search by Ray Tune, by the options of its configuration."""
    pytest.importorskip("ray.tune", reason="needs the extra `ray-tune`", exc_type=ImportError)
    from experiments import with_ray_tune

    return lambda **options: with_ray_tune.search(with_ray_tune.SearchConfig(**options))


@pytest.mark.parametrize("options", [{"trials": -1}, {"rungs": 0}, {"jobs": -2}])
def test_a_search_that_cannot_be_is_refused(tmp_path, search, options):
    ((name, value),) = options.items()
    with pytest.raises(ValueError, match=f"--{name}.*{value}"):
        search(runs=tmp_path / "runs", **options)
    assert list(tmp_path.iterdir()) == []


def test_ray_tune_searches_a_preset(tmp_path, search):
    lines = [f"{name} = {json.dumps(value)}" for name, value in {**TINY, "warm_start": "none"}.items()]
    (tmp_path / "tiny.toml").write_text(f"like = '{IMITATION}'\n" + "\n".join(lines))
    few = {"trials": 4, "rungs": 2, "total_steps": 4 * STEPS, "jobs": 2}
    policy, values = search(preset=str(tmp_path / "tiny.toml"), runs=tmp_path / "runs", **few)
    _, manifest = load_policy(policy)
    assert {name: manifest["config"][name] for name in values} == values
    runs = [json.loads(path.read_text()) for path in (tmp_path / "runs").glob("*/config.json")]
    assert len(runs) == 4
    assert len({run["learning_rate"] for run in runs}) == 4
