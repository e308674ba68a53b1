"""The end of commands: messages and exit statuses."""

import signal
import threading
import time

import pytest

from swarm_gym.command import LONGEST, NumberParser, command, point


class WrongError(RuntimeError):
    """An exception that a command is told to expect."""


def said(error, **options):
    """Return what is printed; as an argument of `SystemExit` it makes the exit status 1."""
    with pytest.raises(SystemExit) as caught, command(WrongError, **options):
        raise error
    return caught.value.code


def test_what_is_expected_is_said_in_a_line():
    assert said(WrongError("so and so"), kept="more") == "error: so and so"
    assert said(ValueError("this")) == "error: this"


def test_after_a_fault_of_the_system_it_is_said_what_is_kept():
    fault = OSError(28, "No space left on device", "/there")
    assert said(fault, kept="all is kept") == f"error: {fault}; all is kept"


@pytest.mark.parametrize("length", [LONGEST - 10, LONGEST, LONGEST + 1, 100 * LONGEST])
def test_a_message_has_at_most_five_thousand_characters_and_keeps_its_ends(length):
    message = "begin " + (length - 10) * "x" + " end"
    found = said(ValueError(message)).removeprefix("error: ")
    assert len(found) <= LONGEST == 5_000
    assert found.startswith("begin x")
    assert found.endswith("x end")
    assert (found == message) == (length <= LONGEST)


def test_a_mistake_is_not_hidden():
    with pytest.raises(KeyError), command(WrongError):
        raise KeyError(1)


@pytest.mark.parametrize(("sent", "status"), [(signal.SIGINT, 130), (signal.SIGTERM, 143)])
def test_a_signal_ends_a_command_after_it_has_cleaned_up(sent, status, capsys):
    cleaned = []

    def work():
        try:
            signal.raise_signal(sent)  # on Windows os.kill would end this process
            time.sleep(10)
            pytest.fail("goes on")
        except Exception:  # a handler of the program's own does not stop it
            pytest.fail("stopped")
        finally:
            cleaned.append(True)

    with pytest.raises(SystemExit) as caught, command(kept="all is kept"):
        work()
    assert caught.value.code == status
    assert capsys.readouterr().err.endswith("; all is kept\n")
    assert cleaned


def test_the_handler_from_before_is_there_again():
    before = signal.getsignal(signal.SIGTERM)
    with command():
        assert signal.getsignal(signal.SIGTERM) is not before
    assert signal.getsignal(signal.SIGTERM) is before


def test_a_command_runs_in_another_thread_too():
    ended = []

    def run():
        with command():
            ended.append(True)

    thread = threading.Thread(target=run)
    thread.start()
    thread.join()
    assert ended


def test_arguments_may_begin_with_a_minus_sign():
    parser = NumberParser()
    parser.add_argument("--start", type=point)
    parser.add_argument("--shift", type=float, nargs="*")
    parser.add_argument("-v", action="store_true")
    given = parser.parse_args(["--start", "-0.5,0.5", "--shift", "-1e-3", "-.5", "-2", "-v"])
    assert (given.start, given.shift, given.v) == ((-0.5, 0.5), [-1e-3, -0.5, -2.0], True)
    assert parser.parse_args(["--start=-.5,-1e3"]).start == (-0.5, -1000.0)


@pytest.mark.parametrize("text", ["-1", "-1,a", "1,2,3", ""])
def test_a_point_is_two_numbers(text, capsys):
    parser = NumberParser()
    parser.add_argument("--start", type=point)
    with pytest.raises(SystemExit):
        parser.parse_args(["--start", text])
    assert f"argument --start: expected two numbers x,y, got {text!r}" in capsys.readouterr().err
