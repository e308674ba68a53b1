"""Files of the laboratory: found where it can be imported, and named in errors where it cannot."""

import json

import pytest

from swarm_gym.controllers import make_controller, packaged
from swarm_gym.controllers.learned.policy_file import POLICIES, PolicyFileError, load_policy
from swarm_gym.controllers.names import ControllerName
from swarm_gym.controllers.open_loop import OPEN_LOOPS, OpenLoopFileError
from swarm_gym.controllers.tuned import TUNED, TunedFileError
from swarm_gym.training.presets import PRESETS, PresetError, load_preset

FILES = {files.kind: files for files in (OPEN_LOOPS, POLICIES, PRESETS, TUNED)}
BELONGS = "belongs to the laboratory"


def in_package(files):
    """Return the names of the files in the package alone."""
    found = (path.relative_to(files.folder).as_posix() for path in files.folder.rglob(f"*{files.suffix}"))
    return [name.removesuffix(files.suffix) for name in found]


@pytest.fixture
def without_laboratory(monkeypatch, tmp_path):
    monkeypatch.setattr(packaged, "LABORATORY", tmp_path)


@pytest.mark.parametrize("kind", FILES)
def test_the_index_has_the_study_of_every_recipe(kind):
    found = {}
    for folder in packaged.study_folders(kind):
        for path in folder.rglob(f"*{FILES[kind].suffix}"):
            name = path.relative_to(folder).as_posix().removesuffix(path.suffix)
            found[ControllerName.of("tuned", name).recipe] = folder.parents[1].name
    assert found, "no study has files of this kind"
    assert json.loads(packaged.INDEX.read_text())[kind] == found, f"correct {packaged.INDEX}"


@pytest.mark.parametrize("kind", FILES)
def test_no_name_is_in_the_package_and_in_a_study(kind):
    names = FILES[kind].names()
    assert len(names) == len(set(names)) > len(in_package(FILES[kind]))


def test_everything_in_the_package_works_without_the_laboratory(without_laboratory):
    for family, files in (("open-loop", OPEN_LOOPS), ("learned", POLICIES), ("tuned", TUNED)):
        assert files.names() == sorted(in_package(files))
        for name in files.names():
            make_controller(f"{family}:{name}")
    for name in PRESETS.names():
        config = load_preset(name)
        for controller in (config.base, config.reference, config.algorithm.warm_start):
            if controller != "none":
                make_controller(controller)


@pytest.mark.parametrize(
    ("make", "error", "where"),
    [
        (lambda: make_controller("learned:ablation-all/0"), PolicyFileError, "learned/data/policies"),
        (lambda: make_controller("learned:three-cases/7@1"), PolicyFileError, "learned/data/policies"),
        (lambda: make_controller("open-loop:three-cases-long/0@1"), OpenLoopFileError, "learned/data/open_"),
        (lambda: make_controller("tuned:three-cases-restart/0"), TunedFileError, "newcomers/data/tuned"),
        (lambda: load_preset("ablation-all"), PresetError, "learned/data/presets"),
    ],
)
def test_a_name_of_the_laboratory_says_where_it_lives(without_laboratory, make, error, where):
    with pytest.raises(error, match=f"{BELONGS}.*a file in experiments/studies/{where}"):
        make()


def test_a_name_that_nobody_has_does_not_send_anybody_to_the_laboratory(without_laboratory):
    for name in ("learned:nowhere", "open-loop:nowhere", "tuned:nowhere", "distilled:nowhere"):
        with pytest.raises(ValueError, match="nowhere") as refused:
            make_controller(name)
        assert BELONGS not in str(refused.value)


def test_with_the_laboratory_an_unknown_seed_is_no_matter_of_where_it_lives():
    with pytest.raises(PolicyFileError) as refused:
        make_controller("learned:ablation-all/99")
    assert BELONGS not in str(refused.value)


def test_somebody_elses_package_of_that_name_is_no_laboratory(tmp_path, monkeypatch):
    (tmp_path / "experiments").mkdir()
    monkeypatch.setattr(packaged, "LABORATORY", tmp_path / "experiments")
    with pytest.raises(PolicyFileError, match=BELONGS):
        make_controller("learned:ablation-all/0")


def test_a_policy_of_the_laboratory_is_the_one_that_its_manifest_says():
    path = POLICIES.find("ablation-all/0")
    assert path.is_relative_to(packaged.study_folders("policies")[0].parents[2])
    assert make_controller("learned:ablation-all/0").manifest == load_policy(path)[1]
