"""Plans on a Dask cluster, into a folder that all workers see or into an object store.

Needs `dask`: `pip install 'ballscrew[dask]'`. Every part proves itself, so that nothing is lost and nothing mixed: run again
after any failure, on any cluster.
"""

from __future__ import annotations

import tempfile
import uuid
from collections.abc import Iterable, Iterator, Mapping
from concurrent.futures import CancelledError, ThreadPoolExecutor
from itertools import islice
from pathlib import Path
from typing import TYPE_CHECKING, Any, NamedTuple, cast

import ballscrew
from ballscrew import _core
from ballscrew._api import Progress, _shown
from ballscrew._errors import InputError, PartError, RunnerLostError
from ballscrew._parts import Plan, SolvedPart, Summary, Verification, incomplete, part_name, run_part, verified

if TYPE_CHECKING:
    from distributed import Client

__all__ = ["run", "verify"]

_TASK_SECONDS = 10.0
"""Least nominal time of a task: a scheduler starts some hundred of them a second."""

_END = 1 << 16
"""Last bytes of a file that are read first: the footers of all but the largest parts."""

_AT_ONCE = 16
"""Footers of a store that are read at a time."""


class _Place(NamedTuple):
    """Where parts go, in what every worker understands."""

    text: str
    folder: str
    url: str | None
    storage_options: dict[str, Any]
    points: str | None
    threads: int


class _Store:
    """The folder of a plan in an object store."""

    def __init__(self, url: str, options: Mapping[str, Any]) -> None:
        from fsspec.core import url_to_fs

        self.fs, root = url_to_fs(url, **options)
        self.root = root.rstrip("/")

    def path(self, *names: str) -> str:
        return "/".join([self.root, *names])

    def part(self, number: int) -> str:
        return self.path("data", part_name(number))

    def put(self, file: Path, path: str) -> None:
        """A file appears when it is whole: stores do so."""
        self.fs.makedirs(path.rsplit("/", 1)[0], exist_ok=True)
        self.fs.put_file(str(file), path)

    def begin(self, plan: Plan) -> None:
        """The plan of the store is this one, or there is none yet."""
        path = self.path("plan.json")
        if not self.fs.exists(path):
            self.fs.makedirs(self.root, exist_ok=True)
            self.fs.pipe_file(path, plan.text.encode())
        elif self.fs.cat_file(path) != plan.text.encode():
            raise InputError(f"{path} is another plan; take another url")

    def survey(self, plan: Plan) -> tuple[list[_core.Part], Verification]:
        """What is there, by one listing and the end of every file."""
        self.fs.invalidate_cache()
        folder = self.path("data")
        entries = self.fs.ls(folder, detail=True) if self.fs.exists(folder) else []
        expected = {part_name(number): number for number in range(plan.parts)}
        parts, damaged, foreign = [], [], []
        ours = []
        for entry in entries:
            name = entry["name"].rsplit("/", 1)[-1]
            if name in expected and entry["type"] == "file":
                ours.append((expected[name], entry["name"], int(entry["size"])))
            elif name.startswith("part-"):
                damaged.append((entry["name"], "the plan has no part of that name"))
            else:
                foreign.append(entry["name"])

        def prove(entry: tuple[int, str, int]) -> tuple[_core.Part | None, str | None]:
            number, path, size = entry
            end = self.fs.cat_file(path, start=max(0, size - _END), end=size)
            part, needed, why = plan._core.prove(number, end, size)
            if needed is not None:
                end = self.fs.cat_file(path, start=size - needed, end=size)
                part, _, why = plan._core.prove(number, end, size)
            return part, why

        with ThreadPoolExecutor(_AT_ONCE) as pool:
            for entry, (part, why) in zip(ours, pool.map(prove, ours), strict=True):
                if part is not None:
                    parts.append(part)
                else:
                    damaged.append((entry[1], why or "is no part"))
        parts.sort()
        there = {part[0] for part in parts}
        missing = _ranges(number for number in range(plan.parts) if number not in there)
        return parts, verified(parts, missing, sorted(damaged), sorted(foreign))

    def finish(self, parts: list[_core.Part]) -> None:
        """The list of all parts."""
        self.fs.pipe_file(self.path("parts.parquet"), _core.Plan.table(parts))


def _ranges(numbers: Iterable[int]) -> list[tuple[int, int]]:
    """Growing numbers as ranges, from the first to before the last."""
    ranges: list[tuple[int, int]] = []
    for number in numbers:
        if ranges and ranges[-1][1] == number:
            ranges[-1] = (ranges[-1][0], number + 1)
        else:
            ranges.append((number, number + 1))
    return ranges


def _tasks(missing: list[tuple[int, int]], per_task: int) -> Iterator[tuple[int, int]]:
    """Consecutive parts, so many at a time."""
    for start, stop in missing:
        for first in range(start, stop, per_task):
            yield first, min(first + per_task, stop)


def _version() -> str:
    """On a worker: its package."""
    return ballscrew.__version__


def _solve(task: tuple[int, int], place: _Place) -> list[SolvedPart]:
    """On a worker: some parts."""
    text, folder, url, options, points, threads = place
    solved = []
    for number in range(*task):
        if url is None:
            solved.append(run_part(text, number, folder, points=points, threads=threads))
            continue
        store = _Store(url, options)
        with tempfile.TemporaryDirectory() as scratch:
            solved.append(run_part(text, number, scratch, points=points, threads=threads))
            store.put(Path(scratch, "data", part_name(number)), store.part(number))
    return solved


def _check(task: tuple[int, int], place: _Place) -> list[tuple[str, str]]:
    """On a worker: what is damaged of some parts of a store."""
    text, _, url, options, _, _ = place
    store = _Store(url or "", options)
    plan = _core.Plan.from_text(text)
    damaged = []
    for number in range(*task):
        with tempfile.TemporaryDirectory() as scratch:
            plan.begin(Path(scratch))
            store.fs.get_file(store.part(number), str(Path(scratch, "data", part_name(number))))
            damaged += [(store.part(number), why) for _, why in plan.survey(Path(scratch), True)[2]]
    return damaged


def _per_task(plan: Plan) -> int:
    """Parts that take long enough together."""
    seconds = plan.estimate().core_hours * 3600 / plan.parts
    return max(1, min(plan.parts, round(_TASK_SECONDS / max(seconds, 1e-9))))


def _drive(
    client: Any,
    function: Any,
    tasks: Iterator[tuple[int, int]],
    place: _Place,
    window: int | None,
    retries: int,
    done: Any,
) -> list[tuple[tuple[int, int], str]]:
    """Give tasks to the cluster, never more than a window of them, and say which of them failed and why."""
    from distributed import as_completed
    from distributed.comm.core import CommClosedError

    versions = client.run(_version)
    others = {where: found for where, found in versions.items() if found != ballscrew.__version__}
    if others:
        where, found = next(iter(others.items()))
        raise InputError(f"worker {where} has ballscrew {found}, the client {ballscrew.__version__}")
    if window is None:
        window = 2 * sum(client.nthreads().values()) + 16
    run = uuid.uuid4().hex[:8]
    running: dict[str, tuple[int, int]] = {}
    failed = []
    results: Any = cast("Any", as_completed)([])

    def top_up() -> None:
        batch = list(islice(tasks, window - len(running)))
        if batch:
            keys = [f"ballscrew-{run}-{first}-{last}" for first, last in batch]
            running.update(zip(keys, batch, strict=True))
            results.update(client.map(function, batch, place=place, key=keys, pure=False, retries=retries))

    try:
        top_up()
        for future in results:
            task = running.pop(future.key)
            # Both wait where the worker that held the result has died since, and the scheduler asks another one.
            error = future.exception()
            if isinstance(error, CancelledError):
                raise error
            if error is not None:
                failed.append((task, f"{type(error).__name__}: {error}"))
            else:
                done(future.result())
            future.release()
            if len(running) <= window // 2:
                top_up()
    except (CancelledError, CommClosedError) as error:
        raise RunnerLostError("the scheduler is gone") from error
    return failed


def run(
    client: Client,
    plan: Plan,
    *,
    url: str | None = None,
    storage_options: Mapping[str, Any] | None = None,
    threads: int = 1,
    per_task: int | None = None,
    window: int | None = None,
    retries: int = 5,
    progress: bool | Progress | None = True,
) -> Summary:
    """Solve what is missing of a plan on a Dask cluster, and finish it.

    Parameters
    ----------
    client : distributed.Client
        The cluster.
    plan : Plan
        Its folder must be one that all workers see, unless `url` is given; so must its table of points.
    url : str, optional
        Folder in an object store as fsspec has it, such as `s3://bucket/map`.
    storage_options : mapping, optional
        What fsspec needs for it.
    threads : int
        Threads of a task.
    per_task : int, optional
        Consecutive parts of a task; as many as take ten nominal seconds unless given.
    window : int, optional
        Tasks that the scheduler has at a time; 16 and twice the threads of the cluster unless given.
    retries : int
        How often a task that raises is tried again.
    progress : bool or callable
        As in `solve_many`.

    Raises
    ------
    PartError
        If a part is damaged, or could not be solved; the others are solved.
    RunnerLostError
        If the scheduler is gone: run again, with any cluster.
    """
    store = _Store(url, storage_options or {}) if url is not None else None
    if store is not None:
        store.begin(plan)
    _, found = store.survey(plan) if store is not None else plan._survey(False)
    if found.damaged:
        raise PartError(incomplete(plan.parts, found) + "; remove them, and run again")
    per_task = per_task or _per_task(plan)
    skipped = plan.parts - sum(stop - start for start, stop in found.missing)
    show = _shown(progress)
    rows, failed_rows, solved = found.rows, found.failed, 0

    def done(parts: list[SolvedPart]) -> None:
        nonlocal rows, failed_rows, solved
        solved += len(parts)
        rows += sum(part["rows"] for part in parts)
        failed_rows += sum(part["failed"] for part in parts)
        if show is not None:
            show(rows, plan.rows)

    points = str(plan.points.absolute()) if plan.points is not None else None
    place = _Place(plan.text, str(plan.folder.absolute()), url, dict(storage_options or {}), points, threads)
    try:
        lost = _drive(client, _solve, _tasks(found.missing, per_task), place, window, retries, done)
    except RunnerLostError as error:
        count = skipped + solved
        message = f"{error}; run again: at least {count} of {plan.parts} parts are finished and stay"
        raise RunnerLostError(message) from error
    if lost:
        (first, last), why = min(lost)
        more = f", and {len(lost) - 1} tasks more" if len(lost) > 1 else ""
        raise PartError(f"parts {first} to {last - 1}{more} could not be solved: {why}")
    if store is None:
        plan.finish()
    else:
        parts, found = store.survey(plan)
        if not found.complete:
            raise PartError(incomplete(plan.parts, found))
        store.finish(parts)
    return Summary(skipped + solved, skipped, rows, failed_rows)


def verify(
    client: Client,
    plan: Plan,
    *,
    url: str,
    storage_options: Mapping[str, Any] | None = None,
    deep: bool = False,
) -> Verification:
    """Say which parts of a plan are in a store; read all of their bytes on the cluster if `deep`, else their footers.

    Parameters are those of `run`.
    """
    options = dict(storage_options or {})
    parts, found = _Store(url, options).survey(plan)
    if not deep:
        return found
    there = _ranges(part[0] for part in parts)
    damaged: list[tuple[str, str]] = []
    place = _Place(plan.text, "", url, options, None, 1)
    failed = _drive(client, _check, _tasks(there, _per_task(plan)), place, None, 2, damaged.extend)
    damaged += [(f"parts {first} to {last - 1}", why) for (first, last), why in failed]
    complete = found.complete and not damaged
    return found._replace(damaged=sorted(found.damaged + damaged), complete=complete)
