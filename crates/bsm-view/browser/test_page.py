"""The page in a browser: its numbers are those of the command line, and it can be used."""

import json
import re
from decimal import ROUND_HALF_EVEN, Decimal
from statistics import median

import pytest
from axe_playwright_python.sync_playwright import Axe
from conftest import MEASURED, bsm, example, settled, solved

FEED = example("feed_drive")


def key(page, output: str) -> str:
    """A number at the top of the page."""
    return page.locator(f"[data-output={output}]").inner_text().split(" ")[0]


def table_of(scene, *arguments) -> dict[str, str]:
    """Labels and numbers that `bsm solve` prints."""
    rows: dict[str, str] = {}
    for line in bsm("solve", scene, *arguments).splitlines():
        if line.startswith(" "):
            # A band has its rows below, under the same labels.
            rows.setdefault(re.split(r"\s{2,}", line.strip())[0], line.split()[-1])
    return rows


def slide(sheet, name: str, place: int) -> None:
    slider = sheet.page.locator(f"[data-name={name}] input[type=range]")
    sheet.again(lambda: slider.evaluate("(e, v) => { e.value = v; e.dispatchEvent(new Event('input', { bubbles: true })); }", place))


def fill(sheet, name: str, words: str) -> None:
    sheet.page.fill(f"#in-{name}", words)


def scene_of(page) -> dict[str, object]:
    return json.loads(page.input_value("#json"))


@pytest.mark.parametrize("name", ["feed_drive", "lin1994", "nut_double", "feed_drive_oil", "back_driving"])
def test_the_page_loads_without_errors_or_foreign_requests(serve, sheet, name):
    served, sheet = serve(example(name)), sheet()
    page = sheet.open(served.address)
    host = served.address.split("/?")[0]
    assert all(url.startswith((host, "data:")) for url in sheet.requests), sheet.requests
    # What a scene has no inputs for is asked for and refused; the browser notes that.
    refused = "the server responded with a status of 400"
    assert [error for error in sheet.errors if refused not in error] == []
    shown = solved(example(name))
    assert page.locator("#alert").is_hidden()
    assert key(page, "efficiency") == table_of(example(name))["efficiency of the balls"]
    assert shown["regime"] == page.inner_text("#regime")


def test_a_slider_changes_the_numbers_to_what_solve_says(serve, sheet):
    served, sheet = serve(FEED), sheet()
    page = sheet.open(served.address)
    before = key(page, "ball_torque_Nm")
    slide(sheet, "axial_load_N", 700)
    load = scene_of(page)["axial_load_N"]
    expected = table_of(FEED, "--set", f"axial_load_N={load}")
    assert load != 8000 and key(page, "ball_torque_Nm") != before
    assert key(page, "ball_torque_Nm") == expected["torque of the balls"]
    # All numbers of the page, label by label.
    rows = page.locator("#numbers table").first.locator("tbody tr").all()
    found = {row.locator("th").inner_text(): row.locator("td").last.inner_text() for row in rows}
    assert len(found) > 10
    assert found == {label: expected[label] for label in found}


# Moves a slider `count` times, each when the numbers of the last are shown, and `pause` later [ms]: what the numbers took,
# what the frame with the pictures took, and of that the server.
STEPS = """async ([name, count, pause]) => {
  const slider = document.querySelector(`[data-name=${name}] input[type=range]`), key = document.querySelector("#key");
  const steps = [], wait = (ms) => new Promise((then) => setTimeout(then, ms)), frame = () => new Promise((then) => requestAnimationFrame(() => setTimeout(then)));
  performance.clearResourceTimings();
  for (let i = 0; i < count; i += 1) {
    const shown = new Promise((then) => new MutationObserver((_, self) => { self.disconnect(); then(); }).observe(key, { childList: true }));
    const began = performance.now();
    slider.value = 300 + (400 * i) / count; slider.dispatchEvent(new Event("input", { bubbles: true }));
    await shown;
    const numbers = performance.now() - began;
    await frame(); await frame();
    steps.push([numbers, performance.now() - began]);
    await wait(pause);
  }
  const points = performance.getEntriesByType("resource").filter(({ name }) => name.endsWith("/point"));
  return [steps.map(([numbers]) => numbers), steps.map(([, pictures]) => pictures), points.map(({ serverTiming: [total] }) => total.duration)];
}"""


@pytest.mark.parametrize(("name", "model"), [("feed_drive", "raceway-control"), ("feed_drive", "elastic"), ("feed_drive", "traction"), ("feed_drive_oil", "traction"), ("nut_oversize", "auto")])
def test_new_numbers_come_soon(serve, sheet, name, model):
    served, sheet = serve(example(name)), sheet()
    page = sheet.open(served.address)
    if model != "auto":
        sheet.again(lambda: page.select_option("#model", model))
    numbers, pictures, server = map(median, page.evaluate(STEPS, ["axial_load_N", 15, 20]))
    MEASURED.append(f"{name}, {model}: numbers {numbers:.0f} ms after the slider, of which the server {server:.1f} ms; pictures {pictures:.0f} ms")
    # Asked are 50 ms; a machine that is shared takes twice as long. It was 350 ms while frames of the scene in space, and maps that were
    # superseded, came first.
    assert numbers < 100, numbers


def test_numbers_follow_a_slider_that_moves_on(serve, sheet):
    served, sheet = serve(FEED), sheet()
    page = sheet.open(served.address)
    page.evaluate("() => { window.updates = 0; new MutationObserver(() => { window.updates += 1; }).observe(document.querySelector('#key'), { childList: true }); }")
    drag = "async () => { const slider = document.querySelector('[data-name=axial_load_N] input[type=range]'); for (let i = 0; i < 60; i += 1) { slider.value = 300 + 5 * i; slider.dispatchEvent(new Event('input', { bubbles: true })); await new Promise((then) => setTimeout(then, 16)); } }"
    sheet.again(lambda: page.evaluate(drag))
    # A second of sliding; frames of a machine that is shared come ten times a second at least. It was 5 while what was overtaken was not shown.
    assert page.evaluate("window.updates") >= 10
    load = scene_of(page)["axial_load_N"]
    assert key(page, "ball_torque_Nm") == table_of(FEED, "--set", f"axial_load_N={load}")["torque of the balls"]


def test_a_map_of_3600_points_takes_less_than_a_second(serve, sheet):
    served, sheet = serve(FEED), sheet()
    page = sheet.open(served.address)
    # A coarse map is shown first, then the finest that is quick.
    assert int(page.get_attribute("#map", "data-points")) > 24 * 24
    host, token = served.address.split("/?token=")
    for name in ["feed_drive", "feed_drive_oil"]:
        body = {"scene": json.loads(example(name).read_text()), "settings": {"name": "traction"}, "vary": ["screw_speed_rpm=150:15000:60:log", "axial_load_N=800:80000:60:log"], "columns": ["efficiency"]}
        answer = page.request.post(host + "/sweep", headers={"X-Bsm-Token": token}, data=body)
        took = float(answer.headers["server-timing"].split("dur=")[1])
        MEASURED.append(f"{name}: a map of 60 x 60 points by traction takes the server {took:.0f} ms")
        # With a lubricant a point has films and temperatures to find, and may take longer than the server waits.
        assert name != "feed_drive" or (answer.status == 200 and took < 1000), took


def test_every_model_shows_what_it_prints(serve, sheet):
    served, sheet = serve(FEED), sheet()
    page = sheet.open(served.address)
    for model in ["closed-form", "quasi-static", "rigid", "raceway-control", "elastic", "traction"]:
        sheet.again(lambda model=model: page.select_option("#model", model))
        expected = table_of(FEED, "--model", model)
        assert key(page, "efficiency") == expected["efficiency of the balls"], model
        assert page.locator("#alert").is_hidden(), model


def test_a_bad_value_names_its_field(serve, sheet):
    served, sheet = serve(FEED), sheet()
    page = sheet.open(served.address)
    fill(sheet, "ball_diameter_mm", "-3.5")
    words = page.locator("[data-name=ball_diameter_mm] .wrong")
    words.wait_for(state="visible")
    assert words.inner_text() == "`ball_diameter_mm` = -3.5 must be finite and > 0"
    assert page.get_attribute("#in-ball_diameter_mm", "aria-invalid") == "true"
    assert page.locator(".field.bad").count() == 1
    assert page.locator("#alert").is_visible()
    sheet.again(lambda: fill(sheet, "ball_diameter_mm", "6.35"))
    assert page.locator(".field.bad").count() == 0 and page.locator("#alert").is_hidden()


def test_a_decimal_comma_is_a_point(serve, sheet):
    served, sheet = serve(FEED), sheet()
    page = sheet.open(served.address)
    sheet.again(lambda: fill(sheet, "friction_coefficient", "0,07"))
    assert scene_of(page)["friction_coefficient"] == 0.07
    sheet.again(lambda: fill(sheet, "ball_diameter_mm", "6,5"))
    assert scene_of(page)["ball_diameter_mm"] == 6.5
    # Thousands or thousandths: the field asks.
    for text in ["1,500", "1.500,5", "1 5", "x"]:
        fill(sheet, "axial_load_N", text)
        page.locator("[data-name=axial_load_N] .wrong").wait_for(state="visible")
    sheet.again(lambda: fill(sheet, "axial_load_N", "1500"))
    assert scene_of(page)["axial_load_N"] == 1500 and page.locator(".field.bad").count() == 0


def test_an_input_in_another_unit(serve, sheet):
    served, sheet = serve(FEED), sheet()
    page = sheet.open(served.address)
    page.select_option("[data-name=axial_load_N] select", "kN")
    assert page.input_value("#in-axial_load_N") == "8"
    sheet.again(lambda: fill(sheet, "axial_load_N", "10"))
    assert scene_of(page)["axial_load_N"] == 10000


def test_the_map_shows_at_the_pointer_what_solve_says(serve, sheet):
    served, sheet = serve(FEED), sheet()
    page = sheet.open(served.address)
    overlay = page.locator("#map .map svg")
    overlay.scroll_into_view_if_needed()
    box = overlay.bounding_box()
    for across, up in [(0.35, 0.3), (0.9, 0.7)]:
        page.mouse.move(box["x"] + across * box["width"], box["y"] + up * box["height"])
        readout = page.locator("#map .readout")
        x, y, value = (readout.get_attribute(f"data-{name}") for name in ("x", "y", "value"))
        expected = table_of(FEED, "--set", f"screw_speed_rpm={x}", "--set", f"axial_load_N={y}")
        assert value == expected["efficiency of the balls"], (x, y)
        assert value in readout.inner_text()


def test_the_cross_moves_by_pointer_and_keys(serve, sheet):
    served, sheet = serve(FEED), sheet()
    page = sheet.open(served.address)
    overlay = page.locator("#map .map svg")
    overlay.scroll_into_view_if_needed()
    box = overlay.bounding_box()
    sheet.again(lambda: page.mouse.click(box["x"] + 0.5 * box["width"], box["y"] + 0.6 * box["height"]))
    moved = scene_of(page)
    assert moved["screw_speed_rpm"] != 1500 and moved["axial_load_N"] != 8000
    assert float(page.input_value("#in-screw_speed_rpm")) == moved["screw_speed_rpm"]
    page.locator("#map .cross").focus()
    sheet.again(lambda: page.keyboard.press("ArrowRight"))
    assert scene_of(page)["screw_speed_rpm"] > moved["screw_speed_rpm"]


def test_a_saved_scene_solves_to_the_same_numbers(serve, sheet, tmp_path):
    saved = tmp_path / "saved.json"
    served, sheet = serve(FEED, "-o", saved), sheet()
    page = sheet.open(served.address)
    slide(sheet, "lead_mm", 400)
    page.click("#save")
    page.locator("#save", has_text="Saved").wait_for()
    assert json.loads(saved.read_text()) == scene_of(page)
    assert table_of(saved)["efficiency of the balls"] == key(page, "efficiency")


def test_without_save_there_is_no_button(serve, sheet):
    page = sheet().open(serve(FEED).address)
    assert page.locator("#save").is_hidden()


def test_a_file_can_be_loaded(serve, sheet):
    served, sheet = serve(FEED), sheet()
    page = sheet.open(served.address)
    sheet.again(lambda: page.set_input_files("#file", example("lin1994")))
    assert key(page, "efficiency") == table_of(example("lin1994"))["efficiency of the balls"]
    sheet.again(lambda: page.click("#reset"))
    assert key(page, "efficiency") == table_of(FEED)["efficiency of the balls"]


@pytest.mark.parametrize(("name", "width", "scheme"), [("feed_drive", 1300, "light"), ("nut_double", 1300, "dark"), ("feed_drive_oil", 390, "light"), ("lin1994", 390, "dark")])
def test_axe_finds_nothing(serve, sheet, name, width, scheme):
    page = sheet(width, scheme).open(serve(example(name)).address)
    for fold in page.locator("details").all():
        fold.evaluate("(fold) => { fold.open = true; }")
    found = Axe().run(page).response["violations"]
    assert [(v["id"], [n["html"][:120] for n in v["nodes"]][:3]) for v in found] == []
    # Nothing is wider than the screen.
    assert page.evaluate("document.documentElement.scrollWidth") <= width


def test_one_file_works_without_a_server(sheet, tmp_path):
    out = tmp_path / "page.html"
    bsm("view", FEED, "-o", out)
    sheet = sheet()
    page = sheet.open(out.as_uri())
    assert sheet.errors == []
    assert all(url.startswith(("file:", "data:")) for url in sheet.requests), sheet.requests
    assert key(page, "efficiency") == table_of(FEED)["efficiency of the balls"]
    slide(sheet, "axial_load_N", 8)
    load = scene_of(page)["axial_load_N"]
    assert load > 8000
    # The stops are numbers of the solver to the digits that are shown.
    assert key(page, "ball_torque_Nm") == table_of(FEED, "--set", f"axial_load_N={load!r}")["torque of the balls"]
    assert page.locator("#ellipses canvas").count() == 2
    assert out.stat().st_size < 4_000_000


def test_two_tabs_do_not_disturb_each_other(serve, sheet):
    served = serve(FEED)
    one, other = sheet(), sheet()
    one.open(served.address), other.open(served.address)
    slide(one, "axial_load_N", 800)
    slide(other, "axial_load_N", 200)
    for tab in (one, other):
        load = scene_of(tab.page)["axial_load_N"]
        assert key(tab.page, "ball_torque_Nm") == table_of(FEED, "--set", f"axial_load_N={load}")["torque of the balls"]


def test_another_page_cannot_ask(serve, sheet):
    served, other = serve(FEED), serve(FEED)
    page = sheet().open(other.address)
    token = served.address.split("token=")[1]
    ask = "async ([url, token]) => { try { const r = await fetch(url, { method: 'POST', headers: { 'X-Bsm-Token': token }, body: '{}' }); return r.status; } catch (e) { return 'refused'; } }"
    assert page.evaluate(ask, [served.address.split("/?")[0] + "/schema", token]) == "refused"
    answer = page.request.post(served.address.split("/?")[0] + "/schema", headers={"X-Bsm-Token": token, "Origin": "http://localhost:1"}, data="{}")
    assert answer.status == 403
    assert page.request.get(served.address[:-1]).status == 403


def test_a_server_that_has_gone_is_told(serve, sheet):
    served, sheet = serve(FEED), sheet()
    page = sheet.open(served.address)
    served.end()
    slider = page.locator("[data-name=axial_load_N] input[type=range]")
    slider.evaluate("(e) => { e.value = 100; e.dispatchEvent(new Event('input', { bubbles: true })); }")
    page.locator("#alert", has_text="The server has ended").wait_for()
    # The page is not frozen: its fields and folds still work.
    page.locator(".json summary").click()
    assert page.locator("#json").is_visible()


def test_without_webgl_there_is_a_drawing(serve, sheet):
    sheet = sheet()
    sheet.page.add_init_script(
        "const get = HTMLCanvasElement.prototype.getContext; HTMLCanvasElement.prototype.getContext = function (kind, ...rest) { return kind.startsWith('webgl') ? null : get.call(this, kind, ...rest); };"
    )
    page = sheet.open(serve(FEED).address)
    assert page.locator("#space svg circle").count() > 10
    assert key(page, "efficiency") == table_of(FEED)["efficiency of the balls"]


def five_digits(value: float) -> str:
    """As `bsm` prints numbers: `bsm_report::number`."""
    if value == 0:
        return "0"
    exact = Decimal(value)
    if not 1e-4 <= abs(value) < 1e6:
        digits, power = f"{value:.4e}".split("e")
        return f"{digits}e{int(power)}"
    decimals = max(0, 4 - exact.adjusted())
    return str(exact.quantize(Decimal(1).scaleb(-decimals), rounding=ROUND_HALF_EVEN))


def test_numbers_are_written_as_the_program_writes_them(serve, sheet):
    page = sheet().open(serve(FEED).address)
    # Some are ties between two roundings: 0.5, 128.125, 2.00005 is none.
    values = [0.0, 1.0, -3.25, 0.8601069, 123456.7, 1.234567e6, -4.5e-5, 0.000123456, 128.125, -128.375, 2.00005, 100000.5, 99999.5, 999999.7, 0.1, 1 / 3, 8.5e-9, 6.02e23]
    values += [1.0625 * 2.0**k for k in range(-12, 20)]
    found = page.evaluate("async (values) => { const { number } = await import('bsm/draw'); return values.map(number); }", values)
    assert found == [five_digits(value) for value in values]
