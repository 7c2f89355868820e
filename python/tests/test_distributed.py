"""Plans on Dask, with a real scheduler and worker processes that are killed: the bytes of one machine.

BSM_FAULTS=20 kills twenty workers instead of two.
"""

from __future__ import annotations

import os
import random
import signal
import subprocess
import sys
import threading
import time
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from conftest import EXAMPLES
from test_parts import files

import ballscrew as bs

distributed = pytest.importorskip("distributed")
from ballscrew import distributed as on_dask

# What a scheduler and workers that are killed leave behind.
pytestmark = pytest.mark.filterwarnings("ignore")

KILLS = int(os.environ.get("BSM_FAULTS", "2"))


def planned(folder: Path, rows: int = 3000, parts: int = 30, **how: Any) -> bs.Plan:
    vary = {"axial_load_N": bs.linspace(500, 9000, rows)}
    screw = bs.Scene.read(EXAMPLES / "feed_drive.json")
    how = {"model": "traction", "outputs": ["efficiency"], "rows_per_part": rows // parts, **how}
    return bs.plan(folder, screw, vary=vary, **how)


def two_workers() -> Any:
    return distributed.LocalCluster(n_workers=2, threads_per_worker=1, processes=True, dashboard_address=None)


@pytest.fixture
def client() -> Iterator[Any]:
    with two_workers() as cluster, distributed.Client(cluster) as client:
        yield client


def test_workers_that_are_killed(tmp_path: Path) -> None:
    import dask

    alone = planned(tmp_path / "alone", 20_000, 100)
    start = time.monotonic()
    alone.run(threads=2)
    undisturbed = time.monotonic() - start
    draws = random.Random(25)
    killed = rounds = 0

    def kill(client: Any, ended: threading.Event) -> None:
        nonlocal killed
        while not ended.wait(draws.uniform(0.1, 0.5) * undisturbed) and killed < KILLS:
            workers = [*client.run(os.getpid).values()]
            # A nanny gives up a worker that dies while it starts: one is left to work meanwhile.
            if len(workers) == 2 and not ended.is_set():
                os.kill(draws.choice(workers), signal.SIGKILL)
                killed += 1
                client.wait_for_workers(1)
                time.sleep(1)

    while killed < KILLS:
        rounds += 1
        folder = tmp_path / f"map{rounds}"
        plan = planned(folder, 20_000, 100)
        ended = threading.Event()
        # A kill of ours is no fault of the task. Nannies start workers again, and sometimes give up: each round has its own.
        with (
            dask.config.set({"distributed.scheduler.allowed-failures": 50}),
            two_workers() as cluster,
            distributed.Client(cluster) as client,
        ):
            killer = threading.Thread(target=kill, args=[client, ended])
            killer.start()
            try:
                summary = on_dask.run(client, plan, per_task=2, progress=False)
            finally:
                ended.set()
                killer.join()
        assert (summary.parts, summary.rows) == (100, 20_000)
        assert files(folder) == files(tmp_path / "alone"), "not the bytes of one machine"
    print(f"0 wrong bytes, 0 lost: {killed} workers killed in {rounds} runs")


def test_a_scheduler_that_is_killed(tmp_path: Path) -> None:
    alone, folder = planned(tmp_path / "alone", 30_000, 60), tmp_path / "map"
    alone.run()
    plan = planned(folder, 30_000, 60)
    address = tmp_path / "scheduler.json"
    dask = [sys.executable, "-m", "distributed.cli.dask_scheduler"]
    if subprocess.run([sys.executable, "-c", "import distributed.cli.dask_scheduler"]).returncode:
        pytest.skip("this Dask has no scheduler to start")

    def started(*words: str) -> subprocess.Popen[bytes]:
        return subprocess.Popen(words, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)

    file = ["--scheduler-file", str(address)]
    scheduler = started(*dask, *file, "--port", "0", "--no-dashboard")
    worker = [sys.executable, "-m", "distributed.cli.dask_worker", *file, "--nthreads", "1", "--no-dashboard", "--death-timeout", "5"]
    workers = [started(*worker, "--local-directory", str(tmp_path)) for _ in range(2)]
    try:
        until = time.monotonic() + 60
        while not address.exists() and time.monotonic() < until:
            time.sleep(0.05)
        with distributed.Client(scheduler_file=str(address), timeout="30s") as client:
            client.wait_for_workers(2, timeout=60)

            def kill() -> None:
                while len(list((folder / "data").iterdir())) < 20:
                    time.sleep(0.01)
                scheduler.kill()

            killer = threading.Thread(target=kill)
            killer.start()
            with pytest.raises(bs.RunnerLostError, match="run again: at least"):
                on_dask.run(client, plan, per_task=1, progress=False)
            killer.join()
    finally:
        for process in [scheduler, *workers]:
            process.kill()
            process.wait()
    found = 60 - sum(stop - start for start, stop in plan.verify().missing)
    assert 20 <= found < 60
    local = distributed.LocalCluster(n_workers=1, processes=True, dashboard_address=None)
    with local as cluster, distributed.Client(cluster) as client:
        summary = on_dask.run(client, plan, progress=False)
    assert summary.parts == 60 and summary.skipped >= 20
    assert files(folder) == files(tmp_path / "alone")


def test_parts_that_cannot_be_solved_are_told(tmp_path: Path, client: Any) -> None:
    plan = planned(tmp_path / "map")
    plan.run([0])
    (tmp_path / "map" / "data" / plan.files[0]).write_bytes(b"mine")
    with pytest.raises(bs.PartError, match=r"part-000000\.parquet"):
        on_dask.run(client, plan, progress=False)
    (tmp_path / "map" / "data" / plan.files[0]).unlink()

    # The table of points is gone, and comes back.
    import pyarrow as pa
    import pyarrow.parquet as pq

    points, moved = tmp_path / "points.parquet", tmp_path / "moved.parquet"
    pq.write_table(pa.table({"axial_load_N": np.linspace(500, 9000, 3000)}), points)
    screw = bs.Scene.read(EXAMPLES / "feed_drive.json")
    plan = bs.plan(tmp_path / "table", screw, points=points, model="rigid", outputs=["efficiency"], rows_per_part=100)
    points.rename(moved)
    with pytest.raises(bs.PartError, match=r"parts 0 to 9, and 2 tasks more could not be solved: (OSError|FileNotFoundError)"):
        on_dask.run(client, plan, per_task=10, retries=0, progress=False)
    moved.rename(points)
    assert on_dask.run(client, plan, progress=False).rows == 3000


class Flaky:
    """A store whose first put fails."""

    left = 1


def test_a_store(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    import fsspec

    alone = planned(tmp_path / "alone", model="rigid")
    alone.run()
    plan = planned(tmp_path / "plan", model="rigid")
    store, url = fsspec.filesystem("memory"), "memory://bucket/map"
    put = type(store).put_file

    def flaky(self: Any, *words: Any, **how: Any) -> Any:
        if Flaky.left:
            Flaky.left -= 1
            raise OSError("the store is busy")
        return put(self, *words, **how)

    monkeypatch.setattr(type(store), "put_file", flaky)
    # Threads of this process: its memory is the store.
    local = distributed.LocalCluster(n_workers=1, threads_per_worker=2, processes=False, dashboard_address=None)
    with local as cluster, distributed.Client(cluster) as client:
        summary = on_dask.run(client, plan, url=url, per_task=3, progress=False)
        assert summary == (30, 0, 3000, 0) and Flaky.left == 0
        held = {path.removeprefix("/bucket/map/"): store.cat_file(path) for path in store.find("/bucket/map")}
        assert held == files(tmp_path / "alone")
        assert on_dask.run(client, plan, url=url, progress=False).skipped == 30

        part = "/bucket/map/data/part-000007.parquet"
        flipped = bytearray(held["data/part-000007.parquet"])
        flipped[100] ^= 4
        store.pipe_file(part, bytes(flipped))
        assert on_dask.verify(client, plan, url=url).complete
        found = on_dask.verify(client, plan, url=url, deep=True)
        assert not found.complete and [path for path, _ in found.damaged] == [part]
        assert "has been changed" in found.damaged[0][1]
        store.pipe_file(part, bytes(flipped[:50]))
        with pytest.raises(bs.PartError, match="remove them, and run again"):
            on_dask.run(client, plan, url=url, progress=False)
        store.rm_file(part)
        assert on_dask.verify(client, plan, url=url).missing == [(7, 8)]
        assert on_dask.run(client, plan, url=url, progress=False).skipped == 29

        other = planned(tmp_path / "other", model="elastic")
        with pytest.raises(bs.InputError, match="another plan"):
            on_dask.run(client, other, url=url, progress=False)
    store.store.clear()


def test_statistics_on_a_cluster(tmp_path: Path, client: Any) -> None:
    import polars as pl

    plan = planned(tmp_path / "plan", model="rigid")

    def statistics(number: int, text: str) -> tuple[int, float]:
        rows = pl.DataFrame(bs.solve_part(text, number))
        return len(rows), float(rows["efficiency"].to_numpy().min())

    parts = client.gather(client.map(statistics, range(plan.parts), text=plan.text))
    assert sum(rows for rows, _ in parts) == 3000
    plan.run()
    assert min(least for _, least in parts) == pl.read_parquet(tmp_path / "plan" / "data")["efficiency"].min()


def test_a_listing_of_ten_thousand_parts(tmp_path: Path) -> None:
    """Names that are no parts are told in seconds, and no task is made for what is there."""
    import fsspec

    plan = planned(tmp_path / "plan", 10_000, 10_000, model="closed-form")
    store, url = fsspec.filesystem("memory"), "memory://many/map"
    for name in plan.files:
        store.pipe_file(f"/many/map/data/{name}", b"")
    start = time.monotonic()
    parts, found = on_dask._Store(url, {}).survey(plan)
    # It takes a second; the rest is for a machine that does other things.
    assert time.monotonic() - start < 20
    assert not parts and len(found.damaged) == 10_000 and found.missing == [(0, 10_000)]
    store.store.clear()


def test_tasks_are_of_consecutive_parts(tmp_path: Path) -> None:
    assert list(on_dask._tasks([(0, 5), (7, 8)], 2)) == [(0, 2), (2, 4), (4, 5), (7, 8)]
    assert on_dask._ranges([1, 2, 5]) == [(1, 3), (5, 6)]
    # Nominally 20 us a row of traction: 100 000 rows are 2 s, five parts a task.
    assert on_dask._per_task(planned(tmp_path / "a", 10_000_000, 100)) == 5
    assert on_dask._per_task(planned(tmp_path / "b", 3000, 30)) == 30
