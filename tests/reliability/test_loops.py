"""Loops over cases in one test run every case, and name the one that fails."""

import pytest

from helpers.loops import looped


def test_every_combination_of_values_is_run_with_the_other_arguments():
    seen = []

    @looped("first", [1, 2])
    @looped(("second", "third"), [("a", "b"), ("c", "d")])
    def check(other, first, second, third):
        seen.append((other, first, second, third))

    check(other=0)
    assert seen == [(0, 1, "a", "b"), (0, 1, "c", "d"), (0, 2, "a", "b"), (0, 2, "c", "d")]


def test_a_failure_names_its_case():
    @looped("number", [3, 4, 5])
    def check(number):
        assert number != 4

    with pytest.raises(AssertionError) as caught:
        check()
    assert caught.value.__notes__ == ["in the case number=4"]


def test_pytest_passes_fixtures_and_parameters_only(pytester):
    pytester.makepyfile(
        """
        import pytest
        from helpers.loops import looped

        @looped("number", [1, 2])
        @pytest.mark.parametrize("name", ["a", "b"])
        def test_it(tmp_path, name, number):
            assert tmp_path.is_dir() and (name, number) != ("b", 2)
        """
    )
    result = pytester.runpytest("-p", "no:cacheprovider")
    result.assert_outcomes(passed=1, failed=1)
    result.stdout.fnmatch_lines(["*in the case number=2*"])


def test_a_loop_without_cases_or_of_an_unknown_argument_is_refused():
    for names, values in (("number", []), ("nothing", [1])):
        with pytest.raises(AssertionError):
            looped(names, values)(lambda number: None)


def test_cases_can_come_from_a_function_that_is_called_when_the_test_runs():
    calls = []

    def cases():
        calls.append(0)
        return range(3)

    seen = []

    @looped("number", cases)
    def check(number):
        seen.append(number)

    assert not calls
    check()
    assert seen == [0, 1, 2]
    with pytest.raises(AssertionError, match="tests nothing"):
        looped("number", tuple)(lambda number: None)()
