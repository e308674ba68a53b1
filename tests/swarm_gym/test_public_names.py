"""The public names of the project are those of the snapshot `tests/public_names.txt`."""

import public_names


def test_no_public_name_was_added_or_removed():
    expected = public_names.without_missing_libraries(public_names.stored())
    changes = public_names.differences(expected, public_names.current())
    assert not changes, "\n".join(
        ["public names changed; if you mean it, run `python tests/public_names.py --write`:", *changes]
    )


def test_a_name_that_comes_or_goes_is_a_difference():
    old = {"rewards": ["final", "progress"], "suites": ["paper"]}
    new = {"rewards": ["progress", "speed"], "empty": []}
    assert public_names.differences(old, new) == [
        "+ empty", "- rewards: final", "+ rewards: speed", "- suites: paper",
    ]  # fmt: skip
    assert public_names.differences(old, old) == []


def test_policies_of_one_recipe_are_one_name_with_all_seeds():
    names = ["cases/0@1", "cases/10@1", "cases/2@1", "cases/0", "cases"]
    assert [*public_names._by_recipe(names)] == ["cases/*@1 0 2 10", "cases/* 0", "cases"]
