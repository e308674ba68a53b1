"""A plugin of pytest that hides no skip: it lists every reason, and refuses what could be installed.

The closing lines of a run name every reason of a skip, how many tests it concerns, and their files. With the
environment variable `REQUIRE_ALL=1`, a skip is a failure that says what is missing, unless `ALLOWED` has its
reason. `.ci/run` sets the variable.
"""

import os
import re
from collections import Counter, defaultdict

import pytest

REQUIRE_ALL = "REQUIRE_ALL"

# Reasons that are allowed everywhere, as regular expressions that match from the beginning, and why they are.
# A reason belongs here only if `make install` and a folder with the small public maps cannot remove it.
ALLOWED = {
    "there is no GPU": "it is hardware; `make test-slow` runs these tests in a simulator",
    r"this machine has \d+ thread": "it is hardware",
    "needs an x86-64 processor": "it is hardware",
    "needs Linux": "the system is another one; docs/reliability.md says what is untried there",
    "needs POSIX": "the system is Windows; docs/reliability.md says what is untried there",
    "needs OMPL, which has no wheel": "OMPL has wheels for x86-64 and Python up to 3.13 only",
    "NUMBA_DISABLE_JIT=1": "it is a mode of `make test-slow`, in which nothing is compiled",
    "NUMBA_ENABLE_CUDASIM=1": "it is a mode of `make test-slow`, in which a GPU is simulated",
    "NVIDIA's compiler is not installed": "the extra `gpu` brings it, which is for machines with a GPU",
    "needs (dacbench, of )?the extra `dacbench`": "`make install` leaves DACBench out",
    "needs the extra `ray-tune`": "`make install` leaves the libraries of Ray Tune out",
    r"needs ray\[rllib\]": "RLlib needs an environment of its own, which docs/recipes.md describes",
    r"needs (Berlin_1_256|Paris_1_256|warehouse-20-40-10-2-2|willow-2010-02-18-0\.10)\.": (
        "the map is large; `python -m swarm_gym.scenarios.download` brings it"
    ),
}


def is_allowed(reason):
    """Return whether a skip for this reason stays a skip where everything is required."""
    return any(re.match(allowed, reason) for allowed in ALLOWED)


def is_required():
    """Return whether whatever is missing makes tests fail."""
    return os.environ.get(REQUIRE_ALL, "") not in ("", "0")


@pytest.hookimpl(wrapper=True, tryfirst=True)
def pytest_runtest_makereport():
    """Make a skip of a test a failure if its reason is not allowed."""
    return _checked((yield))


@pytest.hookimpl(wrapper=True, tryfirst=True)
def pytest_make_collect_report():
    """Make a skip of a whole file an error if its reason is not allowed."""
    return _checked((yield))


def pytest_terminal_summary(terminalreporter):
    """List the reasons of all skips, how many tests or files each concerns, and where they are."""
    stats = terminalreporter.stats
    refused = [one for kind in ("failed", "error") for one in stats.get(kind, ()) if hasattr(one, "refused")]
    _list(terminalreporter, "skips, by reason", {one: reason_of(one) for one in stats.get("skipped", ())})
    _list(terminalreporter, f"refused by {REQUIRE_ALL}, by reason", {one: one.refused for one in refused})


def _list(terminalreporter, title, reasons):
    # Each worker of pytest-xdist reports a file that is skipped as a whole.
    unique = {(one.nodeid, one.when): reason for one, reason in reasons.items()}
    found = defaultdict(Counter)
    for (node, _), reason in unique.items():
        found[reason][node.partition("::")[0]] += 1
    if not found:
        return
    terminalreporter.write_sep("=", f"{len(unique)} {title}")
    for reason, files in sorted(found.items(), key=lambda one: (-one[1].total(), one[0])):
        terminalreporter.write_line(f"{files.total()} x {reason}")
        for file, number in sorted(files.items()):
            terminalreporter.write_line(f"    {file}: {number}")


def reason_of(report):
    """Return the reason of a skip in one line."""
    reason = report.longrepr[2] if isinstance(report.longrepr, tuple | list) else str(report.longrepr)
    return " ".join(reason.removeprefix("Skipped: ").split())


def _checked(report):
    if report.skipped and not hasattr(report, "wasxfail") and is_required():
        reason = reason_of(report)
        if not is_allowed(reason):
            report.outcome = "failed"
            report.refused = reason  # reports of pytest-xdist keep it
            report.longrepr = (
                f"{REQUIRE_ALL} is set, so this skip is a failure: {reason}\n"
                f"Install it, or unset {REQUIRE_ALL}. tests/helpers/skips.py lists the allowed reasons."
            )
    return report
