"""Claims about policies: those that hold, those that are false, and those that are refused before a run."""

import dataclasses
import json
import re
from contextlib import closing

import numpy as np
import pytest

from experiments import verify as command
from experiments.catalogue import SUITES
from experiments.runs.database import Results, ResultsError
from experiments.runs.episode import Episode, controller_of
from experiments.scoring import cases
from experiments.scoring.claimed_rows import ClaimError
from experiments.scoring.files import COLUMNS, ScoreFileError, read_scores, write_scores
from experiments.scoring.score import digest_of_runs, measure
from experiments.scoring.submission import SubmissionError
from experiments.scoring.suites import SCORED
from experiments.verify import VerifyConfig, verify
from helpers.stored_runs import make_database
from helpers.trainings import make_policy
from swarm_gym.controllers.learned.policy_file import PolicyFileError, load_policy, resolve, save_policy
from swarm_gym.errors import UnknownNameError
from swarm_gym.rollout import run_swarms, swarms_for

POLICY = "learned:three-cases/0"
SOURCED = "learned:three-cases-evolution/0"
PARTICLES = "learned:optimizers-particle-swarm/0"


def small(name, num_seeds=2):
    """Return a scored suite with two scenarios and few seeds."""
    whole = SCORED[name]
    experiment = dataclasses.replace(whole.experiment, scenarios=("case1", "case3"), num_seeds=num_seeds)
    return dataclasses.replace(whole, experiment=experiment)


@pytest.fixture(autouse=True)
def small_suites(monkeypatch):
    for name in ("headline", "optimizers"):
        monkeypatch.setitem(SCORED, name, small(name))


@pytest.fixture
def no_run(monkeypatch):
    """Fail the test if anything runs."""

    def fail(*_):
        raise AssertionError("a run was made before the submission was refused")

    monkeypatch.setattr(Episode, "run", fail)


@pytest.fixture(scope="module")
def rows():
    """The true scores of the policy."""
    headline = small("headline")
    return measure({f"{POLICY}@1": cases.digest_of_policy(POLICY)}, headline)


def asked(folder, *files, **options):
    (folder / "scores").mkdir(exist_ok=True)
    return VerifyConfig(files, **{"suite": "headline", "scores": folder / "scores", **options})


def claim_of(folder, rows):
    return write_scores(folder / "claim.csv", rows)


def with_runs(row, fitness):
    """Return a score with other best fitnesses, whose digest is right."""
    digest = digest_of_runs(fitness, row.evaluations_of_runs)
    return dataclasses.replace(row, fitness_of_runs=tuple(fitness), runs_digest=digest)


def changed_policy(path, change=lambda _: None, name="three-cases/0", **entries):
    """Write a packaged policy with changed weights or manifest and with digests that are right."""
    weights, manifest = load_policy(resolve(name))
    weights = {key: array.copy() for key, array in weights.items()}
    change(weights)
    save_policy(path, weights, {**manifest, **entries})
    return str(path)


def test_seeds_side_by_side_have_the_bits_of_single_runs(rows):
    headline = small("headline")
    for name, found in ((f"{POLICY}@1", rows), ("random", measure({"random": "0" * 64}, headline))):
        controller = controller_of(name)
        for row in found:
            seeds = headline.experiment.seeds[row.scenario_set]
            swarms = swarms_for(controller, len(seeds), "firefly", scenario=row.scenario_set)
            run_swarms(controller, swarms, seeds)
            final = swarms.simulation.swarms
            assert row.fitness_of_runs == tuple(final.best_fitness)
            assert row.evaluations_of_runs == tuple(final.evaluations)
            assert row.feasible == np.mean(final.best_collision <= 1e-9)


def test_what_was_measured_is_verified_bit_for_bit(tmp_path, capsys):
    output = tmp_path / "claim.csv"
    assert verify(asked(tmp_path, POLICY, output=output))
    said = capsys.readouterr().out
    assert re.search(r"measured only, nothing is claimed, \d+ runs of headline, objective \d\.\d{3}", said)
    assert "1 measured: nothing is claimed" in said
    copy = tmp_path / "mine.safetensors"
    copy.write_bytes(resolve("three-cases/0").read_bytes())
    for name in (f"{POLICY}@1", str(copy)):  # a claim is about a file, whatever its name
        assert verify(asked(tmp_path, name, claim=output))
        said = capsys.readouterr().out
        assert f"{name}: equal bit for bit, 4 runs of headline" in said
        assert "1 verified: 1 equal bit for bit" in said


def test_a_folder_of_scores_that_is_not_there_is_refused(tmp_path):
    with pytest.raises(ScoreFileError, match=r"--scores .*misspelt: there is no such folder"):
        verify(asked(tmp_path, POLICY, scores=tmp_path / "misspelt"))


def test_stored_runs_of_a_study_are_a_claim(tmp_path, capsys):
    names, scenarios = (f"{POLICY}@1", "spsfa-tip"), ("case1", "case3")
    suite = dataclasses.replace(SUITES["headline"], controllers=names, scenarios=scenarios, num_seeds=3)
    database = make_database(tmp_path / "headline.sqlite", suite)
    for name in names:
        assert verify(asked(tmp_path, name, claim=database))
        assert f"{name}: equal bit for bit, 4 runs of headline" in capsys.readouterr().out
    with closing(Results(database)) as results, results.writing() as connection:
        connection.execute("UPDATE runs SET evaluations = 7 WHERE scenario = 'case3' AND seed = 30001")
    assert not verify(asked(tmp_path, "spsfa-tip", claim=database))
    said = capsys.readouterr().out
    assert "on case3 with seed 30001: evaluations is claimed to be 7, found " in said


def test_a_database_that_cannot_be_the_claim_is_refused(tmp_path, no_run):
    with pytest.raises(ResultsError, match=r"none\.sqlite: there is no such results database"):
        verify(asked(tmp_path, POLICY, claim=tmp_path / "none.sqlite"))
    with closing(Results(tmp_path / "other.sqlite", {f"controller {POLICY}@1": ["another policy"]})):
        pass
    with pytest.raises(ResultsError, match="holds runs of another configuration: controller learned:three"):
        verify(asked(tmp_path, POLICY, claim=tmp_path / "other.sqlite"))
    with closing(Results(tmp_path / "empty.sqlite")):
        pass
    with pytest.raises(ResultsError, match=r"learned:three-cases/0@1 on case1 has 0 of 2 runs"):
        verify(asked(tmp_path, POLICY, claim=tmp_path / "empty.sqlite"))


def test_stored_scores_are_the_claim_by_default_and_tell_the_suite(tmp_path, rows, capsys):
    write_scores(tmp_path / "scores" / "headline.csv", rows)
    assert verify(asked(tmp_path, POLICY, suite=None))
    assert "claim of" in capsys.readouterr().out


def test_one_changed_weight_is_found(tmp_path, rows, capsys):
    def change(weights):
        weights["0.weight"][0, 0] += 0.01

    file = changed_policy(tmp_path / "changed.safetensors", change)
    with pytest.raises(ClaimError, match=r"digest \w{12} is not that of .*changed"):
        verify(asked(tmp_path, file, claim=claim_of(tmp_path, rows)))
    digest = cases.digest_of_policy(file)
    claim = claim_of(tmp_path, [dataclasses.replace(row, digest=digest) for row in rows])
    assert not verify(asked(tmp_path, file, claim=claim))
    said = capsys.readouterr().out
    assert "differs, 4 runs of headline: swarm_gym/Firefly-v0 on case1 with seed 30000: best fitness" in said
    assert f"is claimed to be {rows[0].fitness_of_runs[0]!r}, found" in said


def test_a_changed_weight_with_the_old_digests_is_refused(tmp_path, no_run):
    data = bytearray(resolve("three-cases/0").read_bytes())
    data[-1] ^= 1
    (tmp_path / "changed.safetensors").write_bytes(data)
    with pytest.raises(PolicyFileError, match="weights do not match their digest"):
        verify(asked(tmp_path, str(tmp_path / "changed.safetensors")))


@pytest.mark.parametrize("column", ["gap", "evaluations", "feasible"])
def test_a_false_mean_is_found(tmp_path, rows, capsys, column):
    false = [dataclasses.replace(rows[0], **{column: 0.25}), rows[1]]
    assert not verify(asked(tmp_path, POLICY, claim=claim_of(tmp_path, false)))
    assert f"on case1: the mean {column} is claimed to be 0.25" in capsys.readouterr().out


def test_a_false_run_is_found_and_named(tmp_path, rows, capsys):
    first, second = rows[1].fitness_of_runs
    false = [rows[0], with_runs(rows[1], [first, second - 1.0])]
    assert not verify(asked(tmp_path, POLICY, claim=claim_of(tmp_path, false)))
    said = capsys.readouterr().out
    assert (
        f"on case3 with seed 30001: best fitness is claimed to be {second - 1.0!r}, found {second!r}" in said
    )


def test_another_last_bit_is_equal_within_the_tolerance(tmp_path, rows, capsys):
    near = [with_runs(row, np.nextafter(row.fitness_of_runs, np.inf).tolist()) for row in rows]
    assert verify(asked(tmp_path, POLICY, claim=claim_of(tmp_path, near)))
    assert f"{POLICY}: equal within 1e-09, 4 runs" in capsys.readouterr().out


def test_false_claims_end_the_command_with_1(tmp_path, rows, monkeypatch):
    claim = claim_of(tmp_path, [dataclasses.replace(rows[0], gap=0.0), rows[1]])
    given = ["verify", POLICY, "--suite", "headline", "--claim", str(claim)]
    monkeypatch.setattr("sys.argv", given)
    with pytest.raises(SystemExit) as ended:
        command.main()
    assert ended.value.code == 1


@pytest.mark.parametrize(
    ("change", "message"),
    [
        (
            lambda rows: [dataclasses.replace(row, digest="0" * 64) for row in rows],
            "digest 000000000000 is not",
        ),
        (lambda rows: rows[:1], "lacks the rows of swarm_gym/Firefly-v0 on case3"),
        (lambda rows: [*rows, rows[0]], "2 rows of swarm_gym/Firefly-v0 on case1, expected one"),
        (
            lambda rows: [dataclasses.replace(rows[0], first_seed=0), rows[1]],
            "first_seed of case1 is 0; the suite headline states 30000",
        ),
        (
            lambda rows: [rows[0], dataclasses.replace(rows[1], num_seeds=3)],
            "num_seeds of case3 is 3; the suite headline states 2",
        ),
        (
            lambda rows: [dataclasses.replace(row, environment="swarm_gym/FishSwarm-v0") for row in rows],
            "swarm_gym/FishSwarm-v0 on case1 is not part of the suite headline",
        ),
        (
            lambda rows: [dataclasses.replace(row, scenario_set="case2") for row in rows],
            "swarm_gym/Firefly-v0 on case2 is not part of the suite headline; expected .*1, .*3",
        ),
    ],
)
def test_a_claim_about_something_else_is_refused(tmp_path, rows, no_run, change, message):
    with pytest.raises(ClaimError, match=rf"claim\.csv: {message}"):
        verify(asked(tmp_path, POLICY, claim=claim_of(tmp_path, change(rows))))


@pytest.mark.parametrize(
    ("column", "value", "message"),
    [
        ("num_seeds", "", "line 2: num_seeds must be an integer from 1 .*, got ''"),
        ("first_seed", "-1", "line 2: first_seed must be an integer from 0"),
        ("gap", "nan", "line 2: gap must be a finite number, got 'nan'"),
        ("feasible", "1.5", "line 2: feasible must be a share from 0 to 1"),
        ("digest", "abc", "line 2: digest must be a digest of 64 hexadecimal digits"),
        ("fitness_of_runs", "1.0", "line 2: fitness_of_runs has 1 numbers, evaluations_of_runs has 2"),
        ("fitness_of_runs", "1.0 2.0", "line 2: runs_digest .* is not the digest of fitness_of_runs"),
        ("evaluations_of_runs", "1 x", "line 2: evaluations_of_runs must be integers"),
        ("first_seed", None, "lacks the columns first_seed; expected controller"),
    ],
)
def test_a_file_with_values_that_cannot_be_is_refused(tmp_path, rows, no_run, column, value, message):
    texts = [line.split(",") for line in claim_of(tmp_path, rows).read_text().splitlines()]
    place = COLUMNS.index(column)
    if value is None:
        texts = [[*line[:place], *line[place + 1 :]] for line in texts]
    else:
        texts[1][place] = value
    path = tmp_path / "claim.csv"
    path.write_text("\n".join(",".join(line) for line in texts))
    with pytest.raises(ScoreFileError, match=rf"claim\.csv.* {message}"):
        verify(asked(tmp_path, POLICY, claim=path))


@pytest.mark.parametrize("content", [b"", b"\xff\xfe", b'"', b"a\0b", b"controller\n"])
def test_a_file_that_is_no_table_of_scores_is_refused(tmp_path, content):
    path = tmp_path / "claim.csv"
    path.write_bytes(content)
    with pytest.raises(ScoreFileError, match=r"claim\.csv"):
        read_scores(path)
    with pytest.raises(ScoreFileError, match="no such file"):
        read_scores(tmp_path / "none.csv")


def test_scores_come_back_bit_for_bit(tmp_path, rows):
    assert read_scores(claim_of(tmp_path, rows)) == rows


@pytest.mark.parametrize(
    ("name", "suite", "error", "message"),
    [
        ("no-such.safetensors", "headline", PolicyFileError, "'no-such.safetensors': no such file"),
        ("fixed:61", "headline", PolicyFileError, "'fixed:61': no policy, and no controller of the suite"),
        ("learned:three-cases/99", "headline", PolicyFileError, "neither a packaged one"),
        (
            PARTICLES,
            "headline",
            SubmissionError,
            "states the optimizer particle-swarm, but the suite headline is of firefly",
        ),
        (f"{POLICY}@5", "headline", SubmissionError, "expected the price @1, got @5"),
        (POLICY, "no-such", UnknownNameError, "unknown scored suite 'no-such'; valid: ablation"),
        (POLICY, None, ValueError, "has its digest; choose the --suite that shall score it, one of headline"),
    ],
)
def test_a_submission_that_is_not_for_the_suite_is_refused(tmp_path, no_run, name, suite, error, message):
    with pytest.raises(error, match=message):
        verify(asked(tmp_path, name, suite=suite))


def test_a_file_that_is_no_policy_is_refused(tmp_path, no_run):
    (tmp_path / "text.safetensors").write_text("hello")
    with pytest.raises(PolicyFileError, match=r"text\.safetensors: not a readable policy file"):
        verify(asked(tmp_path, str(tmp_path / "text.safetensors")))


def test_a_claim_without_its_file_is_refused(tmp_path):
    with pytest.raises(ValueError, match=r"--claim .*claim\.csv needs the FILE that it is about"):
        verify(asked(tmp_path, claim=tmp_path / "claim.csv"))


@pytest.mark.parametrize(
    ("entries", "message"),
    [
        (
            {"optimizer": "particle-swarm"},
            "contradicts itself: optimizer is 'particle-swarm', but config.opt",
        ),
        (
            {"base": "open-loop:three-cases-constant"},
            "contradicts itself: base is 'open-loop:three-cases-con",
        ),
        (
            {"price": [0.1, 9.0]},
            r"contradicts itself: price is \[0.1, 9.0\], but config.price is \[0.3, 5.0\]",
        ),
        ({"max_population_size": 400}, "contradicts itself: max_population_size is 400, but config.max"),
        (
            {"validation_seeds": [29_999, 30_001]},
            "validation with seeds 29999 to 30000, among which are seeds",
        ),
        (
            {"hidden_layers": [64, 63]},
            r"tensor '1\.weight': expected .*63, 64.* by the manifest, got .*64, 64",
        ),
        ({"num_decisions": 3}, "tensor '2.weight': expected"),
        ({"features": ["a"] * 16}, "trained with observation features"),
        ({"action": "extended-normalised", "config": {}}, "num_decisions must be 4 with action"),
    ],
)
def test_a_manifest_that_lies_is_refused(tmp_path, no_run, entries, message):
    file = changed_policy(tmp_path / "lie.safetensors", **entries)
    with pytest.raises((SubmissionError, PolicyFileError), match=message):
        verify(asked(tmp_path, file))


def test_a_manifest_that_was_changed_afterwards_is_refused(tmp_path, no_run):
    data = resolve("three-cases/0").read_bytes()
    steps = json.dumps(load_policy(resolve("three-cases/0"))[1]["steps"]).encode()
    assert data.count(steps) == 1
    path = tmp_path / "lie.safetensors"
    path.write_bytes(data.replace(steps, b"1" * len(steps)))
    with pytest.raises(PolicyFileError, match="manifest does not match its own digest"):
        verify(asked(tmp_path, str(path)))


def test_a_base_that_is_a_file_is_refused(tmp_path, no_run, monkeypatch):
    monkeypatch.chdir(tmp_path)
    source = resolve("three-cases/0").parents[2] / "open_loops" / "three-cases.json"
    assert source.is_file()
    (tmp_path / "mine.json").write_bytes(source.read_bytes())
    file = changed_policy(tmp_path / "mine.safetensors", base="open-loop:mine.json", config={})
    with pytest.raises(SubmissionError, match=r"base 'open-loop:mine\.json' is a file; a score needs a base"):
        verify(asked(tmp_path, file))


def test_a_policy_of_several_optimizers_has_rows_of_each(tmp_path):
    rng = np.random.default_rng(0)
    file = make_policy(tmp_path / "both.safetensors", rng, optimizer="firefly", also_on=["fish-swarm"])
    submission = cases.read_submission(str(file), SCORED["optimizers"])
    assert submission.entrants == (f"fish-swarm+learned:{file}", f"firefly+learned:{file}")
    one = cases.read_submission(str(file), SCORED["headline"])
    assert one.entrants == (f"learned:{file}",)


def test_controllers_that_are_no_policies_are_verified_too(tmp_path, capsys):
    scores = tmp_path / "scores" / "optimizers.csv"
    names = ("particle-swarm+fixed:20", "elite-genetic+fixed:20")  # alike but for the optimizer
    assert verify(asked(tmp_path, *names, suite="optimizers", output=scores))
    capsys.readouterr()
    assert verify(asked(tmp_path, *names, suite=None))
    assert "2 verified: 2 equal bit for bit" in capsys.readouterr().out
