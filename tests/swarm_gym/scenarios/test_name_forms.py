"""Every form of scenario names that documents and stored results use is read."""

import pytest

from swarm_gym.errors import ScenarioError
from swarm_gym.scenarios import FAMILIES, expand_name, make_scenarios

# By family, one name of each form; to expand a name reads no file.
FORMS = {
    "random-fields": (
        "random-fields:train:0-3", "random-fields:validation:0-3", "random-fields:test:0-3",
        "random-fields:denser:0-3", "random-fields:larger:0-3", "random-fields:narrow:0-3",
        "random-fields:large-obstacles:0-3", "random-fields:rotated:0-3",
    ),
    "rooms": ("rooms:0-3",),
    "caves": ("caves:0",),
    "moving-ai": ("moving-ai:arena#0-9", "moving-ai:arena?start=1,2&goal=3,4"),
    "den400d": ("den400d:P1-P6",),
    "ros": ("ros:playground?start=0,0&goal=1.5,-2&inflate=0.1",),
    "function": (
        "function:rastrigin-2", "function:sum-squares-2", "function:easom-2", "function:booth-2",
        "function:bohachevsky-2", "function:rastrigin-10-shifted:0-4", "function:bbob-15-10-3",
        "function:bbob-15-10-1-15",
    ),
    "metabox-bbob": (
        "metabox-bbob:4-10", "metabox-bbob:4-10-seed:1-3", "metabox-bbob:4-30-biased", "metabox-bbob:train",
        "metabox-bbob:test", "metabox-bbob:test-30-biased-seed:7",
    ),
    "ioh": ("ioh:bbob-8-5-1", "ioh:sbox-8-5-1-3", "ioh:cec2022-1001-10-1"),
    "onemax": ("onemax:100", "onemax:100-103", "onemax:500-start:400"),
    "terrain": (
        "terrain:train:0", "terrain:train-few:0-3", "terrain:train-many:0", "terrain:validation:0",
        "terrain:validation-few:0", "terrain:validation-many:0", "terrain:test:0-55",
    ),
    "terrain-file": (
        "terrain-file:a.asc?start=0,0,150&goal=9,-9.5,120",
        "terrain-file:N46E007.hgt?start=7.1,46.2,150&goal=7.2,46.3,150&threats=t.geojson&altitude=90-200.5",
        "terrain-file:a.tif?start=0,0,150&goal=9,9,150&turn=30&climb=20&coordinates=longitude-latitude",
    ),
    "uav56": ("uav56:0-55",),
    "block": ("block:500",),
    "open": ("open:500",),
    "routes": ("routes:turtlebot3", "routes:playground-A-C"),
    "dynamic-fields": ("dynamic-fields:train:0-3", "dynamic-fields:moving:0"),
    "dynamic": (
        "dynamic:case1-block@70", "dynamic:case1-passer@70", "dynamic:case1-gate@70",
        "dynamic:case2-block@70", "dynamic:case2-gate@70", "dynamic:case3-block@70",
        "dynamic:case3-gate@70", "dynamic:rooms:0-block@50-drive@40,every=5,distance=8",
        "dynamic:open:500-block@70", "dynamic:case3-drive@40,every=5,distance=80",
    ),
}  # fmt: skip


def test_every_family_has_its_forms_here():
    assert FORMS.keys() == FAMILIES.keys()


def test_a_name_of_every_form_is_read():
    unread = [name for names in FORMS.values() for name in names if not expand_name(name)]
    assert unread == []


def test_a_range_stands_for_all_its_scenarios():
    assert len(make_scenarios("rooms:0-1")) == 2


@pytest.mark.parametrize("family", FORMS)
def test_a_family_without_a_scenario_is_refused(family):
    with pytest.raises(ScenarioError):
        expand_name(family)
