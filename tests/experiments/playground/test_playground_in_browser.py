"""The playground as its readers have it: in Chromium, from disk, by mouse and by keyboard."""

import re
from pathlib import Path

import pytest

from experiments.playground.exported import export
from experiments.playground.playground_page import playground_page
from helpers.browsers import PHONE, chromium, lightness, opener, wider_than
from helpers.slow import slow_but
from swarm_gym.env import SwarmEnv
from swarm_gym.reference import known_optimum

axe = pytest.importorskip("axe_playwright_python.sync_playwright", reason="needs axe, of the group dev")

DOCUMENT = Path(__file__).parents[3] / "docs" / "playground.md"
WIDE = {"width": 1400, "height": 900}


@pytest.fixture(scope="module")
def browser():
    with chromium() as launched:
        yield launched


@pytest.fixture(scope="module")
def file(tmp_path_factory):
    path = tmp_path_factory.mktemp("playground") / "play.html"
    path.write_text(playground_page(), encoding="utf-8")
    return path


@pytest.fixture
def open_page(browser):
    with opener(browser) as opened:
        yield opened


@pytest.fixture
def page(file, open_page):
    page = open_page(file)
    yield page
    assert page.complaints == []


def button(page, name):
    return page.get_by_role("button", name=name, exact=True)


def slider(page, name):
    return page.get_by_role("slider", name=name, exact=True)


def wait_for(page, iteration):
    page.wait_for_function(f"document.querySelector('.playground').dataset.iteration === '{iteration}'")


def step(page, times=1):
    before = int(page.locator(".playground").get_attribute("data-iteration"))
    for _ in range(times):
        button(page, "Step").click()
    wait_for(page, before + times)


def states(page):
    return page.locator(".playground .facts").all_text_contents()


def told(page):
    return page.get_by_role("status").text_content()


def drawn(page, pane, layer):
    """Number of paths of a kind in a pane."""
    d = page.locator(".playground .swarm").nth(pane).locator(f".field > path.{layer}").get_attribute("d")
    return d.count("M")


def state_of(env):
    """The text below the map for the only swarm of an environment."""
    simulation = env.simulation
    swarms, history = simulation.swarms, simulation.history[0, simulation.iteration[0]]
    size = int(swarms.size[0])
    feasible = int((swarms.collision[0, :size] <= 1e-9).sum())
    gap = swarms.best_fitness[0] / known_optimum(simulation.problems[0]) - 1.0
    collides = "" if swarms.best_collision[0] <= 1e-9 else ", by a path that collides"
    return (
        f"{size} members, {feasible} feasible; φ {history[2]:.2f}; E(P) {history[0]:.1f}. "
        f"Gap {100 * gap:.2f} %{collides}, after {int(swarms.evaluations[0]):,} evaluations."
    )


def test_the_page_opens_from_disk_without_requests(page, file):
    assert [url for url in page.requests if not url.startswith("data:")] == [file.as_uri()]
    assert page.title() == "swarm_gym: playground"
    assert told(page).startswith("Iteration 0 of 100. Smallest gap now: ")


def test_a_reader_steers_as_an_environment_is_steered_by_actions(page):
    size, degree = slider(page, "Population size"), slider(page, "Repair degree φ")
    page.get_by_label("Map").select_option("case2")
    page.get_by_label("Seed").fill("7")
    size.fill("30")
    button(page, "Reset").click()
    env = SwarmEnv(scenario="case2", initial_population_size=30)
    env.reset(seed=7)
    assert states(page)[0] == state_of(env)
    for members, phi in ((40, 0.0), (12, 0.35), (20, 1.0)):
        size.fill(str(members))
        degree.fill(str(phi))
        step(page)
        env.step([float(members), phi])
        assert states(page)[0] == state_of(env)
        assert drawn(page, 0, "feasible") + drawn(page, 0, "colliding") == members
        assert drawn(page, 0, "best") == 1
    assert page.locator(".playground [data-part=count]").text_content() == "Iteration 3 of 100"


def test_the_code_of_the_document_finds_what_the_page_shows(page, capsys):
    [code] = re.findall(
        r"^```python\n(.*?)^```$", DOCUMENT.read_text(encoding="utf-8"), re.MULTILINE | re.DOTALL
    )
    exec(compile(code, DOCUMENT.name, "exec"), names := {})
    fitness, evaluations = capsys.readouterr().out.split()
    page.get_by_label("Map").select_option("case2")
    page.get_by_label("Seed").fill("7")
    slider(page, "Population size").fill("30")
    button(page, "Reset").click()
    slider(page, "Population size").fill("40")
    slider(page, "Repair degree φ").fill("0.35")
    step(page)
    assert states(page)[0] == state_of(names["env"])
    assert f"after {int(evaluations):,} evaluations" in states(page)[0]
    found = page.evaluate("document.querySelector('.playground').playground.entrants[0].swarm.best.fitness")
    assert found == pytest.approx(float(fitness), abs=1e-9)


def test_sliders_and_buttons_are_used_by_keyboard(page):
    size, degree = slider(page, "Population size"), slider(page, "Repair degree φ")
    for one, key, value in ((size, "ArrowRight", "81"), (size, "Home", "2"), (degree, "End", "1")):
        one.press(key)
        assert one.input_value() == value
        assert one.evaluate("slider => slider.nextElementSibling.textContent") == value
    button(page, "Step").press("Enter")
    wait_for(page, 1)
    assert states(page)[0].startswith("2 members, ")
    reached = set()
    page.get_by_label("Map").focus()
    for _ in range(6):
        reached.add(page.evaluate("document.activeElement.dataset.part"))
        page.keyboard.press("Tab")
    assert reached == {"case", "seed", "step", "run", "reset", "size"}
    assert page.evaluate("document.activeElement.dataset.part") == "degree"


def test_reset_and_another_map_or_seed_begin_anew(page):
    first = states(page)
    step(page, 2)
    assert states(page) != first
    button(page, "Reset").click()
    wait_for(page, 0)
    assert states(page) == first
    page.get_by_label("Seed").fill("12345")
    page.get_by_label("Seed").press("Tab")
    other = states(page)
    assert all(one != before for one, before in zip(other, first, strict=True))
    page.get_by_label("Map").select_option("case3")
    assert all(one != before for one, before in zip(states(page), other, strict=True))
    assert page.locator(".swarm .obstacle").count() == 3 * 15


@pytest.mark.parametrize("text", slow_but([""], ["", "-1", "1.5", "seven", str(2**53)]))
def test_a_faulty_seed_is_named_and_changes_nothing(page, text):
    step(page)
    before = states(page)
    page.get_by_label("Seed").fill(text)
    button(page, "Reset").click()
    message = f"The seed must be a whole number from 0 to {2**53 - 1}, got “{text}”."
    assert page.get_by_role("alert").text_content() == message
    assert page.get_by_label("Seed").get_attribute("aria-invalid") == "true"
    assert states(page) == before
    page.get_by_label("Seed").fill("3")
    button(page, "Reset").click()
    assert page.get_by_role("alert").text_content() == ""
    wait_for(page, 0)


@pytest.mark.slow
def test_a_run_goes_on_until_it_is_paused(file, open_page):
    page = open_page(file, reduced_motion="no-preference")
    slider(page, "Population size").fill("8")
    page.locator("[data-part=run]").click()
    assert page.locator("[data-part=run]").text_content() == "Pause"
    page.wait_for_function("Number(document.querySelector('.playground').dataset.iteration) >= 3")
    page.locator("[data-part=run]").click()
    assert page.locator("[data-part=run]").text_content() == "Run"
    page.evaluate("document.querySelector('.playground').playground.work")
    paused = page.locator(".playground").get_attribute("data-iteration")
    page.wait_for_timeout(400)
    assert page.locator(".playground").get_attribute("data-iteration") == paused
    assert told(page).startswith(f"Iteration {paused} of 100. ")
    assert page.complaints == []


@pytest.mark.slow
def test_a_reset_stops_the_iteration_under_way(page):
    slider(page, "Population size").fill("200")
    page.evaluate("""() => {
      const [part] = [(name) => document.querySelector(`[data-part=${name}]`)];
      part("step").click();
      part("reset").click();
    }""")
    page.evaluate("document.querySelector('.playground').playground.work")
    wait_for(page, 0)
    assert states(page)[0].startswith("200 members, ")
    step(page)
    assert "Iteration 1 of 100" in told(page)


def test_an_episode_ends_with_its_last_iteration(tmp_path, open_page, monkeypatch):
    monkeypatch.setattr(
        "experiments.playground.playground_page.export", lambda s, o: export(s, {"iterations": 2})
    )
    path = tmp_path / "short.html"
    path.write_text(playground_page(["case1"]), encoding="utf-8")
    page = open_page(path)
    step(page, 2)
    assert button(page, "Step").is_disabled()
    assert button(page, "Run").is_disabled()
    button(page, "Reset").click()
    assert button(page, "Step").is_enabled()
    assert page.complaints == []


def gaps_told(sentence):
    return {
        name: float(gap) for name, gap in re.findall(r"(you|SPSFA-TIP|learned policy) ([\d.]+) %", sentence)
    }


def test_the_text_says_who_is_ahead_in_numbers(page):
    slider(page, "Repair degree φ").fill("0.1")
    step(page, 5)
    sentences = re.findall(r"Smallest gap (.*?): ([^(]*) \((.*?)\)\.", told(page))
    assert sentences[0][0] == "now"
    below = [float(re.search(r"Gap ([\d.]+) %", state)[1]) for state in states(page)]
    assert list(gaps_told(sentences[0][2]).values()) == below
    for _, leader, each in sentences:
        gaps = gaps_told(each)
        assert gaps[leader] == min(gaps.values())
    spent = [int(n.replace(",", "")) for n in re.findall(r"after ([\d,]+) evaluations", sentences[0][2])]
    assert sentences[1][0] == f"within {min(spent):,} evaluations"


def test_curves_have_a_point_for_each_iteration(page):
    step(page, 4)
    for figure in page.locator(".curves figure").all():
        assert [curve.get_attribute("d").count("L") for curve in figure.locator(".curve").all()] == [4, 4, 4]


@pytest.mark.parametrize(
    ("viewport", "color_scheme"),
    slow_but([(PHONE, "dark")], [(size, colours) for size in (PHONE, WIDE) for colours in ("light", "dark")]),
)
def test_nothing_is_wider_than_the_screen_and_axe_finds_nothing(file, open_page, viewport, color_scheme):
    page = open_page(file, viewport, color_scheme)
    step(page, 2)
    assert page.evaluate("document.documentElement.scrollWidth") == viewport["width"]
    assert wider_than(page, viewport["width"]) == []
    assert (lightness(page) > 128) == (color_scheme == "light")
    found = axe.Axe().run(page).response["violations"]
    assert [(v["id"], v["impact"], [n["html"][:90] for n in v["nodes"]]) for v in found] == []
    assert page.complaints == []


@pytest.mark.parametrize(
    ("motion", "shown", "pictures"),
    slow_but(
        [("reduce", "Infinity", False)],
        [("reduce", "Infinity", False), ("reduce", "-Infinity", True), ("no-preference", "Infinity", True)],
    ),
    ids=["calm, lately shown", "calm, long ago", "lively"],
)
def test_pictures_are_rare_for_readers_who_ask_for_less_motion(file, open_page, motion, shown, pictures):
    page = open_page(file, reduced_motion=motion)
    slider(page, "Population size").fill("5")
    # Whenever a picture is drawn, the time of the last one is set: long ago, or not long enough.
    page.evaluate(f"""() => {{
      const {{ playground }} = document.querySelector(".playground");
      window.pictures = 0;
      const show = playground.show;
      playground.show = function () {{ show.call(this); window.pictures++; this.shown = {shown}; }};
      playground.shown = {shown};
    }}""")
    page.locator("[data-part=run]").click()
    page.wait_for_function(
        "document.querySelector('.playground').playground.entrants[2].swarm.iteration >= 4"
    )
    assert (page.evaluate("window.pictures") >= 3) == pictures
    page.locator("[data-part=run]").click()
    assert page.evaluate("window.pictures") >= 1  # a pause shows where the run is
