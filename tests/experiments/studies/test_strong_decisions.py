"""The figure of the sizes that policies of CMA-ES choose on four functions."""

import numpy as np
import pytest

from experiments.studies.strong import decisions, measured_gaps
from experiments.studies.strong.decisions import PLACES, SHOWN, at_places, choose, draw_decisions
from experiments.studies.strong.entrants import Entrant
from swarm_gym.rollout import Episodes


def test_an_evaluation_has_the_size_of_the_generation_that_it_belongs_to():
    sizes = np.array([300.0, 150.0, 400.0, np.nan, np.nan])
    found = at_places(sizes)
    # Evaluations 1 to 300 belong to the first generation, up to 450 to the second, and the third is the last.
    assert dict(zip(PLACES[:4], found, strict=False)) == {250: 300.0, 500: 400.0, 750: 400.0, 1000: 400.0}
    assert (found[4:] == 400.0).all()


def test_sizes_of_all_training_seeds_are_kept(tmp_path, monkeypatch):
    asked = []

    def run(controller, scenario, seeds, optimizer, **options):
        asked.append(scenario)
        sizes = np.full((len(seeds), 400), float(len(asked)) * 10.0)
        return Episodes(sizes[:, 0], sizes[:, 0], sizes[:, 0], sizes, sizes)

    monkeypatch.setattr(measured_gaps, "run_episodes", run)
    monkeypatch.setattr(decisions, "RUNS", 3)
    row = Entrant("a row", "cma-es", ("fixed:10", "fixed:20"))
    sizes = choose(row, tmp_path)
    assert asked == [f"metabox-bbob:{function}-10-biased" for function in SHOWN] * 2
    assert sizes.shape == (4, 6, len(PLACES))
    assert sizes[1, :, 0].tolist() == [20.0] * 3 + [60.0] * 3
    np.testing.assert_array_equal(choose(row, tmp_path), sizes)
    assert len(asked) == 2 * len(SHOWN)


def test_panels_have_the_median_of_each_row():
    sizes = np.broadcast_to(np.array([10.0, 20.0, 90.0])[None, :, None], (4, 3, len(PLACES)))
    figure = draw_decisions({"a": sizes, "b": 2.0 * sizes})
    assert len(figure.axes) == len(SHOWN)
    for axes in figure.axes:
        lines = {line.get_label(): line.get_ydata() for line in axes.lines}
        assert lines["a"] == pytest.approx(20.0)
        assert lines["b"] == pytest.approx(40.0)
