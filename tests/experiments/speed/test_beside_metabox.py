"""The published cost beside MetaBox's code; the code itself is installed by `make docs-terrain` only."""

import pytest

from experiments.speed import beside_metabox
from experiments.terrain import TerrainConfig, write


@pytest.fixture
def without_metabox(monkeypatch):
    monkeypatch.setattr(beside_metabox, "find_spec", lambda name: None)
    beside_metabox._module.cache_clear()
    yield
    beside_metabox._module.cache_clear()


@pytest.mark.usefixtures("without_metabox")
def test_a_missing_package_is_named_with_the_command_that_brings_it(tmp_path):
    with pytest.raises(ValueError, match=r"^metaevobox is not installed: pip install --no-deps metaevobox$"):
        write(TerrainConfig(tmp_path, beside_metabox=True))
    assert not [*tmp_path.iterdir()]


def test_costs_that_differ_are_refused():
    with pytest.raises(ValueError, match=r"differ from those of metaevobox by 1\.0e-03"):
        beside_metabox._require_same([[1.0]], lambda _: 1.001, lambda _: 1.0)
    beside_metabox._require_same([[1.0]], lambda _: 1.0, lambda _: 1.0)
