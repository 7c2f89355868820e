"""Folders of parts: plans, the solution of parts in any order and on any machine, and the state of a folder."""

from __future__ import annotations

import os
from collections.abc import Iterable, Mapping, Sequence
from pathlib import Path
from typing import NamedTuple, Self, TypedDict, Unpack

from ballscrew import _core
from ballscrew._api import (
    Linspace,
    Normal,
    Point,
    Progress,
    Solver,
    Uniform,
    _axes,
    _case,
    _columns,
    _how,
    _laws,
    _list,
    _shown,
)
from ballscrew._errors import InputError, PartError
from ballscrew._vocabulary import Output

__all__ = [
    "Estimate",
    "Plan",
    "SolvedPart",
    "Summary",
    "Verification",
    "plan",
    "run_part",
    "solve_part",
]


class SolvedPart(TypedDict):
    """Data of a finished part. It consists of plain numbers and a string, so every task runner can pass it on."""

    part: int
    rows: int
    failed: int
    bytes: int
    data_sha256: str
    skipped: bool


class Summary(NamedTuple):
    """Result of a run.

    Attributes
    ----------
    parts : int
        Requested parts that exist now.
    skipped : int
        Parts that existed before.
    rows, failed : int
        Number of rows of these parts, and of rows without a result.
    """

    parts: int
    skipped: int
    rows: int
    failed: int


class Estimate(NamedTuple):
    """Nominal cost of a plan: core-hours, and an upper bound of the size in bytes."""

    core_hours: float
    bytes: float


class Verification(NamedTuple):
    """State of the parts of a plan.

    Attributes
    ----------
    missing : list of (int, int)
        Ranges of missing parts, (first, last + 1).
    damaged : list of (str, str)
        Damaged files with the reasons.
    foreign : list of str
        Other files among the parts that are not Parquet files. Foreign Parquet files and folders are in `damaged`.
    complete : bool
        True if no part is missing or damaged.
    rows, failed : int
        Number of existing rows, and of rows without a result.
    """

    missing: list[tuple[int, int]]
    damaged: list[tuple[str, str]]
    foreign: list[str]
    complete: bool
    rows: int
    failed: int


class Plan(_core.Plan):
    """Plan of a folder, which contains everything that determines the content of its parts.

    Use `plan` or `Plan.open` to create a plan.

    Attributes
    ----------
    id, text : str
        SHA-256 of the text, and the text of `plan.json`.
    rows, parts, rows_per_part : int
        Number of rows, of parts, and of rows per part. The last part may have fewer rows.
    folder : path
        The folder.
    points : path or None
        Path of the table of points. Defaults to the file beside the folder.
    """

    folder: Path
    points: Path | None

    def __new__(
        cls, text: str, folder: str | os.PathLike[str], points: str | os.PathLike[str] | None = None
    ) -> Self:
        self = super().__new__(cls, text)
        self.folder, self.points = Path(folder), Path(points) if points is not None else None
        return self

    @classmethod
    def open(cls, folder: str | os.PathLike[str], *, points: str | os.PathLike[str] | None = None) -> Plan:
        """Open the plan stored in a folder."""
        return cls(_core.Plan._within(Path(folder)).text, folder, points)

    @property
    def files(self) -> list[str]:
        """Names of the files of all parts, which are in `data/` of the folder."""
        return [f"part-{part:06}.parquet" for part in range(self.parts)]

    def estimate(self) -> Estimate:
        """Expected core-hours (nominal times for rolling balls) and maximum size in bytes."""
        seconds, size = self._cost()
        return Estimate(seconds / 3600, size)

    def run(
        self,
        parts: Iterable[int] | None = None,
        *,
        repair: bool = False,
        threads: int | None = None,
        progress: bool | Progress | None = None,
    ) -> Summary:
        """Solve parts on this machine. Existing parts are kept.

        Parameters
        ----------
        parts : iterable of int, optional
            Numbers of the parts. Defaults to all parts, after which the folder is also finished.
        repair : bool
            Verify all bytes of existing parts, and solve damaged parts again.
        threads : int, optional
            Number of threads. Defaults to all cores.
        progress : bool or callable, optional
            As in `solve_many`.
        """
        which = sorted(set(parts)) if parts is not None else None
        solved, there = self._solve_into(self.folder, which, self.points, repair, threads, _shown(progress))
        return Summary(len(solved), len(there), sum(part[2] for part in solved), sum(part[3] for part in solved))

    def verify(self, deep: bool = False) -> Verification:
        """List missing and damaged parts. If `deep` is true, all bytes are read, otherwise only the footers."""
        return self._verified(deep, False)

    def _verified(self, deep: bool, finish: bool) -> Verification:
        parts, missing, damaged, foreign = self._survey(self.folder, deep, finish)
        rows, failed = sum(part[2] for part in parts), sum(part[3] for part in parts)
        told = [(str(path), why) for path, why in damaged], [str(path) for path in foreign]
        return Verification(missing, *told, not missing and not damaged, rows, failed)

    def finish(self) -> None:
        """Write `parts.parquet`, and remove unfinished files.

        Raises
        ------
        PartError
            If a part is missing or damaged.
        """
        found = self._verified(False, True)
        if not found.complete:
            count = sum(stop - start for start, stop in found.missing)
            words = [f"{count} of {self.parts} parts are missing"] if count else []
            raise PartError("; ".join(words + [f"{path} {why}" for path, why in found.damaged[:3]]))

    def __repr__(self) -> str:
        return f"Plan({str(self.folder)!r}: {self.rows:,} rows in {self.parts:,} parts, {self.id[:12]})"


def plan(
    folder: str | os.PathLike[str],
    base: Point = None,
    /,
    *,
    vary: Mapping[str, Linspace | Iterable[float]] | None = None,
    draw: Mapping[str, Uniform | Normal] | None = None,
    samples: int | None = None,
    seed: int = 0,
    points: str | os.PathLike[str] | None = None,
    keep: Sequence[str] = (),
    columns: Sequence[Output] | None = None,
    rows_per_part: int | None = None,
    **solver: Unpack[Solver],
) -> Plan:
    """Create the plan of a folder, or open a folder with the same plan.

    Parameters
    ----------
    folder : path
        Folder of the parts. It must be new or empty, or have the same plan.
    base : Case or mapping, optional
        Inputs that are not varied.
    vary, draw, points
        Exactly one source of the rows: a grid as in `sweep`; a mapping of names to `uniform(low, high)` or
        `normal(mean, deviation)`, with the number of rows `samples` and a `seed`; or a file with a table, preferably
        Parquet.
    keep : sequence of str
        Further columns of the table to copy.
    columns, **solver
        As in `solve_many`.
    rows_per_part : int, optional
        Number of rows per part. By default, it depends on the number of rows and on the model.

    Raises
    ------
    InputError
        For invalid inputs, and for a folder with another plan.

    Examples
    --------
    >>> import ballscrew as bs, tempfile
    >>> screw = bs.Case(lead_angle_deg=5, contact_angle_deg=45)
    >>> with tempfile.TemporaryDirectory() as folder:
    ...     plan = bs.plan(folder, screw, vary={"friction_coefficient": bs.linspace(0.02, 0.1, 1000)},
    ...                    model="closed-form", columns=["efficiency"])
    ...     plan.run(), plan.verify().complete
    (Summary(parts=1, skipped=0, rows=1000, failed=0), True)
    """
    if sum(given is not None for given in (vary, draw, points)) != 1:
        raise InputError("give one of vary, draw and points for the points of a plan")
    if (draw is None) != (samples is None):
        raise InputError("give both draw (the distributions) and samples (the number of rows)")
    random = None
    if draw is not None and samples is not None:
        random = (seed, samples, _laws(draw))
    table = Path(points) if points is not None else None
    core = _core.Plan._of(
        _case(base, {}),
        _axes(vary or {}),
        random,
        (table, _list("keep", keep)) if table is not None else None,
        _how(solver),
        _columns(columns),
        rows_per_part,
    )
    core._begin(Path(folder))
    return Plan(core.text, folder, table)


def run_part(
    text: str,
    part: int,
    folder: str | os.PathLike[str],
    *,
    points: str | os.PathLike[str] | None = None,
    threads: int = 1,
) -> SolvedPart:
    """Solve one part of a plan. Task runners such as Ray, joblib or Airflow need only this function.

    Parameters
    ----------
    text : str
        `Plan.text`.
    part : int
        Number of the part.
    folder : path
        Folder of the parts. It is created if it does not exist.
    points : path, optional
        Path of the table of points of the plan. Defaults to the file beside the folder.
    threads : int
        Number of threads.
    """
    planned = Plan(text, folder, points)
    parts, there = planned._solve_into(planned.folder, [part], planned.points, False, threads, None)
    _, _, rows, failed, _, size, sha256 = parts[0]
    return SolvedPart(part=part, rows=rows, failed=failed, bytes=size, data_sha256=sha256, skipped=bool(there))


def solve_part(
    text: str,
    part: int,
    *,
    points: str | os.PathLike[str] | None = None,
    threads: int = 1,
) -> _core.Arrow:
    """Solve one part of a plan in memory, for statistics of rows that are not stored.

    Parameters
    ----------
    text : str
        `Plan.text`.
    part : int
        Number of the part.
    points : path, optional
        Path of the table of points, if the plan has one.
    threads : int
        Number of threads.

    Returns
    -------
    Arrow
        Rows of the part, for `polars.DataFrame`, `pyarrow.table` and any other reader of Arrow streams.

    Examples
    --------
    >>> import ballscrew as bs, polars as pl, tempfile
    >>> with tempfile.TemporaryDirectory() as folder:
    ...     plan = bs.plan(folder, bs.Case(lead_angle_deg=5, contact_angle_deg=45), model="closed-form",
    ...                    vary={"friction_coefficient": bs.linspace(0.02, 0.1, 1000)}, columns=["efficiency"])
    >>> pl.DataFrame(bs.solve_part(plan.text, 0))["efficiency"].max() > 0.9
    True
    """
    return _core.Plan(text)._solve(part, Path(points) if points is not None else None, threads)
