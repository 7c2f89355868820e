"""Solve large tables in parts, in any order and on any machine, and check the folders that contain the parts."""

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
    """Data of a finished part. All values are plain numbers and strings, so every task runner can return them."""

    part: int
    rows: int
    failed: int
    bytes: int
    data_sha256: str
    skipped: bool


class Summary(NamedTuple):
    """Result of solving parts of a plan.

    Attributes
    ----------
    parts : int
        Number of requested parts that exist now.
    skipped : int
        Number of parts that existed before the run.
    rows : int
        Number of rows in the requested parts.
    failed : int
        Number of rows without a result.
    """

    parts: int
    skipped: int
    rows: int
    failed: int


class Estimate(NamedTuple):
    """Estimated cost of a plan: core-hours, and an upper bound of the size in bytes."""

    core_hours: float
    bytes: float


class Verification(NamedTuple):
    """State of the parts of a plan.

    Attributes
    ----------
    missing : list of (int, int)
        Ranges of missing parts, as pairs (first, last + 1).
    damaged : list of (str, str)
        Damaged files, each with the reason. The list also contains Parquet files and folders that are not part of the
        plan.
    foreign : list of str
        Files in the folder that are not part of the plan, except the Parquet files and folders in `damaged`.
    complete : bool
        True if no part is missing or damaged.
    rows : int
        Number of rows in the existing parts.
    failed : int
        Number of rows without a result.
    """

    missing: list[tuple[int, int]]
    damaged: list[tuple[str, str]]
    foreign: list[str]
    complete: bool
    rows: int
    failed: int


class Plan(_core.Plan):
    """Plan of a table that is solved in parts. It contains all settings that determine the content of the parts.

    Use `plan` or `Plan.open` to create a plan.

    Attributes
    ----------
    id : str
        SHA-256 hash of `text`.
    text : str
        Text of `plan.json`.
    rows, parts : int
        Number of rows and number of parts.
    rows_per_part : int
        Number of rows per part. The last part may have fewer rows.
    folder : path
        Folder of the plan and its parts.
    points : path or None
        Path of the table of points. Defaults to the file that the plan names, next to the folder.
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
        """File names of all parts. The files are in the subfolder `data/`."""
        return [f"part-{part:06}.parquet" for part in range(self.parts)]

    def estimate(self) -> Estimate:
        """Return the estimated core-hours (assuming that the balls roll) and the maximum size in bytes."""
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
        """Solve parts of the plan on this machine. Existing parts are kept.

        Parameters
        ----------
        parts : iterable of int, optional
            Numbers of the parts. By default, all parts are solved, and the folder is then finished (see `finish`).
        repair : bool
            If true, verify all bytes of existing parts and solve damaged parts again.
        threads : int, optional
            Number of threads. Defaults to all cores.
        progress : bool or callable, optional
            As in `solve_many`.
        """
        which = sorted(set(parts)) if parts is not None else None
        solved, there = self._solve_into(self.folder, which, self.points, repair, threads, _shown(progress))
        return Summary(len(solved), len(there), sum(part[2] for part in solved), sum(part[3] for part in solved))

    def verify(self, deep: bool = False) -> Verification:
        """List missing and damaged parts. If `deep` is true, read all bytes; otherwise read only the footers."""
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
    """Create a plan in a folder, or open a folder that contains the same plan.

    Parameters
    ----------
    folder : path
        Folder of the parts. It must be new or empty, or contain the same plan.
    base : Case or mapping, optional
        Inputs that are not varied.
    vary, draw, points
        Source of the rows; exactly one source is required. `vary` describes a grid as in `sweep`. `draw` maps names to
        `uniform(low, high)` or `normal(mean, deviation)`; `samples` is then the number of rows and `seed` the seed of
        the random numbers. `points` is a file with a table, preferably Parquet.
    keep : sequence of str
        Other columns of the table to copy.
    columns, **solver
        As in `solve_many`.
    rows_per_part : int, optional
        Number of rows per part. By default, it depends on the number of rows and on the model.

    Raises
    ------
    InputError
        If an input is invalid, or if the folder contains another plan.

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
        raise InputError("the points of a plan require exactly one of vary, draw and points")
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
    """Solve one part of a plan. Tasks of Ray, joblib or Airflow need only this function.

    Parameters
    ----------
    text : str
        `Plan.text`.
    part : int
        Number of the part.
    folder : path
        Folder of the parts. The folder is created if it does not exist.
    points : path, optional
        Path of the table of points. Defaults to the file that the plan names, next to the folder.
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
    """Solve one part of a plan in memory without storing its rows, for example to calculate statistics.

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
        Rows of the part. `polars.DataFrame`, `pyarrow.table` and all other readers of Arrow streams accept this object.

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
