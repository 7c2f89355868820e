"""Tests that parts are bit-identical to the parts of the program, in any order and with any number of threads, and that
all readers can open them."""

from __future__ import annotations

import json
import os
import random
import shutil
import signal
import subprocess
import threading
import time
from pathlib import Path
from typing import Any

import pytest
from conftest import EXAMPLES, program

import ballscrew as bs

VARY = {"axial_load_N": bs.linspace(500, 9000, 40), "friction_coefficient": [0.05, 0.1, 12.0]}
ROWS = 120


def made(folder: Path, **how: object) -> bs.Plan:
    given = {"vary": VARY, "model": "elastic", "columns": ["efficiency", "ball_torque_Nm"], "rows_per_part": 13, **how}
    return bs.plan(folder, bs.Case.read(EXAMPLES / "feed_drive.json"), **given)  # type: ignore[arg-type]


def files(folder: Path) -> dict[str, bytes]:
    return {str(path.relative_to(folder)): path.read_bytes() for path in folder.rglob("*") if path.is_file()}


@pytest.fixture(scope="module")
def alone(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Return the folder that the program creates for the same plan."""
    folder = tmp_path_factory.mktemp("alone")
    axes = ["--vary=axial_load_N=500:9000:40", "--vary=friction_coefficient=0.05,0.1,12"]
    how = ["--model=elastic", "--columns=efficiency,ball_torque_Nm", "--rows-per-part=13", "--keep-going"]
    words: list[str | Path] = [program(), "sweep", EXAMPLES / "feed_drive.json", *axes, *how, "-o", f"{folder}/map/"]
    assert subprocess.run(words, capture_output=True).returncode == 0
    return folder / "map"


@pytest.mark.parametrize("threads", [1, 2, 5])
def test_parts_written_from_python_are_bit_identical_to_those_of_the_program(tmp_path: Path, alone: Path, threads: int) -> None:
    plan = made(tmp_path / "map")
    summary = plan.run(threads=threads)
    assert summary == (10, 0, ROWS, 40)
    assert files(tmp_path / "map") == files(alone)
    assert plan.run(threads=threads) == (10, 10, ROWS, 40)


def test_a_solved_part_consists_of_plain_numbers_and_text(tmp_path: Path, alone: Path) -> None:
    text = (alone / "plan.json").read_text()
    for number in reversed(range(10)):
        told = json.loads(json.dumps(bs.run_part(text, number, tmp_path)))
        assert (told["part"], told["skipped"]) == (number, False)
        assert told["rows"] == (13 if number < 9 else 3)
    assert bs.run_part(text, 3, tmp_path)["skipped"]
    plan = bs.Plan.open(tmp_path)
    assert plan.verify(deep=True) == ([], [], [], True, ROWS, 40)
    plan.finish()
    assert files(tmp_path) == files(alone)
    assert (plan.text, plan.rows, plan.parts, plan.rows_per_part) == (text, ROWS, 10, 13)
    assert plan.files[9] == "part-000009.parquet"


def test_missing_or_damaged_or_unknown_parts_are_reported(tmp_path: Path) -> None:
    plan = made(tmp_path / "map")
    plan.run([0, 4, 5])
    data = tmp_path / "map" / "data"
    (data / plan.files[4]).write_bytes(b"mine")
    (data / "notes.txt").write_bytes(b"")
    found = plan.verify()
    assert found.missing == [(1, 5), (6, 10)] and not found.complete
    assert "has an invalid footer" in found.damaged[0][1] and found.foreign[0].endswith("notes.txt")
    with pytest.raises(bs.PartError, match="8 of 10 parts are missing"):
        plan.finish()
    with pytest.raises(bs.PartError, match="part-000004.parquet"):
        plan.run()
    assert plan.run(repair=True).rows == ROWS
    with pytest.raises(bs.InputError, match="differs in: rows_per_part"):
        made(tmp_path / "map", rows_per_part=14)
    with pytest.raises(bs.InputError, match="but no part 10"):
        plan.run([10])
    with pytest.raises(bs.InputError, match="results"):
        bs.run_part(plan.text.replace('"results":', '"results":1'), 0, tmp_path / "other")
    with pytest.raises(bs.InputError, match="one of vary, draw and points"):
        made(tmp_path / "x", vary=None)
    # Regression test: after the plan had been modified, every intact part was reported to belong to another plan.
    text = (tmp_path / "map" / "plan.json").read_text()
    (tmp_path / "map" / "plan.json").write_text(text.replace("9000", "9001"))
    with pytest.raises(bs.InputError, match="has been changed"):
        bs.Plan.open(tmp_path / "map")
    (tmp_path / "map" / "plan.json").write_text(text)
    shutil.copy(data / plan.files[4], data / "part-000010.parquet")
    with pytest.raises(bs.PartError, match=r"part-000010\.parquet the plan has no part with this name"):
        plan.run()
    (data / "part-000010.parquet").unlink()
    other = made(tmp_path / "swapped", model="closed-form")
    other.run()
    shutil.copy(tmp_path / "map" / "plan.json", tmp_path / "swapped")
    with pytest.raises(bs.PartError, match="parts of another plan"):
        bs.Plan.open(tmp_path / "swapped").run(repair=True)
    with pytest.raises(OSError, match="plan.json"):
        bs.Plan.open(tmp_path / "nowhere")
    # An exception that stops a run must reach the caller, and finished parts must be kept.
    stopped = made(tmp_path / "stopped", vary={"axial_load_N": bs.linspace(500, 9000, 3_000_000)}, rows_per_part=1_000_000)
    with pytest.raises(RuntimeError, match="enough"):
        stopped.run(progress=lambda done, total: (_ for _ in ()).throw(RuntimeError("enough")))
    assert not list((tmp_path / "stopped" / "tmp").iterdir())


def test_statistics_over_parts_can_be_calculated_without_rows_on_disk(tmp_path: Path) -> None:
    import polars as pl

    plan = made(tmp_path / "map")
    text = plan.text
    frames = [pl.DataFrame(bs.solve_part(text, number, threads=2)) for number in range(plan.parts)]
    assert not list((tmp_path / "map" / "data").iterdir())
    plan.run()
    rows = pl.read_parquet(tmp_path / "map" / "data")
    assert pl.concat(frames).equals(rows)
    with pytest.raises(bs.InputError, match="but no part 10"):
        bs.solve_part(text, 10)
    by = "friction_coefficient"

    def summed(frame: pl.DataFrame) -> pl.DataFrame:
        value = pl.col("efficiency")
        return frame.group_by(by).agg(pl.len(), least=value.min(), sum=value.sum(), count=value.count())

    merged = pl.concat(map(summed, frames)).group_by(by).agg(pl.sum("len", "sum", "count"), pl.min("least")).sort(by)
    whole = summed(rows).sort(by)
    assert merged["len"].to_list() == whole["len"].to_list() == [40, 40, 40]
    assert merged["least"].to_list() == whole["least"].to_list()
    assert merged["count"].to_list() == [40, 40, 0]
    # The forty numbers are added in a different order, so the sums differ by rounding errors.
    assert merged["sum"].to_numpy() == pytest.approx(whole["sum"].to_numpy(), rel=1e-14)


def test_random_points_and_tables_can_be_planned(tmp_path: Path) -> None:
    import pyarrow.parquet as pq

    draw = {"axial_load_N": bs.uniform(500, 9000), "friction_coefficient": bs.normal(0.06, 0.005)}
    given = {"vary": None, "draw": draw, "samples": 100, "seed": 3, "model": "rigid"}
    plan = made(tmp_path / "drawn", **given)
    plan.run()
    rows = pq.read_table(tmp_path / "drawn" / "data").to_pylist()
    assert len(rows) == 100 and all(500 <= row["axial_load_N"] <= 9000 for row in rows)

    points = tmp_path / "points.parquet"
    pq.write_table(pq.read_table(tmp_path / "drawn" / "data"), points)
    made(tmp_path / "of_table", vary=None, points=points, model="rigid").run()
    again = pq.read_table(tmp_path / "of_table" / "data").to_pylist()
    assert again == rows
    shutil.move(points, tmp_path / "moved.parquet")
    moved = bs.Plan.open(tmp_path / "of_table", points=tmp_path / "moved.parquet")
    assert moved.run().skipped == 8


def test_every_supported_parquet_reader_opens_the_parts(alone: Path) -> None:
    import duckdb
    import pandas as pd
    import polars as pl
    import pyarrow.dataset as ds

    data = alone / "data"
    counts = [
        ds.dataset(data).count_rows(),
        pl.scan_parquet(data).collect().height,
        len(pd.read_parquet(data)),
        len(duckdb.read_parquet(f"{data}/*.parquet").fetchall()),
    ]
    assert counts == [ROWS] * 4


@pytest.mark.filterwarnings("ignore")
def test_parts_are_bit_identical_even_if_workers_are_killed(tmp_path: Path) -> None:
    """Dask runs as in the guide, with workers that are killed, and the parts are bit-identical. BSM_FAULTS=20 kills
    twenty workers instead of two."""
    dask, distributed = pytest.importorskip("dask"), pytest.importorskip("distributed")
    kills, draws, killed, rounds = int(os.environ.get("BSM_FAULTS", "2")), random.Random(25), 0, 0
    long: dict[str, Any] = {"vary": {"axial_load_N": bs.linspace(500, 9000, 20_000)}, "model": "traction", "rows_per_part": 200}
    alone = made(tmp_path / "alone", **long)
    start = time.monotonic()
    alone.run(threads=2)
    undisturbed = time.monotonic() - start

    def kill(client: Any, ended: threading.Event) -> None:
        nonlocal killed
        while not ended.wait(draws.uniform(0.1, 0.5) * undisturbed) and killed < kills:
            workers = [*client.run(os.getpid).values()]
            # A nanny does not restart a worker that dies while it starts, so one worker is kept alive during this time.
            if len(workers) == 2 and not ended.is_set():
                os.kill(draws.choice(workers), signal.SIGKILL)
                killed += 1
                client.wait_for_workers(1)
                time.sleep(1)

    def solve(parts: range, folder: Path) -> tuple[int, ...]:
        return bs.Plan.open(folder).run(parts, threads=1)

    while killed < kills:
        rounds += 1
        folder = tmp_path / f"map{rounds}"
        plan = made(folder, **long)
        ended = threading.Event()
        # A killed worker must not count as a failure of its task. Nannies restart workers, but sometimes give up, so
        # each round has its own nannies.
        with (
            dask.config.set({"distributed.scheduler.allowed-failures": 50}),
            distributed.Client(n_workers=2, threads_per_worker=1, dashboard_address=None) as client,
        ):
            killer = threading.Thread(target=kill, args=[client, ended])
            killer.start()
            try:
                client.gather(client.map(solve, [range(first, first + 2) for first in range(0, 100, 2)], folder=folder, retries=5))
            finally:
                ended.set()
                killer.join()
        plan.finish()
        assert files(folder) == files(tmp_path / "alone"), "not the bytes of one machine"
    print(f"0 wrong bytes, 0 lost: {killed} workers killed in {rounds} runs")
