"""Tests that the package is consistent with itself."""

from __future__ import annotations

import contextlib
import copy
import math
import multiprocessing
import os
import pickle
import signal
import subprocess
import sys
import threading
import time
from array import array
from pathlib import Path
from typing import Any

import numpy as np
import polars as pl
import pytest
from conftest import EXAMPLES, program
from hypothesis import given, settings
from hypothesis import strategies as st

import ballscrew as bs
from ballscrew._vocabulary import SECTIONS, Model, Output

FEED_DRIVE = EXAMPLES / "feed_drive.json"


@pytest.fixture(scope="module")
def screw() -> bs.Case:
    return bs.Case.read(FEED_DRIVE)


def random_points(rows: int, seed: int) -> dict[str, np.ndarray]:
    rng = np.random.default_rng(seed)
    return {
        "screw_speed_rpm": rng.uniform(10, 5000, rows),
        "axial_load_N": rng.uniform(500, 20000, rows),
        "friction_coefficient": rng.uniform(0.01, 0.06, rows),
    }


# Cases


def test_a_case_round_trips_through_json_and_pickle(screw: bs.Case) -> None:
    for other in (
        bs.Case.from_json(screw.to_json()),
        bs.Case(screw.to_dict()),
        bs.Case(**screw),
        pickle.loads(pickle.dumps(screw)),
        copy.copy(screw),
        eval(repr(screw), {"Case": bs.Case}),
    ):
        assert other == screw
        assert hash(other) == hash(screw)
    assert screw.replace(lead_mm=10) != screw


def test_setting_the_lead_angle_of_a_case_removes_its_lead(screw: bs.Case) -> None:
    other = screw.replace(lead_angle_deg=5.0)
    assert other.lead_mm is None and other.lead_angle_deg == 5.0


def test_screw_torque_attribute_equals_the_screw_torque_in_the_report(screw: bs.Case) -> None:
    loaded = screw.replace(seal_torque_Nm=0.2)
    solution = bs.solve(loaded)
    assert solution.screw_torque_Nm == solution.to_dict()["torque_parts"]["screw_torque_Nm"]
    assert solution.screw_torque_Nm > solution.ball_torque_Nm
    table = bs.solve_many({"axial_load_N": [loaded.axial_load_N]}, loaded, columns=["screw_torque_Nm"])
    # A table row and a single solve agree to within 1e-10.
    assert table["screw_torque_Nm"][0] == pytest.approx(solution.screw_torque_Nm, rel=1e-10)


def test_error_of_the_screw_torque_names_the_input_that_causes_it(screw: bs.Case) -> None:
    # The model of one ball does not use the circuits of the preloaded nut, but the screw torque does.
    solution = bs.solve(screw, preload_N=1000, circuits_count=1000)
    for _ in range(2):
        with pytest.raises(bs.InputError, match="without a ball") as caught:
            _ = solution.screw_torque_Nm
        assert caught.value.key == "loaded_balls_per_turn"


def test_random_points_equal_the_random_points_of_the_program(screw: bs.Case, tmp_path: Path) -> None:
    points = bs.draw({"axial_load_N": bs.uniform(1e3, 2e4), "friction_coefficient": bs.normal(0.06, 0.01)}, 50, seed=7)
    table = bs.solve_many(points, screw, columns=["efficiency"], text=True)
    screw.write(tmp_path / "screw.json")
    assert bs.Case.read(tmp_path / "screw.json") == screw
    options = ["--draw", "axial_load_N=uniform:1000:20000", "--draw", "friction_coefficient=normal:0.06:0.01", "--samples", "50",
               "--seed", "7", "--columns", "efficiency", "--quiet", "--keep-going"]
    subprocess.run([program(), "sweep", tmp_path / "screw.json", *options, "-o", tmp_path / "of.csv"], check=True)
    table.write(tmp_path / "ours.csv")
    assert (tmp_path / "ours.csv").read_bytes() == (tmp_path / "of.csv").read_bytes()


def test_every_input_is_a_property(screw: bs.Case) -> None:
    given = screw.to_dict()
    for name in bs.INPUTS:
        assert getattr(screw, name) == given.get(name), name


def test_cases_are_immutable(screw: bs.Case) -> None:
    with pytest.raises(AttributeError):
        screw.lead_mm = 3.0  # type: ignore[misc]


def test_none_removes_inputs_of_every_kind(screw: bs.Case) -> None:
    named = screw.replace(description="feed drive", support="fixed-fixed")
    bare = named.replace(description=None, support=None, friction_coefficient=None)
    assert set(named) - set(bare) == {"description", "support", "friction_coefficient"}
    assert bs.Case({"lead_mm": None}, pitch_circle_diameter_mm=40.0) == bs.Case(pitch_circle_diameter_mm=40.0)
    with pytest.raises(bs.InputError, match="lead_mm"):
        bs.Case(lead_mn=None)  # type: ignore[call-arg]


def test_inputs_may_be_arrays_and_scalars_of_numpy(screw: bs.Case) -> None:
    deviations = np.array([0.5, -0.5])
    assert screw.replace(ball_deviation_um=deviations).ball_deviation_um == [0.5, -0.5]
    assert screw.replace(axial_load_kN=np.int64(8)).axial_load_N == 8000.0  # type: ignore[arg-type]


@pytest.mark.parametrize("value", [math.nan, math.inf, np.float64("nan")])
def test_numbers_that_are_not_finite_are_rejected_at_any_depth(value: float) -> None:
    """JSON cannot represent NaN and infinity. Converted to null, they would be treated as missing inputs."""
    for inputs in ({"axial_load_N": value}, {"axial_load_kN": value}, {"ball_deviation_um": [0.0, value]},
                   {"cycle": [{"distance_mm": 100, "force_N": value}]}):
        with pytest.raises(bs.InputError, match="finite") as caught:
            bs.Case(inputs)
        assert caught.value.key in inputs


# Errors


def test_an_error_for_an_unknown_input_names_the_nearest_input() -> None:
    with pytest.raises(bs.InputError, match="lead_mm") as caught:
        bs.Case(lead_mn=3)  # type: ignore[call-arg]
    assert (caught.value.key, caught.value.nearest) == ("lead_mn", "lead_mm")


def test_error_for_an_invalid_input_states_key_and_value_and_permitted_range() -> None:
    with pytest.raises(bs.InputError) as caught:
        bs.Case(ball_diameter_mm=-1)
    error = caught.value
    assert (error.key, error.value, error.rule) == ("ball_diameter_mm", -1.0, "a finite number > 0")
    assert isinstance(error, ValueError)


def test_error_names_the_missing_inputs() -> None:
    with pytest.raises(bs.InputError, match="friction_coefficient"):
        bs.solve(model="closed-form", contact_angle_deg=45, lead_angle_deg=8)


@pytest.mark.parametrize("value", ["6.35", True, [1.0, 2.0], object()])
def test_values_that_are_not_numbers_are_rejected(value: object) -> None:
    with pytest.raises(bs.InputError) as caught:
        bs.Case(ball_diameter_mm=value)  # type: ignore[arg-type]
    assert caught.value.key == "ball_diameter_mm"


def test_a_point_without_solution_raises_an_error_with_the_solution(screw: bs.Case) -> None:
    # The screw is self-locking, because its lead is too small for this friction coefficient.
    locked = screw.replace(lead_angle_deg=0.5, friction_coefficient=0.3)
    answer = bs.solve(locked, model="rigid", check=False)
    assert answer.status == "no_solution" and math.isnan(answer.efficiency)
    with pytest.raises(bs.NoSolutionError) as caught:
        bs.solve(locked, model="rigid")
    assert caught.value.solution.to_dict() == answer.to_dict()
    assert str(answer.message) in str(caught.value)


def test_error_for_an_invalid_value_states_the_row_number(screw: bs.Case) -> None:
    with pytest.raises(bs.InputError) as caught:
        bs.solve_many({"axial_load_N": [2e3, "much", 8e3]}, screw)
    assert (caught.value.key, caught.value.row) == ("axial_load_N", 1)
    with pytest.raises(bs.InputError) as caught:
        bs.gradient({"axial_load_N": [2e3, 8e3, -1.0]}, "efficiency", ["lead_mm"], screw)
    assert (caught.value.key, caught.value.value, caught.value.row) == ("axial_load_N", -1.0, 2)
    with pytest.raises(bs.InputError) as caught:
        bs.Case(screw, axial_load_N=-1)
    assert caught.value.row is None


def test_table_contains_the_reasons_for_the_model_choice_of_auto_on_request(screw: bs.Case) -> None:
    points = {"axial_load_N": [8e3, -1.0]}
    quiet, told = (bs.solve_many(points, screw, text=text) for text in (False, True))
    assert quiet.message(0) is None and "the ball rolls (skid onset" in (told.message(0) or "")
    assert quiet.message(1) == told.message(1) and quiet.message(1)


# One point


def test_every_output_is_a_property(screw: bs.Case) -> None:
    answer = bs.solve(screw, model="traction")
    values = answer.to_dict()
    for name, quantity in bs.OUTPUTS.items():
        if quantity.analysis is None:
            value = getattr(answer, name)
            missing = isinstance(value, float) and math.isnan(value)
            assert (None if missing else value) == values[name], name


def test_representations_of_objects_are_short_and_escape_html(screw: bs.Case) -> None:
    named = bs.Case(screw, description="<b>a & b</b>")
    assert "<b>" not in named._repr_html_() and "&lt;b&gt;" in named._repr_html_()
    table = bs.solve_many(random_points(1000, 1), screw)
    for shown in (named._repr_html_(), bs.solve(screw)._repr_html_(), table._repr_html_()):
        assert len(shown) < 20_000
    assert "efficiency" in repr(bs.solve(screw))


def test_representation_of_a_report_shows_its_content() -> None:
    """Regression test: a notebook showed only whether an axis satisfies its rules."""
    shown = bs.axis(bs.Case.read(EXAMPLES / "axis.json"))._repr_html_()
    assert "buckling_safety" in shown and "screw_mass_kg" in shown and len(shown) < 20_000
    shown = bs.select(EXAMPLES / "requirements" / "axis.json")._repr_html_()
    assert "<th>step</th>" in shown and "ball_diameter_mm" in shown and len(shown) < 20_000


def reports() -> list[bs.Report]:
    case = {name: bs.Case.read(EXAMPLES / f"{name}.json") for name in ("feed_drive_oil", "jamming", "nut", "axis")}
    dry = bs.Case.read(FEED_DRIVE)
    return [bs.slip(case["feed_drive_oil"]), bs.jam(case["jamming"]), bs.optimum(dry, model="rigid"), bs.ratings(case["nut"]),
            bs.nut(case["nut"]), bs.axis(case["axis"])]


def properties(section: bs.Section) -> dict[str, property]:
    """Return the properties that are generated from the tables of the program."""
    of_vocabulary = [base for base in type(section).__mro__ if base in SECTIONS]
    return {name: value for base in of_vocabulary for name, value in vars(base).items() if isinstance(value, property)}


def test_every_number_in_a_report_is_a_typed_and_documented_attribute() -> None:
    for report in reports():
        entries = report["results"] if isinstance(report, bs.AxisReport) else report
        sections: list[tuple[bs.Section, Any]] = [(report, entries)]
        if isinstance(report, bs.AxisReport):
            sections += [(report.screw, report["screw"]), (report.phases[0], report["phases"][0])]
        if isinstance(report, bs.RatingsReport):
            sections.append((report.steps, report["steps"]))
        if isinstance(report, bs.OptimumReport):
            assert report.by_model is not None
            sections.append((report.by_model, report["by_model"]))
        for section, values in sections:
            found = properties(section)
            assert len(found) > 1
            for name, attribute in found.items():
                # A property without an entry in the program's report would raise a KeyError.
                assert getattr(section, name) == values[name]
                assert attribute.fget is not None and attribute.__doc__
                assert isinstance(values[name], attribute.fget.__annotations__["return"]), name
            numbers = {name for name, value in values.items() if isinstance(value, float) and name in bs.OUTPUTS}
            assert numbers <= set(found), type(section)


def test_error_for_a_misspelled_report_attribute_suggests_the_nearest_attribute() -> None:
    sheet: Any = reports()[-1]
    with pytest.raises(AttributeError, match="did you mean `critical_speed_rpm`"):
        str(sheet.critical_sped_rpm)


def test_reports_can_be_pickled_and_copied() -> None:
    for report in reports():
        for again in (pickle.loads(pickle.dumps(report)), copy.copy(report)):
            assert type(again) is type(report) and again == report
            assert (again.found, again.warnings) == (report.found, report.warnings)


def test_rows_of_reports_are_typed_named_tuples(screw: bs.Case) -> None:
    axis = bs.axis(bs.Case.read(EXAMPLES / "axis.json"))
    assert [rule._asdict() for rule in axis.rules] == axis["rules"]
    assert axis.passes == all(rule.passes for rule in axis.rules) == axis.found
    assert [lack._asdict() for lack in axis.not_given] == axis["not_given"]
    assert bs.axis(axis.case).critical_speed_rpm == axis.critical_speed_rpm
    selected = bs.select(EXAMPLES / "requirements" / "axis.json")
    assert [step._asdict() for step in selected.steps] == selected["steps"]
    assert selected.case.to_dict() == selected["case"]
    nut, _ = bs.ellipses(screw).contacts
    assert np.nanmax(nut.pressure_MPa) == nut.max_pressure_MPa
    fit = bs.fit(screw, {"screw_torque_Nm": 26.0}, model="raceway-control")
    assert fit.fitted == [row["friction_coefficient"] for row in fit["found"]] and len(fit.fitted) == 1
    limit = bs.fit(axis.case, limit="critical speed", inputs="feed_m_min")
    assert limit.kept == [tuple(ends) for ends in limit["kept"]] and limit.kept
    points = {"contact_angle_deg": [40, 45, 50], "efficiency": [0.86, 0.87, 0.88]}
    fitted = bs.fit(bs.Case(lead_angle_deg=5, contact_angle_deg=45), "efficiency", points=points, model="closed-form")
    assert fitted.fitted["friction_coefficient"]._asdict() == fitted["found"]["friction_coefficient"]
    assert [point._asdict() for point in fitted.points] == fitted["points"]


def test_common_mistakes_get_helpful_messages(screw: bs.Case) -> None:
    points: Any = {"screw_speed_rpm": [100.0, 200.0]}
    with pytest.raises(bs.InputError, match=r"columns takes a list of names, such as \['efficiency'\]"):
        bs.solve_many(points, screw, columns="efficiency")  # type: ignore[arg-type]
    with pytest.raises(bs.InputError, match="wrt takes a list"):
        bs.gradient(points, "efficiency", "lead_mm", screw)
    with pytest.raises(bs.InputError, match=r"`lead_mm` is 10; give a list of values, such as \[10\]"):
        bs.sweep(screw, vary={"lead_mm": 10})  # type: ignore[dict-item]
    with pytest.raises(bs.InputError, match=r"give linspace\(1, 9, 3\) for a range, \[1, 9, 3\] for three values"):
        bs.sweep(screw, vary={"lead_mm": (1, 9, 3)})
    with pytest.raises(bs.InputError, match="`lead_mm` has a range of 1 values, but must have at least 2"):
        bs.sweep(screw, vary={"lead_mm": bs.linspace(5, 20, 1)})
    with pytest.raises(bs.InputError, match="low < high"):
        bs.draw({"lead_mm": bs.uniform(20, 5)}, samples=1)
    with pytest.raises(bs.InputError, match="the value must be finite"):
        bs.fit(screw, {"screw_torque_Nm": math.inf})
    with pytest.raises(bs.InputError, match="0.2 to 0.1 is not"):
        bs.fit(screw, {"screw_torque_Nm": 26.0}, inputs={"friction_coefficient": (0.2, 0.1)})
    with pytest.raises(bs.InputError, match='neither "manufacturers" nor "standard"'):
        bs.select_nuts("thk")
    with pytest.raises(TypeError, match="there is no keyword `tolerence`, did you mean `tolerance`"):
        bs.solve_many(points, screw, tolerence=1e-3)  # type: ignore[call-arg]
    with pytest.raises(bs.InputError, match=r"to read a case file, use Case.read\(path\)"):
        bs.solve("examples/feed_drive.json")  # type: ignore[arg-type]
    for frame in ({**points, "name": ["a", "b"]}, pl.DataFrame({**points, "name": ["a", "b"]})):
        with pytest.raises(bs.InputError, match="column `name` holds") as refused:
            bs.solve_many(frame, screw)
        assert "keep=" in refused.value.__notes__[0]
    for wrong, word in ((bs.uniform(1.0, 2.0), "is random; draw"), (["a"], "is not a number")):
        with pytest.raises(bs.InputError, match=word):
            bs.solve_many({"axial_load_N": wrong}, screw)
    with pytest.raises(bs.InputError, match="is random"):
        bs.sweep(screw, vary={"axial_load_N": bs.normal(1.0, 2.0)})
    assert bs.solve_many({"axial_load_N": bs.linspace(1e3, 2e3, 3)}, screw)["axial_load_N"].tolist() == [1e3, 1.5e3, 2e3]
    with pytest.raises(bs.InputError, match="model is 3, but must be a text"):
        bs.solve(screw, model=3)  # type: ignore[arg-type]
    with pytest.raises(bs.InputError, match="unknown key `modle`, did you mean `model`"):
        bs.solve(screw, modle="rigid")  # type: ignore[call-arg]
    with pytest.raises(bs.InputError, match="`lead_angle_deg` has no value in this case: lead_mm is given"):
        bs.gradient(points, "efficiency", ["lead_angle_deg"], screw)
    with pytest.raises(bs.InputError, match="did you mean `efficiency`"):
        bs.gradient(points, "efficency", ["lead_mm"], screw)  # type: ignore[arg-type]
    with pytest.raises(KeyError, match=r"is an entry of \['results'\]"):
        bs.axis(bs.Case.read(EXAMPLES / "axis.json"))["critical_speed_rpm"]
    with pytest.raises(KeyError) as caught:
        bs.solve_many(points, screw)["regime"]
    assert len(str(caught.value)) < 300
    assert bs.select(axial_load_N=4000, screw_speed_rpm=1500, stroke_mm=600, friction_coefficient=0.05).found


# Many points


@pytest.mark.parametrize("model", bs.MODELS)
def test_many_points_match_single_solves(screw: bs.Case, model: str) -> None:
    points = random_points(40, 7)
    table = bs.solve_many(points, screw, model=model)  # type: ignore[arg-type]
    for row in range(len(table)):
        point = bs.Case(screw.to_dict() | {name: float(values[row]) for name, values in points.items()})
        answer = bs.solve(point, model=model, check=False)  # type: ignore[arg-type]
        assert table.status[row] == answer.status
        if answer.converged:
            # The program guarantees that a row and a single solve of the same inputs agree to this accuracy.
            assert table["efficiency"][row] == pytest.approx(answer.efficiency, rel=1e-10)


def test_every_kind_of_dataframe_gives_the_same_results(screw: bs.Case) -> None:
    pl, pa, pd = (pytest.importorskip(name) for name in ("polars", "pyarrow", "pandas"))
    points = random_points(1000, 5)
    expected = bs.solve_many(points, screw, columns=["efficiency"])
    batches = pa.Table.from_batches(pa.table(points).to_batches(max_chunksize=77))
    backwards = dict(reversed(points.items()))
    for frame in (pl.DataFrame(points), pa.table(points), pd.DataFrame(points), batches, backwards):
        for threads in (1, 2):
            table = bs.solve_many(frame, screw, columns=["efficiency"], threads=threads)
            assert table["efficiency"].tobytes() == expected["efficiency"].tobytes()


def test_exported_dataframes_have_the_same_content_as_the_table(screw: bs.Case) -> None:
    pytest.importorskip("polars"), pytest.importorskip("pyarrow"), pytest.importorskip("pandas")
    outputs = ["efficiency", "controlling_raceway", "self_locking"]
    table = bs.solve_many(random_points(300, 9), screw, model="raceway-control", columns=outputs)  # type: ignore[arg-type]
    polars, arrow, pandas = table.to_polars(), table.to_arrow(), table.to_pandas()
    assert polars.columns == arrow.column_names == list(pandas.columns) == table.column_names
    for found in (polars["efficiency"].to_numpy(), arrow["efficiency"].to_numpy(), pandas["efficiency"].to_numpy()):
        assert np.array_equal(found, table["efficiency"], equal_nan=True)
    raceways = [None if raceway is None else str(raceway) for raceway in polars["controlling_raceway"]]
    assert raceways == table["controlling_raceway"].tolist() == table.to_dict()["controlling_raceway"] and {*raceways} <= {"nut", "screw", None}
    assert [raceway if isinstance(raceway, str) else None for raceway in pandas["controlling_raceway"]] == raceways
    assert polars["self_locking"].sum() == 0
    assert arrow.schema.field("axial_load_N").metadata == {b"unit": b"N"}
    assert list(pandas["model"].cat.categories) == list(bs.MODELS)


def test_pandas_dataframes_are_accepted_without_pyarrow(screw: bs.Case) -> None:
    pd = pytest.importorskip("pandas")

    class Alone:
        """Frame whose Arrow stream needs a library that is not installed."""

        def __init__(self, frame: Any) -> None:
            self.frame, self.columns = frame, frame.columns

        def __getitem__(self, name: str) -> Any:
            return self.frame[name]

        def __arrow_c_stream__(self, requested_schema: object = None) -> object:
            raise ImportError("pyarrow is required")

    full = pd.DataFrame({"name": ["a", "b", "c"], "axial_load_N": [2000, 8000, math.nan], "screw_speed_rpm": [1, 2, 3]})
    frame = Alone(full)
    for missing in ("invalid", "base"):
        ours = bs.solve_many(frame, screw, keep=["name"], missing=missing)
        same = bs.solve_many(full, screw, keep=["name"], missing=missing)
        assert repr(ours.to_dict()) == repr(same.to_dict())


def test_columns_copied_from_the_input_keep_their_types(tmp_path: Path, screw: bs.Case) -> None:
    """Regression test: a copied id and a copied date were converted to texts."""
    import datetime

    pl = pytest.importorskip("polars")
    pa = pytest.importorskip("pyarrow")
    day = datetime.date(2026, 11, 23)
    kept = {
        "id": pl.Series([1 << 60, None, 3], dtype=pl.Int64),
        "small": pl.Series([1, 2, 3], dtype=pl.UInt8),
        "day": [day, None, day],
        "at": pl.Series([datetime.datetime(2026, 1, 2, 3, 4, 5, 600)] * 3),
        "good": [True, False, True],
        "share": pl.Series([0.5, 1.5, 2.5], dtype=pl.Float32),
        "word": ["a", None, ""],
    }
    frame = pl.DataFrame({**kept, "axial_load_N": [2000.0, 3000.0, 4000.0]})
    table = bs.solve_many(frame, screw, keep=list(kept), columns=["efficiency"])
    for again in (table, pickle.loads(pickle.dumps(table)), bs.solve_many(table, screw, keep=list(kept), columns=["efficiency"])):
        assert again.to_polars().select(list(kept)).equals(frame.select(list(kept)))
        assert again.to_polars().schema["small"] == pl.UInt8 and again.to_polars().schema["share"] == pl.Float32
    assert table["id"].tolist() == [1 << 60, None, 3] and table["small"].dtype == np.int64
    assert table["day"].dtype.kind == "M" and np.isnat(table["day"][1]) and table["good"].dtype == bool
    assert table["share"].tolist() == [0.5, 1.5, 2.5] and table["word"].tolist() == ["a", None, ""]
    assert table.to_pandas()["good"].tolist() == [True, False, True]
    table.write(tmp_path / "t.parquet")
    assert pl.read_parquet(tmp_path / "t.parquet").select(list(kept)).equals(frame.select(list(kept)))
    arrow = pa.table({"id": pa.array([7, 8], pa.int32()), "tag": pa.array(["x", "y"]).dictionary_encode(), "axial_load_N": [2e3, 3e3]})
    out = bs.solve_many(arrow, screw, keep=["id", "tag"], columns=["efficiency"]).to_arrow()
    assert out.schema.field("id").type == pa.int32() and out.column("tag").to_pylist() == ["x", "y"]
    # NumPy arrays must also keep their types.
    points = {"axial_load_N": [2e3, 3e3], "n": np.array([5, 6], np.int16), "t": np.array(["2026-01-01", "NaT"], "datetime64[D]")}
    out = bs.solve_many(points, screw, keep=["n", "t"], columns=["efficiency"]).to_polars()
    assert out.schema["n"] == pl.Int64 and out["t"].null_count() == 1 and out["n"].to_list() == [5, 6]
    with pytest.raises(bs.InputError, match="lists, maps or structures"):
        bs.solve_many(pl.DataFrame({"l": [[1], [2]], "axial_load_N": [2e3, 3e3]}), screw, keep=["l"])


def test_nan_in_a_table_is_not_replaced_by_the_value_of_the_base_case(screw: bs.Case) -> None:
    pl = pytest.importorskip("polars")
    frame = pl.DataFrame({"axial_load_N": [8000.0, None, math.nan]})
    table = bs.solve_many(frame, screw)
    assert table["status"].tolist() == ["converged", "invalid_input", "invalid_input"]
    assert "axial_load_N" in (table.message(1) or "")
    table = bs.solve_many(frame, screw, missing="base")
    assert table["status"].tolist() == ["converged", "converged", "invalid_input"]


def test_arrays_of_every_type_and_layout_are_accepted(screw: bs.Case) -> None:
    loads = np.arange(2000, 12000, 500)
    expected = bs.solve_many({"axial_load_N": loads.astype(float)}, screw)["efficiency"].tobytes()
    wide = np.zeros((len(loads), 2))
    wide[:, 0] = loads
    frozen = loads.astype(float)
    frozen.flags.writeable = False
    # The last form is the form in which MATLAB passes an array.
    forms = (loads, wide[:, 0], loads.astype(">f8"), frozen, loads.tolist(), np.ma.masked_array(loads), array("d", loads))
    for form in forms:
        assert bs.solve_many({"axial_load_N": form}, screw)["efficiency"].tobytes() == expected
    with pytest.raises(bs.InputError, match="dimensions"):
        bs.solve_many({"axial_load_N": wide}, screw)
    with pytest.raises(bs.InputError, match="rows"):
        bs.solve_many({"axial_load_N": loads, "screw_speed_rpm": loads[:3]}, screw)
    with pytest.raises(bs.InputError, match="axial_load_N"):
        bs.solve_many({"axial_lod_N": loads}, screw)


def test_tables_can_be_pickled(screw: bs.Case) -> None:
    points = random_points(300, 11)
    points["axial_load_N"][7] = -1.0
    grid = bs.sweep(screw, vary={"screw_speed_rpm": [500.0, 1500.0]}, columns=["efficiency"])
    for table in (bs.solve_many(points, screw, columns=["efficiency"]), grid, bs.compare(screw)):
        other = pickle.loads(pickle.dumps(table))
        assert type(other) is type(table) and other.column_names == table.column_names
        # The texts are compared, because NaN is not equal to itself.
        assert repr(other.to_dict()) == repr(table.to_dict()) and other.units == table.units
        assert other.message(0) == table.message(0)
    table = pickle.loads(pickle.dumps(bs.solve_many(points, screw, columns=["efficiency"])))
    assert "axial_load_N" in table.message(7) and table.status[7] == "invalid_input"
    assert other["efficiency"].flags.writeable is False


def _solved(load: float) -> bs.Solution:
    return bs.solve(bs.Case.read(FEED_DRIVE), axial_load_N=load)


def _unsolved(friction: float) -> bs.Solution:
    case = bs.Case.read(FEED_DRIVE)
    return bs.solve(case, model="rigid", lead_angle_deg=0.5, friction_coefficient=friction)


def test_results_are_equal_after_passing_between_processes(screw: bs.Case) -> None:
    solution = bs.solve(screw, model="traction", accuracy=1e-6)
    for other in (pickle.loads(pickle.dumps(solution)), copy.copy(solution), copy.deepcopy(solution)):
        assert type(other) is bs.Solution and other == solution and hash(other) == hash(solution)
        assert other.to_dict() == solution.to_dict()
    assert solution != bs.solve(screw, model="traction") and solution != object()
    points = random_points(50, 3)
    table, grid = bs.solve_many(points, screw), bs.sweep(screw, vary={"screw_speed_rpm": [500.0, 1500.0]})
    report = bs.slip(screw)
    for result in (table, grid, report):
        assert pickle.loads(pickle.dumps(result)) == result and copy.deepcopy(result) == result
    assert table != grid and grid != bs.sweep(screw, vary={"screw_speed_rpm": [500.0, 1600.0]})
    with multiprocessing.get_context("spawn").Pool(2) as pool:
        assert pool.map(_solved, [4000.0, 8000.0]) == [_solved(4000.0), _solved(8000.0)]
        with pytest.raises(bs.NoSolutionError) as caught:
            pool.map(_unsolved, [0.3])
        assert caught.value.solution.status == "no_solution"


def test_none_removes_an_input(screw: bs.Case) -> None:
    assert screw.friction_coefficient is not None
    bare = screw.replace(friction_coefficient=None)
    assert bare.friction_coefficient is None and bare.axial_load_N == screw.axial_load_N
    with pytest.raises(bs.InputError, match="friction_coefficient"):
        bs.solve(screw, friction_coefficient=None)


def test_an_error_for_a_misspelled_output_names_the_nearest_output(screw: bs.Case) -> None:
    with pytest.raises(AttributeError, match="did you mean `efficiency`"):
        _ = bs.solve(screw).effciency  # type: ignore[attr-defined]
    table = bs.sweep(screw, vary={"screw_speed_rpm": [500.0, 1500.0]}, columns=["efficiency"])
    with pytest.raises(KeyError, match="did you mean `efficiency`"):
        table["efficency"]
    with pytest.raises(TypeError, match="to_pandas"):
        np.asarray(table)


@pytest.mark.parametrize("rows", [0, 1])
def test_tables_may_have_no_row_or_one_row(screw: bs.Case, rows: int) -> None:
    table = bs.solve_many({"axial_load_N": np.full(rows, 8000.0)}, screw)
    assert len(table) == rows == len(table["efficiency"]) == len(table.status)


def test_column_views_are_read_only_and_remain_valid_after_their_table_is_deleted(screw: bs.Case) -> None:
    table = bs.solve_many(random_points(5000, 2), screw, model="rigid", columns=["efficiency"])
    view = table["efficiency"]
    kept = view.copy()
    del table
    assert np.array_equal(view, kept, equal_nan=True)
    with pytest.raises(ValueError, match="read-only"):
        view[0] = 1.0


def test_arrays_of_doubles_are_not_copied(screw: bs.Case) -> None:
    loads = np.full(500, 8000.0)
    table = bs.solve_many({"axial_load_N": loads}, screw)
    assert np.shares_memory(table["axial_load_N"], loads)
    assert loads.flags.writeable and not table["axial_load_N"].flags.writeable


def test_an_error_for_an_unknown_output_names_the_nearest_output(screw: bs.Case) -> None:
    with pytest.raises(bs.InputError) as caught:
        bs.solve_many({"axial_load_N": [1.0]}, screw, columns=["efficency"])  # type: ignore[list-item]
    assert caught.value.nearest == "efficiency"


@settings(max_examples=200, derandomize=True, deadline=None)
@given(
    load=st.floats(1.0, 1e5),
    speed=st.floats(1.0, 1e4),
    friction=st.floats(1e-3, 0.2),
)
def test_efficiency_is_the_ratio_of_output_power_to_input_power(load: float, speed: float, friction: float) -> None:
    answer = bs.solve(
        bs.Case.read(FEED_DRIVE), model="raceway-control", check=False, axial_load_N=load, screw_speed_rpm=speed,
        friction_coefficient=friction,
    )
    if answer.converged:
        # Both values come from the same solve, so they differ only by rounding errors.
        assert answer.efficiency == pytest.approx(answer.output_power_W / answer.input_power_W, rel=1e-12)


# Grids


def test_a_grid_has_labeled_axes(screw: bs.Case) -> None:
    xr = pytest.importorskip("xarray")
    vary = {"screw_speed_rpm": bs.linspace(100, 3000, 5), "axial_load_N": [2e3, 8e3, 1.6e4]}
    grid = bs.sweep(screw, vary=vary, columns=["efficiency"])
    assert grid.shape == (5, 3) == grid.grid("efficiency").shape
    data = grid.to_xarray()
    assert isinstance(data, xr.Dataset) and data["efficiency"].dims == ("screw_speed_rpm", "axial_load_N")
    point = screw.replace(screw_speed_rpm=100 + 2900 / 4 * 2, axial_load_N=8e3)
    found = float(data["efficiency"].sel(axial_load_N=8e3)[2])
    assert found == pytest.approx(bs.solve(point).efficiency, rel=1e-10)
    frame = grid.to_pandas()
    assert list(frame.columns[:2]) == list(vary) and len(frame) == 15
    assert frame["axial_load_N"].tolist()[:3] == [2e3, 8e3, 1.6e4]


def test_grid_axes_are_columns_of_tables_dataframes_and_notebook_views(screw: bs.Case) -> None:
    """Regression test: notebooks showed rows without the coordinates of their points."""
    vary = {"screw_speed_rpm": [500.0, 1500.0, 3000.0], "axial_load_N": [2e3, 8e3]}
    grid = bs.sweep(screw, vary=vary, columns=["efficiency"])
    names = ["screw_speed_rpm", "axial_load_N", "model", "status", "message", "efficiency"]
    assert grid.column_names == list(grid) == list(grid.to_pandas()) == grid.to_polars().columns == names
    assert grid["screw_speed_rpm"].tolist() == [500.0, 500.0, 1500.0, 1500.0, 3000.0, 3000.0]
    assert grid["axial_load_N"].tolist() == [2e3, 8e3] * 3
    shown = grid._repr_html_()
    assert "<th>screw_speed_rpm</th><th>axial_load_N</th><th>model</th>" in shown and "<td>3000</td><td>8000</td>" in shown
    again = bs.solve_many(grid, screw, columns=["efficiency"])
    assert again["efficiency"].tobytes() == grid["efficiency"].tobytes()


# Selection


def test_tables_select_columns_and_rows_like_dataframes(screw: bs.Case) -> None:
    points = {"axial_load_N": [2e3, -1.0, 8e3, 9e3], "name": ["a", "b", None, "d"], "day": np.array(["2026-01-01"] * 4, "datetime64[us]")}
    table = bs.solve_many(points, screw, keep=["name", "day"], columns=["efficiency", "controlling_raceway"])
    assert table[["name", "efficiency"]].column_names == ["name", "efficiency"]
    assert table[["efficiency"]].units == {"efficiency": ""} and table[["axial_load_N"]].units == {"axial_load_N": "N"}
    whole = table.to_polars()
    for selected, rows in (
        (table[1:3], whole[1:3]),
        (table[::-1], whole[::-1]),
        (table[table.ok], whole.filter(whole["status"] == "converged")),
        (table[np.array([3, 1])], whole[[3, 1]]),
        (table[[True, False, False, True]], whole[[0, 3]]),
        (table.head(2), whole.head(2)),
        (table[table["axial_load_N"] > 1e6], whole.clear()),
    ):
        assert selected.to_polars().equals(rows) and len(selected) == len(rows)
        assert pickle.loads(pickle.dumps(selected)) == selected
    assert table[1:3].message(0) == table.message(1) is not None and table[1:3].message(1) is None
    assert table[:2]["efficiency"].flags.writeable is False
    grid = bs.sweep(screw, vary={"axial_load_N": [2e3, 8e3]}, columns=["efficiency"])
    assert grid[grid["axial_load_N"] > 5e3]["efficiency"].tolist() == [grid["efficiency"][1]]
    wrong: Any
    for wrong in (0, None, ("efficiency",), 1.5, np.array([0.5])):
        with pytest.raises(TypeError, match="column name, a list of names, a slice or a mask"):
            table[wrong]
    with pytest.raises(KeyError, match="did you mean `efficiency`"):
        table[["efficency"]]
    with pytest.raises(IndexError):
        table[[True, False]]


def test_integer_column_with_missing_values_is_rejected_and_not_converted_to_text(screw: bs.Case) -> None:
    pl = pytest.importorskip("polars")
    frame = pl.DataFrame({"id": [1, None], "axial_load_N": [2e3, 3e3]})
    with pytest.raises(TypeError, match="column `id` contains integers with missing values"):
        bs.solve_many(frame, screw, keep=["id"], columns=["efficiency"])[:1]


def test_selected_nuts_keep_their_cases() -> None:
    nuts = bs.select_nuts(where=["dynamic_load_rating_N>=40000"], first=200)
    selected = nuts[nuts["lead_mm"] == 20.0]
    assert 1 < len(selected) < len(nuts)
    again = selected[1:].head(3)
    for row in range(len(again)):
        assert again.case(row).lead_mm == 20.0 and again.case(row) == selected.case(row + 1)
        assert again.case(row).ball_diameter_mm == again["ball_diameter_mm"][row]


def test_notebooks_can_complete_the_keys_of_reports_and_grids_and_cases(screw: bs.Case) -> None:
    grid = bs.sweep(screw, vary={"axial_load_N": [2e3, 8e3]}, columns=["efficiency"])
    report = bs.axis(bs.Case.read(EXAMPLES / "axis.json"))
    for completed, usable in ((grid, grid.column_names), (report, list(report)), (screw, list(screw))):
        assert completed._ipython_key_completions_() == usable
        assert all(completed[name] is not None for name in usable)


def test_dataframes_and_files_contain_the_same_messages(screw: bs.Case, tmp_path: Path) -> None:
    table = bs.solve_many({"axial_load_N": [2e3, -1.0]}, screw, columns=["efficiency"])
    table.write(tmp_path / "t.parquet")
    of_file = pl.read_parquet(tmp_path / "t.parquet")
    assert of_file.columns == table.column_names
    expected = of_file["message"].to_list()
    assert expected[0] is None and "axial_load_N" in expected[1]
    assert table.to_polars()["message"].to_list() == table.to_arrow()["message"].to_pylist() == expected
    assert [text if isinstance(text, str) else None for text in table.to_pandas()["message"]] == expected
    assert table["message"].tolist() == table.to_dict()["message"] == [table.message(0), table.message(1)] == expected


# Units


def test_inputs_may_have_another_unit(screw: bs.Case) -> None:
    assert bs.Case(screw, axial_load_kN=7.5).axial_load_N == 7500.0
    ours = bs.solve_many({"axial_load_kN": [2.0, 8.0]}, screw, columns=["efficiency"])
    same = bs.solve_many({"axial_load_N": [2000.0, 8000.0]}, screw, columns=["efficiency"])
    assert ours["efficiency"].tobytes() == same["efficiency"].tobytes()
    assert ours.column_names[0] == "axial_load_kN" and ours["axial_load_kN"].tolist() == [2.0, 8.0]


def test_quantities_of_pint_are_converted(screw: bs.Case) -> None:
    pint = pytest.importorskip("pint")
    unit = pint.UnitRegistry()
    found = screw.replace(axial_load_N=8 * unit.kN, screw_speed_rpm=25 * unit.Hz * 2 * math.pi * unit.rad)
    assert found.axial_load_N == 8000.0 and found.screw_speed_rpm == pytest.approx(1500.0, rel=1e-12)
    loads = np.array([2.0, 8.0]) * unit.kN
    table = bs.solve_many({"axial_load_N": loads}, screw, columns=["efficiency"])
    assert table["axial_load_N"].tolist() == [2000.0, 8000.0]
    with pytest.raises(bs.InputError, match="axial_load_N"):
        screw.replace(axial_load_N=8 * unit.kg)
    # Pint must know the unit of every input.
    for name, quantity in bs.INPUTS.items():
        unit.parse_units(bs._api._pint_unit(quantity.unit)), name
    assert unit.parse_units(bs._api._pint_unit("kg/m3")) == unit.kg / unit.m**3


# Derivatives


def test_exact_derivatives_match_finite_differences(screw: bs.Case) -> None:
    wrt = ["friction_coefficient", "lead_mm", "axial_load_N"]
    points = {name: getattr(screw, name) for name in wrt}
    # For raceway control, the differences have an error of 6e-5 from coarse quadrature. The derivatives do not.
    tolerances: dict[Model, float] = {"raceway-control": 1e-4, "traction": 1e-5}
    for model, rtol in tolerances.items():
        value, exact = bs.gradient(points, "efficiency", wrt, screw, model=model)
        assert math.isclose(value, bs.solve(screw, model=model).efficiency, rel_tol=1e-12)
        _, differences = bs.gradient(points, "efficiency", wrt, screw, model=model, method="difference")
        # Central differences with a step of 1e-4 have an error of 1e-8 from curvature, and of 1e-10 / 1e-4 from the
        # kernel.
        assert np.allclose(exact, differences, rtol=rtol, atol=1e-12)
    many, slopes = bs.gradient({"lead_mm": [10.0, 20.0]}, "efficiency", ["lead_mm"], screw)
    assert many.shape == (2,) and slopes.shape == (2, 1)


def test_a_gradient_without_solution_is_an_error_or_a_row_of_nan(screw: bs.Case) -> None:
    # The screw is self-locking, because its lead is too small for this friction coefficient.
    locked = screw.replace(lead_angle_deg=0.5)
    for method in ("exact", "difference"):
        with pytest.raises(bs.NoSolutionError):
            bs.gradient({"friction_coefficient": 0.3}, "efficiency", ["friction_coefficient"], locked, model="rigid",
                        method=method)
        values, slopes = bs.gradient({"friction_coefficient": [0.001, 0.3]}, "efficiency", ["friction_coefficient"], locked,
                                     model="rigid", method=method)
        assert np.isnan(values).tolist() == np.isnan(slopes[:, 0]).tolist() == [False, True]
    point = {"contact_angle_deg": 45, "lead_angle_deg": 8, "friction_coefficient": 0.01}
    with pytest.raises(bs.InputError, match="no torque"):
        bs.gradient(point, "ball_torque_Nm", ["friction_coefficient"], model="closed-form")


def test_optimum_rejects_an_unknown_model() -> None:
    """Regression test: an unknown model was ignored without a message."""
    with pytest.raises(bs.InputError, match="unknown model `rigd`"):
        bs.optimum(contact_angle_deg=45, lead_angle_deg=8, friction_coefficient=0.06, model="rigd")  # type: ignore[arg-type]


def test_gradient_accepts_a_dataframe(screw: bs.Case) -> None:
    pl = pytest.importorskip("polars")
    loads = {"axial_load_N": [2e3, 8e3]}
    expected, slopes = bs.gradient(loads, "efficiency", ["lead_mm"], screw)
    values, found = bs.gradient(pl.DataFrame(loads), "efficiency", ["lead_mm"], screw)
    assert values.tolist() == expected.tolist() and found.tolist() == slopes.tolist()
    for refuse in (lambda points: bs.gradient(points, "efficiency", ["lead_mm"], screw),
                   lambda points: bs.solve_many(points, screw)):
        with pytest.raises(bs.InputError, match=r"points.collect\(\)"):
            refuse(pl.LazyFrame(loads))
        with pytest.raises(bs.InputError, match="points is a case"):
            refuse(screw)


def test_negative_seed_of_random_points_is_rejected() -> None:
    with pytest.raises(bs.InputError, match="seed is -1"):
        bs.draw({"lead_mm": bs.uniform(5, 20)}, samples=1, seed=-1)


def test_error_for_a_missing_library_states_how_to_install_the_library(screw: bs.Case, monkeypatch: pytest.MonkeyPatch) -> None:
    table = bs.solve_many({"axial_load_N": [8e3]}, screw)
    monkeypatch.setitem(sys.modules, "polars", None)
    with pytest.raises(ModuleNotFoundError, match="pip install polars"):
        table.to_polars()


def test_gradients_of_many_points_match_single_points(screw: bs.Case) -> None:
    wrt = ["lead_mm", "axial_load_N", "nut_conformity"]
    loads = np.linspace(1e3, 2e4, 50)
    values, slopes = bs.gradient({"axial_load_N": loads, "lead_mm": 15.0}, "ball_torque_Nm", wrt, screw)
    for row, load in enumerate(loads):
        value, slope = bs.gradient({"axial_load_N": load, "lead_mm": 15.0}, "ball_torque_Nm", wrt, screw)
        assert value == values[row] and (slope == slopes[row]).all()


def test_exact_gradient_is_rejected_if_another_input_depends_on_the_varied_input(screw: bs.Case) -> None:
    fed = bs.Case({name: value for name, value in screw.items() if name != "screw_speed_rpm"}, feed_m_min=30)
    with pytest.raises(bs.InputError, match="screw_speed_rpm"):
        bs.gradient({"lead_mm": 20.0}, "efficiency", ["lead_mm"], fed)
    _, slope = bs.gradient({"lead_mm": 20.0}, "efficiency", ["lead_mm"], fed, method="difference")
    assert np.isfinite(slope).all()
    with pytest.raises(bs.InputError, match="difference"):
        bs.gradient({"lead_mm": 20.0}, "nut_normal_load_N", ["lead_mm"], screw)


def test_sensitivities_are_sorted_by_decreasing_magnitude(screw: bs.Case) -> None:
    table = bs.sensitivities(screw)
    sizes = np.abs(table["efficiency_relative"])
    assert (np.diff(sizes[~np.isnan(sizes)]) <= 0).all()


def test_curve_plot_of_a_grid_has_one_line_for_each_value_of_the_other_axis(screw: bs.Case) -> None:
    """Regression test: without `by`, one zigzag line was drawn through all points of the grid."""
    loads, speeds = [2000.0, 4000.0, 8000.0], [500.0, 1500.0]
    grid = bs.sweep(screw, vary={"axial_load_N": loads, "screw_speed_rpm": speeds}, columns=["efficiency"])
    lines = bs.plot.curves(grid, "axial_load_N", "efficiency").get_lines()
    assert [np.asarray(line.get_xdata()).tolist() for line in lines] == [loads, loads]


def test_all_texts_of_a_saved_figure_lie_inside_the_requested_size(screw: bs.Case, tmp_path: Path) -> None:
    """Regression test: at the width of a journal column, both axis labels were cut off."""
    vary = {"lead_angle_deg": [5.0, 15.0, 45.0], "contact_angle_deg": [30.0, 45.0]}
    grid = bs.sweep(screw, vary=vary, model="closed-form", columns=["efficiency"])
    for axes in (bs.plot.curves(grid, "lead_angle_deg", "efficiency"), bs.plot.heatmap(grid, "efficiency")):
        bs.plot.save(axes, tmp_path / "figure.png", size_mm=(84, 60), title="efficiency")
        figure: Any = axes.figure
        texts = [text for each in figure.axes for text in (each.title, each.xaxis.label, each.yaxis.label)]
        frames = [text.get_window_extent() for text in texts if text.get_text()]
        assert len(frames) >= 3
        for frame in frames:
            assert figure.bbox.x0 <= frame.x0 and frame.x1 <= figure.bbox.x1
            assert figure.bbox.y0 <= frame.y0 and frame.y1 <= figure.bbox.y1


def test_curve_plot_draws_an_error_or_the_ends_of_an_interval_as_a_band(screw: bs.Case) -> None:
    grid = bs.sweep(screw, vary={"axial_load_N": [2e3, 4e3]}, columns=["efficiency", "ball_torque_Nm"])
    value, torque = grid["efficiency"], grid["ball_torque_Nm"]
    symmetric = bs.plot.curves(grid, "axial_load_N", "efficiency", error="ball_torque_Nm")
    interval = bs.plot.curves(grid, "axial_load_N", "efficiency", error=("efficiency", "ball_torque_Nm"))
    for axes, low, high in [(symmetric, value - torque, value + torque), (interval, value, torque)]:
        (band,) = axes.collections
        heights = np.asarray(band.get_paths()[0].vertices)[:, 1]
        assert heights.min() == min(low.min(), high.min()) and heights.max() == max(low.max(), high.max())


# Threads, processes, interrupts


@pytest.mark.parametrize("model", ["traction", "rigid"])
def test_ctrl_c_ends_a_run_at_once(model: str) -> None:
    code = (
        "import ballscrew as bs, numpy as np, time\n"
        f"s = bs.Case.read({str(FEED_DRIVE)!r})\n"
        "n = 20_000_000\n"
        "loads = np.linspace(1e3, 1e4, n)\n"
        "print('begun', flush=True)\n"
        "try:\n"
        "    while True:\n"
        f"        bs.solve_many({{'axial_load_N': loads}}, s, model={model!r}, columns=['efficiency'])\n"
        "except KeyboardInterrupt:\n"
        "    print(time.time(), flush=True)\n"
        "    raise\n"
    )
    run = subprocess.Popen([sys.executable, "-c", code], stdout=subprocess.PIPE, stderr=subprocess.PIPE)
    assert run.stdout is not None and run.stdout.readline() == b"begun\n"
    time.sleep(1.0)
    start = time.time()
    run.send_signal(signal.SIGINT)
    told, words = run.communicate(timeout=30)
    assert b"KeyboardInterrupt" in words
    # Signals are handled every 0.05 s, and ending a run takes 0.02 s. The limit leaves a margin for a busy machine.
    assert float(told) - start < 0.7


def test_an_exception_in_the_progress_function_ends_the_run(screw: bs.Case) -> None:
    class Enough(Exception):
        pass

    def stop(done: int, total: int) -> None:
        raise Enough

    with pytest.raises(Enough):
        bs.solve_many(random_points(300_000, 4), screw, model="traction", columns=["efficiency"], progress=stop)


def test_last_progress_call_reports_all_rows_as_finished(screw: bs.Case) -> None:
    seen: list[tuple[int, int]] = []
    bs.solve_many(random_points(100_000, 4), screw, model="raceway-control", columns=["efficiency"],
                  progress=lambda done, total: seen.append((done, total)))
    assert seen[-1] == (100_000, 100_000)


def test_several_python_threads_may_solve_at_the_same_time(screw: bs.Case) -> None:
    points = random_points(3000, 6)
    expected = bs.solve_many(points, screw, columns=["efficiency"])["efficiency"].tobytes()
    found: list[bytes] = []

    def work() -> None:
        found.append(bs.solve_many(points, screw, columns=["efficiency"])["efficiency"].tobytes())

    threads = [threading.Thread(target=work) for _ in range(4)]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    assert found == [expected] * 4


@pytest.mark.skipif(not hasattr(os, "fork"), reason="no fork here")
def test_a_forked_process_can_solve() -> None:
    code = (
        "import os, ballscrew as bs, numpy as np\n"
        f"s = bs.Case.read({str(FEED_DRIVE)!r})\n"
        "run = lambda: bs.solve_many({'axial_load_N': np.linspace(1e3, 1e4, 5000)}, s, columns=['efficiency'])\n"
        "run()\n"
        "child = os.fork()\n"
        "if child == 0:\n"
        "    run(); os._exit(0)\n"
        "raise SystemExit(os.waitstatus_to_exitcode(os.waitpid(child, 0)[1]))\n"
    )
    assert subprocess.run([sys.executable, "-W", "ignore", "-c", code], timeout=60).returncode == 0


def test_repeated_calls_do_not_leak_memory(screw: bs.Case) -> None:
    def resident() -> int:
        return int(Path("/proc/self/statm").read_text().split()[1]) * os.sysconf("SC_PAGE_SIZE")

    if not Path("/proc/self/statm").exists():
        pytest.skip("no /proc here")
    points = random_points(100, 8)
    outputs: list[Output] = ["efficiency", "ball_torque_Nm"]

    def calls(count: int) -> None:
        for _ in range(count):
            bs.solve_many(points, screw, model="closed-form", columns=outputs)
            bs.solve(screw, model="closed-form", lead_mm=10.0).to_dict()
            with contextlib.suppress(bs.InputError):
                bs.Case(lead_mn=3)  # type: ignore[call-arg]

    calls(1000)
    before = resident()
    calls(10_000)
    # A leak of one column per call, 800 B, would add up to 8 MB. The allocator keeps some pages.
    assert resident() - before < 3_000_000


def test_import_is_fast_and_does_not_import_numpy() -> None:
    code = "import sys, ballscrew; assert 'numpy' not in sys.modules"
    assert subprocess.run([sys.executable, "-c", code]).returncode == 0
