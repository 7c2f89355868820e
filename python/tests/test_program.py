"""Tests that the results of every function are bit-identical to the results of the corresponding command."""

from __future__ import annotations

import hashlib
import json
import pickle
import re
import subprocess
from pathlib import Path
from typing import Any

import numpy as np
import pandas as pd
import polars as pl
import pyarrow as pa
import pyarrow.parquet as pq
import pytest
from conftest import EXAMPLES, program

import ballscrew as bs


def told(*words: str | Path) -> Any:
    """Return the JSON output of the program. Exit code 3 is also accepted."""
    run = subprocess.run([program(), *words, "--json"], capture_output=True, cwd=EXAMPLES.parent)
    assert run.returncode in (0, 3), run.stderr
    return json.loads(run.stdout)


def refused(*words_of_it: str | Path, words: str) -> None:
    """Check that the program rejects the input with the same message."""
    run = subprocess.run([program(), *words_of_it], capture_output=True, text=True)
    assert run.returncode == 2 and words in run.stderr, run.stderr


def plain(report: bs.Report) -> dict[str, Any]:
    """Convert a report to JSON text and back, like the output of the program."""
    found: dict[str, Any] = json.loads(json.dumps(report.to_dict()))
    return found


@pytest.mark.parametrize("name", ["feed_drive", "feed_drive_oil", "lin1994", "back_driving", "dong2020", "xu2015"])
@pytest.mark.parametrize("model", ["auto", "raceway-control", "traction"])
def test_solve_matches_the_command(name: str, model: str) -> None:
    path = EXAMPLES / f"{name}.json"
    try:
        answer = bs.solve(bs.Case.read(path), model=model, check=False)  # type: ignore[arg-type]
    except bs.InputError as error:
        refused("solve", path, "--model", model, words=str(error))
        return
    assert answer.to_dict() == told("solve", path, "--model", model, "--show", "band")


def test_compare_matches_the_command() -> None:
    path = EXAMPLES / "feed_drive.json"
    table = bs.compare(bs.Case.read(path)).to_dict()
    for row, model in enumerate(told("solve", path, "--model", "all")["models"]):
        for name in ("model", "status", "efficiency", "ball_torque_Nm", "nut_normal_load_N"):
            assert table[name][row] == model[name]


def test_sensitivities_match_the_command() -> None:
    path = EXAMPLES / "feed_drive.json"
    table = bs.sensitivities(bs.Case.read(path)).to_dict()
    rows = told("solve", path, "--show", "sensitivities")["sensitivities"]
    assert table["input"] == list(rows)
    assert table["efficiency"] == [row["efficiency"] for row in rows.values()]
    assert table["ball_torque_relative"] == [row["ball_torque_relative"] for row in rows.values()]


REPORTS: dict[str, list[str]] = {
    "slip": ["solve", "--show", "slip"],
    "jam": ["solve", "--show", "jam"],
    "ratings": ["solve", "--show", "ratings"],
    "optimum": ["solve", "--show", "optimum"],
    "nut": ["nut"],
    "axis": ["axis"],
}


@pytest.mark.parametrize("function", REPORTS)
@pytest.mark.parametrize("name", ["nut", "axis", "nut_double", "jamming"])
def test_reports_match_the_commands(function: str, name: str) -> None:
    path = EXAMPLES / f"{name}.json"
    case = bs.Case.read(path)
    try:
        report = getattr(bs, function)(case)
    except bs.InputError as error:
        refused(*REPORTS[function], path, words=str(error))
        return
    expected = told(*REPORTS[function], path)
    expected.pop("program", None)
    assert plain(report) == expected
    assert set(expected["warnings"]) <= set(report.warnings)


@pytest.mark.parametrize("name", ["feed_drive", "feed_drive_oil"])
def test_ellipses_match_the_command(name: str) -> None:
    path = EXAMPLES / f"{name}.json"
    contacts = bs.ellipses(bs.Case.read(path), points=7)["contacts"]
    expected = told("solve", path, "--show", "ellipses", "--points", "7")["contacts"]
    for contact, fields in zip(contacts, expected, strict=True):
        assert list(contact) == list(fields)
        for field, values in fields.items():
            # Outside the ellipse, there are no numbers to compare.
            wanted = np.array([np.nan if value is None else value for value in values]) if isinstance(values, list) else values
            assert np.array_equal(np.ravel(contact[field]), np.ravel(wanted), equal_nan=True) if isinstance(values, list) else contact[field] == values


def test_fit_matches_the_command() -> None:
    path = EXAMPLES / "feed_drive.json"
    screw = bs.Case.read(path)
    report = bs.fit(screw, {"screw_torque_Nm": 26.0}, model="raceway-control")
    assert plain(report) == told("fit", path, "--measured", "screw_torque_Nm=26", "--model", "raceway-control")
    found = report["found"][0]["friction_coefficient"]
    torque = bs.solve(screw, model="raceway-control", friction_coefficient=found).ball_torque_Nm
    # The fit ends when the relative error of the torque is below 1e-6.
    assert torque == pytest.approx(26.0, rel=1e-5)


def test_one_friction_coefficient_per_contact_matches_the_command() -> None:
    path = EXAMPLES / "feed_drive_oil.json"
    oiled = bs.Case.read(path)
    answer = bs.solve(oiled, model="raceway-control", friction="contact")
    words = ("--model", "raceway-control", "--friction", "contact")
    assert answer.to_dict() == told("solve", path, *words, "--show", "band")
    local = bs.solve(oiled, model="raceway-control")
    assert answer.dissipated_power_W != local.dissipated_power_W
    for table in (
        bs.solve_many({"screw_speed_rpm": [1500.0]}, oiled, model="raceway-control", friction="contact"),
        bs.sweep(oiled, vary={"screw_speed_rpm": [1500.0]}, model="raceway-control", friction="contact"),
    ):
        # The program guarantees that a row and a single solve of the same inputs agree to this accuracy.
        assert table["dissipated_power_W"][0] == pytest.approx(answer.dissipated_power_W, rel=1e-10)
    with pytest.raises(bs.InputError, match="local, contact"):
        bs.solve(oiled, friction="everywhere")  # type: ignore[arg-type]
    with pytest.raises(bs.InputError, match="model traction uses only the settings accuracy and creep"):
        bs.solve(oiled, model="traction", friction="contact")


def test_torque_parts_match_the_command() -> None:
    path = EXAMPLES / "axis.json"
    answer = bs.solve(bs.Case.read(path)).to_dict()
    assert answer == told("solve", path)
    phase = bs.axis(bs.Case.read(path))["phases"][0]
    assert answer["torque_parts"].items() <= phase.items()


def test_the_warm_state_of_an_axis_matches_the_command() -> None:
    path = EXAMPLES.parent / "validation" / "published" / "nut" / "feed_axis.json"
    axis = bs.Case.read(path)
    sheet = bs.axis(axis, model="raceway-control", control="nut")["warm"]
    nut = bs.nut(axis, model="raceway-control", control="nut")
    # `nut` solves the nut again at the temperatures of the axis.
    assert nut["warm_preload_N"] == pytest.approx(sheet["warm_preload_N"], rel=1e-9)
    vary = {"nut_conductance_W_K": [3.0, 20.0]}
    grid = bs.sweep(axis, vary=vary, columns=["nut_temperature_C"], model="raceway-control", control="nut")
    warm, cooled = grid["nut_temperature_C"]
    # The calculated conductance is 3.3 W/K, and the preload is set at 20 C.
    assert warm > sheet["nut_temperature_C"] > cooled > 20
    # If no warm state is requested, the report must not contain a warm state.
    cold = bs.Case(axis, warm_state=False, lubricant_temperature_C=40)
    assert "warm" not in bs.axis(cold, model="raceway-control", control="nut")


def test_a_nut_with_touching_balls_matches_the_command() -> None:
    path = EXAMPLES / "nut_train.json"
    case = bs.Case.read(path)
    expected = told("nut", path, "--model", "traction")
    expected.pop("program", None)
    assert plain(bs.nut(case, model="traction")) == expected
    grid = bs.sweep(case, vary={"ball_gap_mm": [0.1, 0.3, 1.0]}, model="traction",
                    columns=["needed_gap_mm", "max_push_N", "friction_torque_Nm"])
    # A gap of 1 mm is larger than needed, so no balls touch.
    assert all(0.3 < gap < 1.0 for gap in grid["needed_gap_mm"])
    tight, near, wide = grid["max_push_N"]
    assert tight > near > wide == 0
    tight, near, wide = grid["friction_torque_Nm"]
    assert tight > near > wide > 0


def test_a_fit_to_measured_points_matches_the_command() -> None:
    path, table = EXAMPLES / "feed_drive_oil.json", EXAMPLES / "measured_torque.csv"
    oiled = bs.Case.read(path)
    words = ("--points", table, "--measured", "screw_torque_Nm", "--input", "boundary_friction_coefficient",
             "--input", "seal_torque_Nm=0:1")
    expected = told("fit", path, *words)
    sought = {"boundary_friction_coefficient": None, "seal_torque_Nm": (0.0, 1.0)}
    with table.open() as file:
        names = file.readline().strip().split(",")
        rows = np.array([[float(cell) for cell in line.split(",")] for line in file])
    columns = dict(zip(names, rows.T, strict=True))
    for data in (table, columns, pa.table(columns)):
        assert plain(bs.fit(oiled, "screw_torque_Nm", points=data, inputs=sought)) == expected
    one = bs.fit(oiled, "screw_torque_Nm", points=columns, inputs={"seal_torque_Nm": (0.0, 1.0)})
    assert list(one["found"]) == ["seal_torque_Nm"]
    with pytest.raises(bs.InputError) as caught:
        bs.fit(oiled, "screw_torque_Nm", points={**columns, "axial_load_N": -columns["axial_load_N"]}, inputs=sought)
    assert (caught.value.key, caught.value.row) == ("axial_load_N", 0)


def test_reports_written_to_folders_match_the_commands(tmp_path: Path) -> None:
    path = EXAMPLES / "axis.json"
    bs.axis(bs.Case.read(path), figures=tmp_path / "ours" / "axis")
    bs.validate(tmp_path / "ours" / "validate")
    for words in (["axis", str(path)], ["validate"]):
        run = subprocess.run([program(), *words, "--figures", tmp_path / "theirs" / words[0]], capture_output=True)
        assert run.returncode == 0, run.stderr
    files = sorted(p.relative_to(tmp_path / "ours") for p in (tmp_path / "ours").rglob("*") if p.is_file())
    assert len(files) > 50
    # The program reads a case file and states its name and hash in the footer of the sheet.
    foot = f" From axis.json, SHA-256 {hashlib.sha256(path.read_bytes()).hexdigest()}.".encode()
    for name in files:
        theirs = (tmp_path / "theirs" / name).read_bytes()
        if name == Path("axis/report.html"):
            assert foot in theirs
            theirs = theirs.replace(foot, b"")
        assert (tmp_path / "ours" / name).read_bytes() == theirs, name


@pytest.mark.parametrize("path", sorted((EXAMPLES / "requirements").glob("*.json")), ids=lambda path: path.stem)
def test_select_matches_the_command(path: Path) -> None:
    report = bs.select(path)
    assert plain(report) == told("select", path)
    standard = bs.select(path, lists="standard")
    assert plain(standard) == told("select", path, "--from", "standard")
    if report.found:
        assert bs.Case(report["case"]).ball_diameter_mm == report["case"]["ball_diameter_mm"]


def same_table(ours: Path, theirs: Path) -> None:
    """Compare two files byte by byte. Parquet files of the program also contain the origin of the table."""
    if ours.suffix != ".parquet":
        assert ours.read_bytes() == theirs.read_bytes(), ours
        return
    one, other = pq.read_table(ours), pq.read_table(theirs)
    assert one.equals(other), ours
    # The schemas contain the units and the texts of the columns.
    assert all(a.metadata == b.metadata for a, b in zip(one.schema, other.schema, strict=True))


def numbers_of(table: bs.Nuts) -> list[str]:
    """Select the columns of a table, which contains no columns of texts, in a command."""
    return ["--columns", ",".join(table)]


def test_select_nuts_matches_the_command(tmp_path: Path) -> None:
    wanted = ["dynamic_load_rating_N>=40000", "lead_mm=10"]
    table = bs.select_nuts(where=wanted, pareto=True, sort="nut_mass_kg")
    options = [word for condition in wanted for word in ("--where", condition)]
    for ending in ("csv", "jsonl", "parquet"):
        ours, theirs = tmp_path / f"ours.{ending}", tmp_path / f"theirs.{ending}"
        table.write(ours)
        subprocess.run(
            [program(), "select", *options, "--pareto", "--sort", "nut_mass_kg", *numbers_of(table), "-o", theirs],
            check=True, capture_output=True,
        )
        same_table(ours, theirs)


def test_select_nuts_with_a_requirement_matches_the_command(tmp_path: Path) -> None:
    of_axis = EXAMPLES / "requirements" / "axis.json"
    table = bs.select_nuts(requirement=of_axis, where=["critical_speed_ratio<=0.5", "lead_mm>=20"], sort="mean_heat_W")
    assert 0 < len(table) and (table["critical_speed_ratio"] <= 0.5).all()
    ours, theirs = tmp_path / "ours.csv", tmp_path / "theirs.csv"
    table.write(ours)
    options = ["--where", "critical_speed_ratio<=0.5", "--where", "lead_mm>=20", "--sort", "mean_heat_W"]
    command: list[str | Path] = [program(), "select", of_axis, *options, *numbers_of(table), "-o", theirs]
    subprocess.run(command, check=True, capture_output=True)
    same_table(ours, theirs)


def picked(tmp_path: Path, *words: str | Path) -> dict[str, Any]:
    """Return the case that the program writes for the first nut."""
    path = tmp_path / "picked.json"
    subprocess.run([program(), "select", *words, "-o", path], capture_output=True, check=True)
    found: dict[str, Any] = json.loads(path.read_text())
    return found


def test_case_of_a_selected_catalog_nut_matches_the_command(tmp_path: Path) -> None:
    of_axis = EXAMPLES / "requirements" / "axis.json"
    lead = ["--where", "lead_mm=20", "--sort", "nut_mass_kg"]
    for requirement, words in ((None, lead), (of_axis, [*lead, of_axis])):
        nuts = bs.select_nuts(where=["lead_mm=20"], requirement=requirement, sort="nut_mass_kg", first=2)
        assert nuts.case().to_dict() == bs.Case(picked(tmp_path, *words)).to_dict()
        with pytest.raises(IndexError):
            nuts.case(2)
    assert bs.axis(nuts.case(-1))["results"]["critical_speed_ratio"] == nuts["critical_speed_ratio"][-1]


def test_nuts_of_a_manufacturer_match_the_command(tmp_path: Path) -> None:
    path, of_axis = EXAMPLES / "manufacturer_table.csv", EXAMPLES / "requirements" / "axis.json"
    words: list[str | Path] = []
    for requirement in (None, of_axis):
        words = [requirement] if requirement else []
        nuts = bs.select_nuts(manufacturers=path, requirement=requirement)
        rows = told("select", "--from", path, *words)
        expected = {name: [row[name] for row in rows] for name in rows[0]}
        if requirement:
            # `passes` is a boolean array, so a separate column marks undecided nuts, which are null in JSON.
            expected["undecided"] = [passes is None for passes in expected["passes"]]
            expected["passes"] = [bool(passes) for passes in expected["passes"]]
            # A column contains texts, not lists.
            expected["failed_rules"] = ["; ".join(failed) or None for failed in expected["failed_rules"]]
        assert nuts.to_dict() == expected
    assert nuts.case(0).to_dict() == bs.Case(picked(tmp_path, "--from", path, *words)).to_dict()
    # The table has a manufacturer's column names, an unused column, and a missing value.
    own = pd.read_csv(path).rename(columns={"nut": "Type", "stiffness_N_um": "K"}).assign(note="of a page")
    own["K"] = own["K"].where(own["Type"] != "R63-20K5-FSC")
    names = {"Type": "nut", "K": "stiffness_N_um", "note": None}
    plain_columns = {name: own[name].to_numpy() for name in own}
    for table in (own, pl.DataFrame(plain_columns), plain_columns):
        again = bs.select_nuts(manufacturers=table, columns_from=names, requirement=of_axis)
        assert again["nut"].tolist() == nuts["nut"].tolist()
        gap = again["nut"].tolist().index("R63-20K5-FSC")
        assert np.flatnonzero(np.isnan(again["stiffness_N_um"])).tolist() == [gap]
    assert again.to_arrow().to_pandas()["passes"].tolist() == again["passes"].tolist()
    assert pickle.loads(pickle.dumps(again)).to_dict() == again.to_dict()
    with pytest.raises(bs.InputError, match="column `Type` holds") as refused:
        bs.select_nuts(manufacturers=own)
    assert "columns_from" in refused.value.__notes__[0]
    misspelled = own.drop(columns=["Type", "note"]).rename(columns={"K": "stifness_N_um"})
    with pytest.raises(bs.InputError, match="unknown column `stifness_N_um`"):
        bs.select_nuts(manufacturers=misspelled)
    with pytest.raises(bs.InputError, match="only requirement and columns_from"):
        bs.select_nuts(manufacturers=path, pareto=True)


def test_nuts_with_only_ratings_have_intervals(tmp_path: Path) -> None:
    path = tmp_path / "lines.csv"
    head = "nut,nominal_diameter_mm,lead_mm,dynamic_load_rating_N,static_load_rating_N"
    path.write_text(f"{head}\nline,40,20,51300,144400\nmisprint,50,5,24900,10117\n")
    nuts = bs.select_nuts(manufacturers=path)
    rows = told("select", "--from", path)
    at = nuts["nut"].tolist().index("line")
    ends = [nuts[f"our_stiffness_{end}_N_um"][at] for end in ("low", "high")]
    assert ends == rows[at]["intervals"]["our_stiffness_N_um"]
    assert nuts["groove"].tolist() == [row["groove"] for row in rows]
    assert any("misprint" in text and "10 times" in text for text in nuts.warnings)
    assert nuts.to_arrow().num_rows == 2


def test_results_of_a_catalog_line_have_intervals_in_a_notebook() -> None:
    line = bs.Case(nominal_diameter_mm=40, lead_mm=20, rated_dynamic_load_N=51300, rated_static_load_N=144400,
                   axial_load_N=5130, screw_speed_rpm=500, friction_coefficient=0.08)
    report = bs.axis(line)
    numbers = ((bs.solve(line), "ball_torque_Nm"), (bs.nut(line), "max_pressure_MPa"), (report, "nut_heat_W"))
    for result, name in numbers:
        low, high = result.intervals[name]
        assert low < high
        assert re.search(r"<td>[0-9.]+ \([0-9.]+ to [0-9.]+\)", result._repr_html_())
    assert "groove estimated" in repr(report)
    assert "0.52 (0.51" in report._repr_html_() and " estimated</td>" in report._repr_html_()
    given = bs.axis(bs.Case(line, **{name: report["inputs"][name] for name in report["inputs"]["estimated_inputs"]}))
    assert given.intervals == {} and "estimated" not in repr(given)


def test_calculation_steps_of_a_rating_match_the_command(tmp_path: Path) -> None:
    path = EXAMPLES / "nut.json"
    nut, preload = bs.Case.read(path).replace(preload_N=4000), ("--set", "preload_N=4000")
    run = subprocess.run([program(), "solve", path, *preload, "--show", "steps", "-o", tmp_path / "rows.csv"], capture_output=True)
    assert run.returncode == 0, run.stderr
    rows = pd.read_csv(tmp_path / "rows.csv")
    steps = bs.ratings(nut)["steps"]
    assert len(steps) > 3
    assert list(steps.values()) == rows.iloc[-len(steps):, -1].tolist()


def test_validate_matches_the_command() -> None:
    table = bs.validate()
    ours = bs.validate(data=EXAMPLES.parent / "validation" / "published")
    assert ours.to_dict() == table.to_dict()
    verdicts = table["verdict"].tolist()
    assert len(verdicts) > 300 and "fail" not in verdicts
    assert verdicts == [check["verdict"] for check in told("validate")["checks"]]


def test_file_of_a_sweep_is_identical_to_the_file_of_the_program(tmp_path: Path) -> None:
    path = EXAMPLES / "feed_drive.json"
    grid = bs.sweep(
        bs.Case.read(path),
        vary={"screw_speed_rpm": bs.linspace(100, 6000, 300), "axial_load_kN": [2, 4, 8]},
        columns=["efficiency", "controlling_raceway"],
        text=True,
    )
    options = ["--vary", "screw_speed_rpm=100:6000:300", "--vary", "axial_load_kN=2,4,8"]
    options += ["--columns", "efficiency,controlling_raceway", "--quiet"]
    for ending in ("csv", "jsonl", "parquet"):
        ours, theirs = tmp_path / f"ours.{ending}", tmp_path / f"theirs.{ending}"
        grid.write(ours)
        subprocess.run([program(), "sweep", path, *options, "-o", theirs], check=True, capture_output=True)
        same_table(ours, theirs)


@pytest.mark.parametrize("model", ["rigid", "auto"])
def test_file_of_solved_table_points_is_identical_to_the_file_of_the_program(tmp_path: Path, model: str) -> None:
    path = EXAMPLES / "feed_drive.json"
    # The table has more rows than a chunk of the kernels, or fewer rows for a model that solves them one by one.
    rows = 70_000 if model == "rigid" else 3_000
    draws = np.random.default_rng(3)
    points = {
        "screw_speed_rpm": draws.uniform(100, 1500, rows),
        "axial_load_kN": draws.uniform(2, 8, rows),
    }
    # Invalid rows must keep their position and state the reason.
    points["axial_load_kN"][[1, 100, rows - 1]] = -1.0
    names = [f"point {row}" for row in range(rows)]
    outputs = ["efficiency", "ball_torque_Nm", "controlling_raceway"]
    table = bs.solve_many({**points, "name": names}, bs.Case.read(path), model=model, columns=outputs, keep=["name"], text=True)  # type: ignore[arg-type]
    assert table.ok.sum() == rows - 3
    given = zip(*points.values(), names, strict=True)
    lines = [",".join([*points, "name"]), *(f"{float(a)!r},{float(b)!r},{name}" for a, b, name in given)]
    (tmp_path / "points.csv").write_text("\n".join(lines) + "\n")
    options: list[str | Path] = [path, "--model", model, "--columns", ",".join(outputs), "--keep", "name", "--keep-going", "--quiet"]
    for ending in ("csv", "jsonl", "parquet"):
        ours, theirs = tmp_path / f"ours.{ending}", tmp_path / f"theirs.{ending}"
        table.write(ours)
        command = [program(), "sweep", "--points", tmp_path / "points.csv", *options, "-o", theirs]
        subprocess.run(command, check=True, capture_output=True)
        same_table(ours, theirs)
