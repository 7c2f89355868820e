"""Test the page in a browser: its numbers match the command line, and its controls work."""

import csv
import io
import json
import os
import re
import subprocess
from decimal import ROUND_HALF_EVEN, Decimal
from pathlib import Path
from statistics import median
from xml.etree import ElementTree

import pytest
from axe_playwright_python.sync_playwright import Axe
from conftest import BSM, MEASURED, ROOT, bsm, example, settled, solved

FEED = example("feed_drive")

# Folder for pictures of saved pages. By default, no pictures are written.
SCREENSHOTS = os.environ.get("SCREENSHOTS")


def key(page, output: str) -> str:
    """Return a number at the top of the page."""
    return page.locator(f"[data-output={output}]").inner_text().split(" ")[0]


def table_of(case, *arguments) -> dict[str, str]:
    """Return the labels and numbers that `bsm solve` prints."""
    rows: dict[str, str] = {}
    for line in bsm("solve", case, *arguments).splitlines():
        if line.startswith(" "):
            # Rows of the uncertainty band repeat labels of earlier rows, so the first row with a
            # label is used.
            rows.setdefault(re.split(r"\s{2,}", line.strip())[0], line.split()[-1])
    return rows


def slide(sheet, name: str, place: int) -> None:
    sheet.again(lambda: slide_to(sheet.page, name, place))


def fill(sheet, name: str, words: str) -> None:
    sheet.page.fill(f"#in-{name}", words)


def case_of(page) -> dict[str, object]:
    return json.loads(page.input_value("#json"))


@pytest.mark.parametrize("name", ["feed_drive", "lin1994", "nut_double", "feed_drive_oil", "back_driving"])
def test_the_page_loads_without_errors_or_foreign_requests(serve, sheet, name):
    served, sheet = serve(example(name)), sheet()
    page = sheet.open(served.address)
    host = served.address.split("/?")[0]
    assert all(url.startswith((host, "data:")) for url in sheet.requests), sheet.requests
    # The server rejects requests for which the case lacks inputs, and the browser logs each rejection.
    refused = "the server responded with a status of 400"
    assert [error for error in sheet.errors if refused not in error] == []
    shown = solved(example(name))
    assert page.locator("#alert").is_hidden()
    assert key(page, "efficiency") == table_of(example(name))["efficiency of the balls"]
    assert shown["regime"] == page.inner_text("#regime")


def test_numbers_after_a_slider_move_match_command_solve(serve, sheet):
    served, sheet = serve(FEED), sheet()
    page = sheet.open(served.address)
    before = key(page, "ball_torque_Nm")
    slide(sheet, "axial_load_N", 700)
    load = case_of(page)["axial_load_N"]
    expected = table_of(FEED, "--set", f"axial_load_N={load}")
    assert load != 8000 and key(page, "ball_torque_Nm") != before
    assert key(page, "ball_torque_Nm") == expected["torque of the balls"]
    # All numbers of the page match the numbers of the command, row by row.
    rows = page.locator("#numbers table").first.locator("tbody tr").all()
    found = {row.locator("th").inner_text(): row.locator("td").last.inner_text() for row in rows}
    assert len(found) > 10
    assert found == {label: expected[label] for label in found}


# Script that moves a slider `count` times, each time `pause` [ms] after the previous numbers are shown.
# The script returns the times [ms] until the numbers and the pictures are shown, and the times that
# the server takes.
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
def test_numbers_appear_within_100_ms_of_a_slider_move(serve, sheet, name, model):
    served, sheet = serve(example(name)), sheet()
    page = sheet.open(served.address)
    if model != "auto":
        sheet.again(lambda: page.select_option("#model", model))
    numbers, pictures, server = map(median, page.evaluate(STEPS, ["axial_load_N", 15, 20]))
    MEASURED.append(f"{name}, {model}: numbers appear {numbers:.0f} ms after a slider move ({server:.1f} ms in the server), pictures after {pictures:.0f} ms")
    # The required time is 50 ms, but a shared machine may take twice as long.
    # Regression test: the numbers appeared only after 350 ms when 3D frames and outdated maps had
    # priority.
    assert numbers < 100, numbers


def test_numbers_are_updated_at_least_ten_times_per_second_while_a_slider_moves(serve, sheet):
    served, sheet = serve(FEED), sheet()
    page = sheet.open(served.address)
    page.evaluate("() => { window.updates = 0; new MutationObserver(() => { window.updates += 1; }).observe(document.querySelector('#key'), { childList: true }); }")
    drag = "async () => { const slider = document.querySelector('[data-name=axial_load_N] input[type=range]'); for (let i = 0; i < 60; i += 1) { slider.value = 300 + 5 * i; slider.dispatchEvent(new Event('input', { bubbles: true })); await new Promise((then) => setTimeout(then, 16)); } }"
    sheet.again(lambda: page.evaluate(drag))
    # The slider moves for one second, and a shared machine draws at least ten frames per second.
    # Regression test: there were only 5 updates in an earlier version, which showed the numbers
    # only after the slider had stopped.
    assert page.evaluate("window.updates") >= 10
    load = case_of(page)["axial_load_N"]
    assert key(page, "ball_torque_Nm") == table_of(FEED, "--set", f"axial_load_N={load}")["torque of the balls"]


def test_a_map_of_3600_points_takes_less_than_a_second(serve, sheet):
    served, sheet = serve(FEED), sheet()
    page = sheet.open(served.address)
    # A coarse map of 24 x 24 points is shown first, followed by the finest map within the time limit.
    assert int(page.get_attribute("#map", "data-points")) > 24 * 24
    host, token = served.address.split("/?token=")
    for name in ["feed_drive", "feed_drive_oil"]:
        body = {"case": json.loads(example(name).read_text()), "settings": {"name": "traction"}, "vary": ["screw_speed_rpm=150:15000:60:log", "axial_load_N=800:80000:60:log"], "columns": ["efficiency"]}
        answer = page.request.post(host + "/sweep", headers={"X-Bsm-Token": token}, data=body)
        took = float(answer.headers["server-timing"].split("dur=")[1])
        MEASURED.append(f"{name}: the server solves a map of 60 x 60 points with traction in {took:.0f} ms")
        # With a lubricant, films and temperatures are also calculated, which may exceed the time limit of the server.
        assert name != "feed_drive" or (answer.status == 200 and took < 1000), took


def test_numbers_on_the_page_match_command_solve_for_every_model(serve, sheet):
    served, sheet = serve(FEED), sheet()
    page = sheet.open(served.address)
    for model in ["closed-form", "quasi-static", "rigid", "raceway-control", "elastic", "traction"]:
        sheet.again(lambda model=model: page.select_option("#model", model))
        expected = table_of(FEED, "--model", model)
        assert key(page, "efficiency") == expected["efficiency of the balls"], model
        assert page.locator("#alert").is_hidden(), model


def test_an_invalid_value_is_reported_at_its_field(serve, sheet):
    served, sheet = serve(FEED), sheet()
    page = sheet.open(served.address)
    fill(sheet, "ball_diameter_mm", "-3.5")
    words = page.locator("[data-name=ball_diameter_mm] .wrong")
    words.wait_for(state="visible")
    assert words.inner_text() == "`ball_diameter_mm` = -3.5 must be a finite number > 0"
    assert page.get_attribute("#in-ball_diameter_mm", "aria-invalid") == "true"
    assert page.locator(".field.bad").count() == 1
    assert page.locator("#alert").is_visible()
    sheet.again(lambda: fill(sheet, "ball_diameter_mm", "6.35"))
    assert page.locator(".field.bad").count() == 0 and page.locator("#alert").is_hidden()


def test_a_decimal_comma_is_accepted(serve, sheet):
    served, sheet = serve(FEED), sheet()
    page = sheet.open(served.address)
    sheet.again(lambda: fill(sheet, "friction_coefficient", "0,07"))
    assert case_of(page)["friction_coefficient"] == 0.07
    sheet.again(lambda: fill(sheet, "ball_diameter_mm", "6,5"))
    assert case_of(page)["ball_diameter_mm"] == 6.5
    # A text is rejected if it is not a number, or if its separator could be a decimal or a
    # thousands separator.
    for text in ["1,500", "1.500,5", "1 5", "x"]:
        fill(sheet, "axial_load_N", text)
        page.locator("[data-name=axial_load_N] .wrong").wait_for(state="visible")
    sheet.again(lambda: fill(sheet, "axial_load_N", "1500"))
    assert case_of(page)["axial_load_N"] == 1500 and page.locator(".field.bad").count() == 0


def test_inputs_can_be_given_in_another_unit(serve, sheet):
    served, sheet = serve(FEED), sheet()
    page = sheet.open(served.address)
    page.select_option("[data-name=axial_load_N] select", "kN")
    assert page.input_value("#in-axial_load_N") == "8"
    sheet.again(lambda: fill(sheet, "axial_load_N", "10"))
    assert case_of(page)["axial_load_N"] == 10000


def test_map_readout_matches_command_solve(serve, sheet):
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


def test_pointer_and_arrow_keys_move_the_operating_point_on_the_map(serve, sheet):
    served, sheet = serve(FEED), sheet()
    page = sheet.open(served.address)
    overlay = page.locator("#map .map svg")
    overlay.scroll_into_view_if_needed()
    box = overlay.bounding_box()
    sheet.again(lambda: page.mouse.click(box["x"] + 0.5 * box["width"], box["y"] + 0.6 * box["height"]))
    moved = case_of(page)
    assert moved["screw_speed_rpm"] != 1500 and moved["axial_load_N"] != 8000
    assert float(page.input_value("#in-screw_speed_rpm")) == moved["screw_speed_rpm"]
    page.locator("#map .cross").focus()
    sheet.again(lambda: page.keyboard.press("ArrowRight"))
    assert case_of(page)["screw_speed_rpm"] > moved["screw_speed_rpm"]


def test_solving_a_saved_case_gives_the_numbers_shown_on_the_page(serve, sheet, tmp_path):
    saved = tmp_path / "saved.json"
    served, sheet = serve(FEED, "-o", saved), sheet()
    page = sheet.open(served.address)
    slide(sheet, "lead_mm", 400)
    page.click("#save")
    page.locator("#save", has_text="Saved").wait_for()
    assert json.loads(saved.read_text()) == case_of(page)
    assert table_of(saved)["efficiency of the balls"] == key(page, "efficiency")


def test_saving_downloads_the_case_if_the_server_has_no_file_to_write(serve, sheet):
    served, sheet = serve(FEED), sheet()
    page = sheet.open(served.address)
    sheet.again(lambda: fill(sheet, "axial_load_N", "5000"))
    with page.expect_download() as download:
        page.click("#save")
    saved = json.loads(download.value.path().read_text())
    assert saved == case_of(page) and saved["axial_load_N"] == 5000


def saved(sheet, panel: str) -> dict[str, bytes]:
    """Return the files that a panel offers, by name."""
    page = sheet.page
    fold = page.locator("section.panel", has=page.locator(f"#h-{panel}")).locator("details.keep")
    if not fold.evaluate("(fold) => fold.open"):
        fold.locator("summary").click()
    fold.locator(".bar > *").first.wait_for()
    files = {}
    for button in fold.locator("button").all():
        with page.expect_download() as download:
            button.click()
        files[download.value.suggested_filename] = download.value.path().read_bytes()
        # Chromium ignores further downloads if a page starts ten downloads within one second.
        page.wait_for_timeout(110)
    return files


def test_figures_and_tables_can_be_saved(serve, sheet):
    sheet = sheet()
    page = sheet.open(serve(example("nut_double")).address)
    for panel in ["key", "space", "section", "ellipses", "losses", "map", "models", "nut", "numbers"]:
        for name, data in saved(sheet, panel).items():
            if name.endswith(".svg"):
                # The file has no style sheet, so it must not contain CSS variables and must state its own size.
                drawing = ElementTree.fromstring(data)
                assert drawing.tag.endswith("svg") and float(drawing.get("width")) > 100, name
            elif name.endswith(".png"):
                assert data.startswith(b"\x89PNG") and len(data) > 2000, name
            else:
                rows = list(csv.reader(io.StringIO(data.decode())))
                assert len(rows) > 1 and len({len(row) for row in rows if len(row) > 1}) >= 1, name
    # The file contains the points of the map with all digits.
    rows = list(csv.DictReader(io.StringIO(saved(sheet, "map")["map-points.csv"].decode())))
    point = rows[len(rows) // 3]
    x, y = list(point)[:2]
    expected = solved(example("nut_double"), "--set", f"{x}={point[x]}", "--set", f"{y}={point[y]}")
    # Batch kernels agree with the models to within 1e-10.
    assert float(point["efficiency"]) == pytest.approx(expected["efficiency"], rel=1e-9)
    assert sheet.errors == []


def test_figures_and_input_fields_use_the_selected_display_units(serve, sheet):
    sheet = sheet()
    page = sheet.open(serve(example("nut_double"), "--units", "inch").address)
    case = case_of(page)
    # The page shows the input in the displayed unit, while the case keeps its own unit.
    assert float(page.input_value("#in-axial_load_N")) == pytest.approx(case["axial_load_N"] / 4.4482216152605, rel=1e-9)
    assert page.locator("[data-name=axial_load_N] select option:checked").inner_text() == "lbf"
    words = {panel: page.inner_text(f"#{panel}") + page.locator(f"#{panel} svg").evaluate_all(
        "(pictures) => pictures.map((picture) => picture.textContent).join(' ')") for panel in ("section", "nut", "map", "ellipses")}
    assert " lbf" in words["section"] and not re.search(r"\d N\b", words["section"])
    for label in ("load, lbf", "position along the axis, in", "displacement, µin", "lbf/in"):
        assert label in words["nut"], label
    assert not re.search(r", (N|mm|µm)\b", words["nut"])
    assert "axial load, lbf" in words["map"] and "psi" in words["ellipses"]
    assert sheet.errors == []


def test_page_address_contains_the_settings(serve, sheet):
    served, first, other = serve(FEED), sheet(), sheet()
    page = first.open(served.address)
    assert page.evaluate("location.hash") == ""
    first.again(lambda: fill(first, "axial_load_N", "5000"))
    first.again(lambda: page.select_option("#model", "traction"))
    first.again(lambda: page.select_option("#map select[aria-label='Output of the map']", "dissipated_power_W"))
    first.again(lambda: page.click("text=Keep this case"))
    first.again(lambda: fill(first, "lead_mm", "10"))
    page.wait_for_function("decodeURIComponent(location.hash).includes('\"lead_mm\":10')")
    for tab, act in [(first, page.reload), (other, lambda: other.page.goto(page.url))]:
        tab.again(act)
        shown = case_of(tab.page)
        assert shown["axial_load_N"] == 5000 and shown["lead_mm"] == 10
        assert tab.page.input_value("#model") == "traction"
        assert tab.page.input_value("#map select[aria-label='Output of the map']") == "dissipated_power_W"
        assert tab.page.locator("table.beside thead th").count() == 2
        expected = table_of(FEED, "--model", "traction", "--set", "axial_load_N=5000", "--set", "lead_mm=10")
        assert key(tab.page, "ball_torque_Nm") == expected["torque of the balls"]
    # In the initial state, the address has no fragment.
    first.again(lambda: page.click("#reset"))
    first.again(lambda: page.locator("table.beside thead button[aria-label^='Remove']").click())
    first.again(lambda: page.select_option("#map select[aria-label='Output of the map']", "efficiency"))
    first.again(lambda: page.select_option("#model", "auto"))
    page.wait_for_function("location.hash === ''")


def test_page_with_invalid_settings_in_its_address_shows_the_case_of_the_server(serve, sheet):
    sheet = sheet()
    sheet.page.goto(serve(FEED).address + "#%7Bnonsense")
    settled(sheet.page)
    assert key(sheet.page, "efficiency") == table_of(FEED)["efficiency of the balls"]


def columns_of(page) -> dict[str, list[str]]:
    """Return the rows of the table of cases, by label."""
    rows = page.locator("table.beside tbody tr").all()
    return {row.locator("th").inner_text(): [cell.inner_text() for cell in row.locator("td").all()[1:]] for row in rows}


def test_model_comparison_from_catalog_data_shows_intervals(serve, sheet, tmp_path):
    line = tmp_path / "line.json"
    line.write_text(json.dumps({
        "nominal_diameter_mm": 40, "lead_mm": 20, "rated_dynamic_load_N": 51300, "rated_static_load_N": 144400,
        "axial_load_N": 5130, "screw_speed_rpm": 500, "friction_coefficient": 0.08}))
    sheet = sheet()
    page = sheet.open(serve(line).address)
    row = page.locator("#models tbody tr", has_text="raceway-control").first
    cells = row.locator("td.number").all_inner_texts()
    # Efficiency and torque depend on the estimated groove, but the time of a solve does not.
    assert all(re.fullmatch(r"[\d.]+ \([\d.]+ to [\d.]+\)", cell) for cell in cells[:2]), cells
    assert re.fullmatch(r"[\d.]+", cells[-1]), cells
    assert sheet.errors == []


def test_cases_are_shown_side_by_side(serve, sheet, tmp_path):
    other = tmp_path / "other.json"
    other.write_text(json.dumps(json.loads(FEED.read_text()) | {"lead_mm": 10, "axial_load_N": 4000}))
    served, sheet = serve(FEED, other), sheet()
    page = sheet.open(served.address)
    label = "torque of the balls"
    page.wait_for_function("document.querySelectorAll('table.beside tbody tr').length > 10")
    assert columns_of(page)[label] == [table_of(FEED)[label], table_of(other)[label]]
    sheet.again(lambda: fill(sheet, "axial_load_N", "6000"))
    sheet.again(lambda: page.click("text=Keep this case"))
    sheet.again(lambda: page.select_option("#model", "elastic"))
    expected = [table_of(FEED, "--model", "elastic", "--set", "axial_load_N=6000")[label], table_of(other, "--model", "elastic")[label]]
    found = columns_of(page)
    assert found[label] == [expected[0], expected[1], expected[0]]
    assert found["axial load"] == ["6000", "4000", "6000"] and found["lead"] == ["20", "10", "20"]
    sheet.again(lambda: page.locator("table.beside thead button", has_text="Show").first.click())
    assert case_of(page)["lead_mm"] == 10


def test_a_saved_page_shows_cases_side_by_side(save_page, sheet, tmp_path):
    other = tmp_path / "other.json"
    other.write_text(json.dumps(json.loads(FEED.read_text()) | {"lead_mm": 10, "axial_load_N": 4000}))
    page = sheet().open(save_page(FEED, other))
    label = "torque of the balls"
    assert columns_of(page)[label] == [table_of(FEED)[label], table_of(other)[label]]


def test_axis_panel_shows_all_rules_and_saves_the_axis_sheet(serve, sheet, tmp_path):
    axis = example("axis")
    served, sheet = serve(axis), sheet()
    page = sheet.open(served.address)
    report = json.loads(bsm("axis", axis, "--json"))
    names = page.locator("#axis table").first.locator("tbody tr th").all_inner_texts()
    assert [name.split("\n")[0] for name in names] == [rule["rule"] for rule in report["rules"]]
    assert ("All" if report["passes"] else "fail") in page.inner_text("#axis .bar")
    numbers = page.locator("#axis details")
    numbers.evaluate("(fold) => { fold.open = true; }")
    assert five_digits(report["results"]["cycle_life_h"]) in numbers.inner_text()
    assert all(note in page.inner_text("#axis") for note in report["notes"])
    # The saved sheet is identical to the sheet that `bsm axis` writes.
    with page.expect_download() as download:
        page.click("text=Save the sheet")
    bsm("axis", axis, "-o", tmp_path / "sheet.html")
    # The sheet that the command writes also contains the name and the hash of the case file.
    written = re.sub(r" From axis.json, SHA-256 [0-9a-f]{64}\.", "", (tmp_path / "sheet.html").read_text())
    assert download.value.path().read_text() == written
    with page.context.expect_page() as opened:
        page.click("text=Open the sheet")
    opened.value.wait_for_load_state()
    assert opened.value.locator("h1").count() == 1 and opened.value.locator("figure svg").count() > 0
    # The screw rotates, because its speed follows from the feed rate.
    assert re.search(r"Motion slowed [\d.]+ times", page.inner_text("#space"))
    # The picture must be the 3D view, not the 2D drawing for browsers without WebGL.
    # Regression test: the page showed the 2D drawing because a name of the 3D library was
    # misspelled.
    assert page.locator("#space canvas").count() == 1
    assert sheet.errors == []


def test_a_case_without_axis_inputs_shows_no_axis_panel(serve, sheet):
    page = sheet().open(serve(example("lin1994")).address)
    assert page.locator("#axis").is_hidden()


@pytest.mark.parametrize(("name", "turned"), [("feed_drive", "screw_speed_rpm"), ("axis", "feed_m_min")])
def test_the_animation_shows_a_tenth_of_a_revolution_per_second(serve, sheet, name, turned):
    served, sheet = serve(example(name)), sheet()
    page = sheet.open(served.address)
    case = case_of(page)
    assert turned in case
    lead = case["lead_mm"]
    speed = case[turned] if turned == "screw_speed_rpm" else 1e3 * case[turned] / lead
    # The animation shows a tenth of a revolution per second.
    slow = float(re.search(r"Motion slowed ([\d.]+) times", page.inner_text("#space"))[1])
    assert slow == pytest.approx(abs(speed) / 60 / 0.1, rel=1e-3)


@pytest.mark.parametrize("width", [1300, 400])
@pytest.mark.parametrize("name", ["feed_drive_oil", "nut_double", "axis"])
def test_full_page_screenshots_cause_no_javascript_errors(serve, sheet, name, width):
    """A full-page capture resizes the window. An ellipse once had a negative radius at width 0."""
    served, sheet = serve(example(name)), sheet(width)
    page = sheet.open(served.address)
    for _ in range(3):
        page.screenshot(full_page=True)
    # Canvases in a hidden panel have no size. They get their size back when the panel is shown.
    for style in ["width:0", "display:none", ""]:
        page.evaluate("(style) => { for (const panel of document.querySelectorAll('.panel')) panel.style.cssText = style; dispatchEvent(new Event('resize')); }", style)
        page.set_viewport_size({"width": width + (1 if style else 0), "height": 900})
        sheet.again(lambda: slide_to(page, "axial_load_N", 520 if style else 480))
        page.screenshot(full_page=True)
    page.pdf() if width == 1300 else None
    refused = "the server responded with a status of 400"
    assert [error for error in sheet.errors if refused not in error] == []


def slide_to(page, name: str, place: int) -> None:
    page.locator(f"[data-name={name}] input[type=range]").evaluate("(e, v) => { e.value = v; e.dispatchEvent(new Event('input', { bubbles: true })); }", place)


WARM = ROOT / "validation/published/nut/feed_axis.json"


def test_warm_state_figure_shows_temperatures_and_thermal_fold(serve, sheet, tmp_path):
    # The preload of an X pair with a cooled nut runs away as the speed increases.
    warm = tmp_path / "warm.json"
    warm.write_text(json.dumps(json.loads(WARM.read_text()) | {"preload_arrangement": "X", "nut_conductance_W_K": 20, "screw_speed_rpm": 700}))
    model = ("--model", "raceway-control")
    served, sheet = serve(warm, *model), sheet()
    sheet.page.goto(served.address)
    # The test sets no limit for the calculation time of the warm state, but waits for the figure.
    figure = sheet.page.locator("#nut figure", has_text="Warm preload against speed")
    figure.wait_for(timeout=120_000)
    report = json.loads(bsm("axis", warm, *model, "--json"))["warm"]
    words = figure.inner_text()
    for name in ["nut_temperature_C", "screw_temperature_C", "balls_temperature_C"]:
        assert f"{five_digits(report[name])} °C" in words
    fold = 700 * report["fold_speed_factor"]
    shown = float(re.search(r"Above ([\d.]+) rpm", words)[1])
    # The fold lies between two points of the curve, which is calculated with the friction of each
    # contact.
    assert shown == pytest.approx(fold, rel=0.1)
    assert "runs away" in words and figure.locator("svg circle").count() == 1


def test_balls_that_touch_are_marked_in_the_diagrams_of_the_nut(serve, sheet, tmp_path):
    case = tmp_path / "train.json"
    case.write_text(json.dumps(json.loads(example("nut_train").read_text()) | {"moment_y_Nm": 30}))
    bsm("nut", case, "-o", tmp_path / "balls.csv")
    with (tmp_path / "balls.csv").open() as table:
        balls = [{name: float(cell) for name, cell in row.items() if cell} for row in csv.DictReader(table)]
    pushed = [ball["front_push_N"] > 0 or ball["back_push_N"] > 0 for ball in balls]
    page = sheet().open(serve(case).address)
    figure = page.locator("#nut figure", has_text="Speeds and advance of the balls")
    assert figure.locator(".free").count() == figure.locator(".advance").count() == len(balls) == 98
    assert figure.locator(".moving").count() == sum(pushed) > 40
    # Touching balls are marked in the diagrams of speed, force and advance.
    assert figure.locator(".touch").count() == 3 * sum(pushed)
    # The style sheet of pictures must not replace the color of the marks for touching balls by the
    # background color.
    assert figure.locator(".touch").first.evaluate("(mark) => getComputedStyle(mark).fill") == "rgb(138, 97, 0)"
    assert figure.locator(".push").count() == sum(ball["front_push_N"] > 0 for ball in balls)
    # The scale of the speed axis is determined from the marks of two free balls.
    # On the scale of the speed axis, all other marks and the line of the ball train must be at the
    # calculated speeds.
    heights = [float(mark.get_attribute("cy")) for mark in figure.locator(".free").all()]
    slow, fast = (pick(range(98), key=lambda i: balls[i]["free_rate"]) for pick in (min, max))
    scale = (heights[fast] - heights[slow]) / (balls[fast]["free_rate"] - balls[slow]["free_rate"])
    rate_at = lambda height: balls[slow]["free_rate"] + (height - heights[slow]) / scale
    moving = [rate_at(float(mark.get_attribute("cy"))) for mark in figure.locator(".moving").all()]
    of_pushed = [ball["rate"] for ball, is_pushed in zip(balls, pushed, strict=True) if is_pushed]
    assert moving == pytest.approx(of_pushed, rel=1e-8)
    [train] = json.loads(bsm("nut", case, "--json"))["circuits"]
    # The coordinates in the path of the line have two decimal places.
    line = float(figure.locator(".train").get_attribute("d").split("L")[1].split(" ")[1])
    assert rate_at(line) == pytest.approx(train["train_rate"], abs=abs(0.01 / scale))
    # If the gaps are not given, it is unknown whether balls touch.
    free = tmp_path / "free.json"
    free.write_text(json.dumps({k: v for k, v in json.loads(case.read_text()).items() if k != "ball_gap_mm"}))
    page = sheet().open(serve(free).address)
    figure = page.locator("#nut figure", has_text="Speeds and advance of the balls")
    assert figure.locator(".free").count() == 98
    assert figure.locator(".touch, .moving, .push, .train").count() == 0


def test_a_case_file_can_be_loaded(serve, sheet):
    served, sheet = serve(FEED), sheet()
    page = sheet.open(served.address)
    sheet.again(lambda: page.set_input_files("#file", example("lin1994")))
    assert key(page, "efficiency") == table_of(example("lin1994"))["efficiency of the balls"]
    sheet.again(lambda: page.click("#reset"))
    assert key(page, "efficiency") == table_of(FEED)["efficiency of the balls"]


@pytest.mark.parametrize(("name", "width", "scheme"), [("feed_drive", 1300, "light"), ("nut_double", 1300, "dark"), ("feed_drive_oil", 390, "light"), ("lin1994", 390, "dark")])
def test_page_passes_the_accessibility_checks_of_axe(serve, sheet, name, width, scheme):
    expect_accessible(sheet(width, scheme).open(serve(example(name)).address), width)


@pytest.mark.parametrize(("width", "scheme"), [(1300, "light"), (1300, "dark"), (400, "light"), (400, "dark")])
def test_saved_page_passes_the_accessibility_checks_of_axe(save_page, sheet, width, scheme):
    page = sheet(width, scheme).open(save_page(example("axis")))
    expect_accessible(page, width)
    if SCREENSHOTS:
        page.screenshot(path=Path(SCREENSHOTS) / f"saved-{width}-{scheme}.png", full_page=True)


def expect_accessible(page, width: int) -> None:
    for fold in page.locator("details").all():
        fold.evaluate("(fold) => { fold.open = true; }")
    found = Axe().run(page).response["violations"]
    assert [(v["id"], [n["html"][:120] for n in v["nodes"]][:3]) for v in found] == []
    # No element may be wider than the screen.
    assert page.evaluate("document.documentElement.scrollWidth") <= width


# Numbers that are rounding errors, differences of nearly equal numbers, or spins that can vanish. Their tolerance is at least 1e-12.
DIFFERENCES = {"power_balance", "residual_norm", "advance_spread", "efficiency_error_bound", "loss_error_bound", "nut_spin_rad_s", "screw_spin_rad_s"}


def differences(one: object, other: object, name: str = "") -> list[str]:
    """List the values of `other` that differ from the values of `one` by more than a relative 1e-12."""
    if isinstance(other, dict):
        # Computing times differ from run to run, so they are not compared.
        names = [name for name in other if name != "time_us"]
        return [text for name in names for text in differences(one[name], other[name], name)]
    if isinstance(other, list) and not all(isinstance(value, float | int) for value in other):
        assert len(one) == len(other), name
        return [text for pair in zip(one, other, strict=True) for text in differences(*pair, name)]
    if not isinstance(other, list | float | int) or isinstance(other, bool):
        return [] if one == other else [f"{name}: {one}, {other}"]
    # Differences are relative to the largest entry of a matrix row, or to a full turn for angles.
    ones, others = (value if isinstance(value, list) else [value] for value in (one, other))
    floor = 360 if name.endswith("_deg") else 1 if name in DIFFERENCES else 0
    scale = max([abs(value) for value in others] + [floor])
    pairs = zip(ones, others, strict=True)
    return [f"{name}: {a}, {b}" for a, b in pairs if abs(a - b) > 1e-12 * scale]


# Script that sends a request to the solver of the page. The script returns the answer and the time [ms].
ASK = """async ([route, body]) => {
  const { ask } = await import("bsm/source"), began = performance.now();
  const answer = await ask(route, body, 0).catch(({ message }) => message);
  return [answer, performance.now() - began];
}"""

CASES = sorted(path.stem for path in (ROOT / "examples").glob("*.json"))
MODELS = ["auto", "closed-form", "quasi-static", "rigid", "raceway-control", "elastic", "traction"]


@pytest.mark.parametrize("name", CASES)
def test_a_saved_page_shows_the_same_numbers_as_the_program(save_page, sheet, name):
    case = example(name)
    # A page that was saved for one case can solve every case.
    page = sheet(offline=True).page
    page.goto(save_page(FEED))
    entries = json.loads(case.read_text())
    solves = [("solve", {"settings": {"name": model}}, ["--model", model]) for model in MODELS]
    for route, body, options in [*solves, ("nut", {}, []), ("axis", {}, [])]:
        command = [BSM, route, str(case), *options, "--json"]
        program = subprocess.run(command, capture_output=True, text=True, check=False)
        found = page.evaluate(ASK, [route, {"case": entries} | body])[0]
        if program.returncode in (0, 3):
            # The page uses other implementations of mathematical functions than the program, and no fused operations.
            assert differences(found, json.loads(program.stdout)) == [], (route, options)
        else:
            # The case lacks an input, and the page reports this with the message of the program.
            assert isinstance(found, str) and found in program.stderr, (route, options)


def test_a_saved_page_calculates_without_a_server(save_page, sheet):
    address, sheet = save_page(FEED), sheet(offline=True)
    page = sheet.open(address)
    assert sheet.errors == []
    assert all(url.startswith(("file:", "data:", "blob:")) for url in sheet.requests), sheet.requests
    assert key(page, "efficiency") == table_of(FEED)["efficiency of the balls"]
    # Every input and every model can be changed.
    slide(sheet, "lead_mm", 400)
    sheet.again(lambda: fill(sheet, "axial_load_N", "5000"))
    sheet.again(lambda: page.select_option("#model", "traction"))
    case = case_of(page)
    assert case["lead_mm"] != 20
    expected = table_of(FEED, "--model", "traction", "--set", "axial_load_N=5000", "--set", f"lead_mm={case['lead_mm']}")
    assert key(page, "ball_torque_Nm") == expected["torque of the balls"]
    # All panels are drawn. The map has at least the coarse grid.
    assert page.locator("#ellipses canvas").count() == 2 and page.locator("#nut svg").count() > 0
    assert int(page.get_attribute("#map", "data-points")) >= 24 * 24
    fill(sheet, "ball_diameter_mm", "-3.5")
    page.locator("#alert", has_text="must be a finite number > 0").wait_for()
    assert sheet.errors == []


# Two cases with results that most cases do not have: estimated grooves and undecided rules in inch
# units, and third contacts.
SPECIAL = {
    "catalog line": {"nominal_diameter_mm": 40, "lead_mm": 20, "rated_dynamic_load_N": 51300, "rated_static_load_N": 144400, "axial_load_N": 100000, "screw_speed_rpm": 100, "stroke_mm": 500, "friction_coefficient": 0.08, "display_units": "inch"},
    "third contact": json.loads(example("nut_double").read_text()) | {"axial_play_um": 5, "stroke_mm": 500},
}


def panels_of(page) -> dict[str, str]:
    """Return the texts of all panels and pictures. The number of points of the map depends on the speed of the machine."""
    panels = {panel: page.locator(f"#{panel}") for panel in ["key", "section", "ellipses", "losses", "nut", "axis", "beside", "numbers"]}
    texts = {name: panel.evaluate("(panel) => panel.innerText + [...panel.querySelectorAll('svg')].map((picture) => picture.textContent)") for name, panel in panels.items()}
    texts["map"] = page.inner_text("#map select") + page.inner_text("#map .bar")
    # The served page also shows the time of each model.
    rows = page.locator("#models tr").evaluate_all("(rows) => rows.map((row) => [...row.cells].map((cell) => cell.innerText))")
    assert len(rows) > 4
    texts["models"] = str([row[:7] for row in rows])
    return texts


@pytest.mark.parametrize("name", SPECIAL)
def test_a_saved_page_shows_the_same_texts_as_the_page_of_the_server(serve, save_page, sheet, tmp_path, name):
    case = tmp_path / "case.json"
    case.write_text(json.dumps(SPECIAL[name]))
    live, saved_one = sheet(), sheet(offline=True)
    expected = panels_of(live.open(serve(case).address))
    found = panels_of(saved_one.open(save_page(case)))
    assert found == expected
    everything = " ".join(found.values())
    for text in {"catalog line": ["undecided", " lbf", "µin", " to "], "third contact": ["third contact"]}[name]:
        assert text in everything, text
    if name == "catalog line":
        # A number and its interval have the same displayed unit.
        torque, low, high = map(float, re.findall(r"[\d.]+", saved_one.page.inner_text("#key [data-output=ball_torque_Nm]")))
        assert low < torque < high
    assert live.errors == saved_one.errors == []


def test_a_saved_page_shows_numbers_within_100_ms_of_a_slider_move(save_page, sheet):
    for name, model in [("feed_drive", "auto"), ("feed_drive_oil", "traction"), ("nut_oversize", "auto")]:
        tab = sheet()
        page = tab.open(save_page(example(name)))
        if model != "auto":
            tab.again(lambda page=page, model=model: page.select_option("#model", model))
        numbers, pictures, _ = page.evaluate(STEPS, ["axial_load_N", 15, 20])
        body = {"case": case_of(page), "settings": {"name": model}}
        times = {route: page.evaluate(ASK, [route, body])[1] for route in ["point", "compare", "nut"]}
        MEASURED.append(
            f"saved page, {name}, {model}: numbers appear {median(numbers):.0f} ms after a slider move, pictures after {median(pictures):.0f} ms; "
            + ", ".join(f"{route} {time:.0f} ms" for route, time in times.items())
        )
        # The limit is the same as for the page from the server, except for lubricant films, which
        # take longer in WebAssembly.
        assert name == "feed_drive_oil" or median(numbers) < 100, numbers


def test_a_saved_page_is_smaller_than_4_mb(save_page):
    size = Path(save_page(example("axis")).removeprefix("file://")).stat().st_size
    MEASURED.append(f"a saved page has {size / 1e6:.2f} MB")
    # Most of the size is the solver (2 to 3 MB) and the library for the picture in 3D (0.6 MB).
    assert size < 4_000_000


def test_a_saved_page_stops_calculations_that_are_no_longer_needed(save_page, sheet):
    page = sheet().open(save_page(FEED))
    stopped = """async (entries) => {
      const { ask } = await import("bsm/source"), control = new AbortController();
      const body = { case: entries, settings: { name: "traction" }, vary: ["screw_speed_rpm=1:15000:200", "axial_load_N=800:80000:200"], columns: ["efficiency"] };
      const slow = ask("sweep", body, 0, control.signal).catch(({ name }) => name);
      setTimeout(() => control.abort(), 100);
      const began = performance.now(), first = await slow;
      return [first, performance.now() - began, (await ask("point", { case: entries, settings: {} }, 0)).solve.status];
    }"""
    name, took, status = page.evaluate(stopped, case_of(page))
    # A map of 40,000 points takes several seconds, so a short time shows that the calculation was stopped.
    assert (name, status) == ("AbortError", "converged") and took < 1000, took


def test_changes_in_one_browser_tab_do_not_affect_another_tab(serve, sheet):
    served = serve(FEED)
    one, other = sheet(), sheet()
    one.open(served.address), other.open(served.address)
    slide(one, "axial_load_N", 800)
    slide(other, "axial_load_N", 200)
    for tab in (one, other):
        load = case_of(tab.page)["axial_load_N"]
        assert key(tab.page, "ball_torque_Nm") == table_of(FEED, "--set", f"axial_load_N={load}")["torque of the balls"]


def test_requests_from_other_pages_are_rejected(serve, sheet):
    served, other = serve(FEED), serve(FEED)
    page = sheet().open(other.address)
    token = served.address.split("token=")[1]
    ask = "async ([url, token]) => { try { const r = await fetch(url, { method: 'POST', headers: { 'X-Bsm-Token': token }, body: '{}' }); return r.status; } catch (e) { return 'refused'; } }"
    assert page.evaluate(ask, [served.address.split("/?")[0] + "/schema", token]) == "refused"
    answer = page.request.post(served.address.split("/?")[0] + "/schema", headers={"X-Bsm-Token": token, "Origin": "http://localhost:1"}, data="{}")
    assert answer.status == 403
    assert page.request.get(served.address[:-1]).status == 403


def test_page_reports_that_the_server_has_stopped(serve, sheet):
    served, sheet = serve(FEED), sheet()
    page = sheet.open(served.address)
    served.end()
    slider = page.locator("[data-name=axial_load_N] input[type=range]")
    slider.evaluate("(e) => { e.value = 100; e.dispatchEvent(new Event('input', { bubbles: true })); }")
    page.locator("#alert", has_text="The server has ended").wait_for()
    # The page still responds.
    page.locator(".json summary").click()
    assert page.locator("#json").is_visible()


def test_page_shows_an_svg_drawing_if_webgl_is_unavailable(serve, sheet):
    sheet = sheet()
    sheet.page.add_init_script(
        "const get = HTMLCanvasElement.prototype.getContext; HTMLCanvasElement.prototype.getContext = function (kind, ...rest) { return kind.startsWith('webgl') ? null : get.call(this, kind, ...rest); };"
    )
    page = sheet.open(serve(FEED).address)
    assert page.locator("#space svg circle").count() > 10
    assert key(page, "efficiency") == table_of(FEED)["efficiency of the balls"]


def five_digits(value: float) -> str:
    """Format a number like `bsm` (`bsm_report::number`)."""
    if value == 0:
        return "0"
    exact = Decimal(value)
    if not 1e-4 <= abs(value) < 1e6:
        digits, power = f"{value:.4e}".split("e")
        return f"{digits}e{int(power)}"
    decimals = max(0, 4 - exact.adjusted())
    return str(exact.quantize(Decimal(1).scaleb(-decimals), rounding=ROUND_HALF_EVEN))


def test_page_formats_numbers_like_the_program(serve, sheet):
    page = sheet().open(serve(FEED).address)
    # Some values, such as 0.5 and 128.125, are ties between two roundings. 2.00005 is not a tie.
    values = [0.0, 1.0, -3.25, 0.8601069, 123456.7, 1.234567e6, -4.5e-5, 0.000123456, 128.125, -128.375, 2.00005, 100000.5, 99999.5, 999999.7, 0.1, 1 / 3, 8.5e-9, 6.02e23]
    values += [1.0625 * 2.0**k for k in range(-12, 20)]
    found = page.evaluate("async (values) => { const { number } = await import('bsm/draw'); return values.map(number); }", values)
    assert found == [five_digits(value) for value in values]


@pytest.mark.parametrize("name", ["axis", "rated"])
def test_axis_sheet_is_printed_on_two_pages(sheet, tmp_path, name):
    written = tmp_path / "sheet.html"
    bsm("axis", example(name), "-o", written)
    page = sheet().page
    page.goto(written.as_uri())
    printed = page.pdf(format="A4")
    assert len(re.findall(rb"/Type\s*/Page\b", printed)) == 2
    # No element may be wider than A4 between its margins, which is 188 mm at 96 dots per inch.
    page.set_viewport_size({"width": 711, "height": 1040})
    page.emulate_media(media="print")
    assert page.evaluate("document.documentElement.scrollWidth") <= 711
