"""The public functions of the package. They are thin wrappers around the compiled module `_core`."""

from __future__ import annotations

import difflib
import itertools
import math
import os
import re
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from importlib import import_module
from pathlib import Path
from types import MappingProxyType
from typing import TYPE_CHECKING, Any, Literal, NamedTuple, NoReturn, Self, TypeAlias, TypedDict, Unpack, cast, overload

from ballscrew import _core
from ballscrew._errors import InputError, NoSolutionError, NotConvergedError, SolveError
from ballscrew._vocabulary import (
    AxisFields,
    CaseFields,
    Control,
    Friction,
    Inputs,
    JamFields,
    Model,
    ModelOptimumFields,
    NutFields,
    OptimumFields,
    Output,
    PhaseFields,
    RatingsFields,
    RatingStepsFields,
    ScrewFields,
    SlipFields,
    SolutionFields,
)

if TYPE_CHECKING:
    import numpy as np
    import pandas as pd
    import polars as pl
    import pyarrow as pa
    import xarray as xr
    from numpy.typing import NDArray

    Floats = NDArray[np.float64]

__all__ = [
    "INPUTS",
    "MODELS",
    "OUTPUTS",
    "REQUIREMENTS",
    "AxisReport",
    "AxisScrew",
    "CalibrationReport",
    "Case",
    "Ellipse",
    "EllipsesReport",
    "FitReport",
    "FittedPoint",
    "FittedValue",
    "Grid",
    "JamReport",
    "ModelOptimum",
    "MotionReport",
    "NotGiven",
    "NutReport",
    "Nuts",
    "OptimumReport",
    "Phase",
    "Quantity",
    "RatingSteps",
    "RatingsReport",
    "Report",
    "Rule",
    "SampleReport",
    "Section",
    "SelectReport",
    "SlipReport",
    "Solution",
    "Step",
    "Table",
    "axis",
    "compare",
    "draw",
    "ellipses",
    "fit",
    "gradient",
    "jam",
    "linspace",
    "normal",
    "nut",
    "optimum",
    "ratings",
    "select",
    "select_nuts",
    "sensitivities",
    "slip",
    "solve",
    "solve_many",
    "sweep",
    "uniform",
    "validate",
]

Progress = Callable[[int, int], object]

Point: TypeAlias = "Case | Mapping[str, Any] | None"
"""A case, a mapping of input names to values, or None if keywords give all inputs."""


class Quantity(NamedTuple):
    """An input or output of the program.

    Attributes
    ----------
    name : str
        Name, which ends with the unit.
    unit : str
        Unit. It is empty for a dimensionless quantity.
    about : str
        Meaning of the quantity.
    default : float or None
        Default value of an input.
    rule : str or None
        Rule that the value of an input must satisfy.
    values : tuple of str
        Permitted values of a quantity that is a text.
    kind : str
        JSON type: number, integer, boolean, string or array.
    analysis : str or None
        Analysis that calculates an output: slip, jam, optimum, ratings, nut, axis or warm. None for an output of a
        solution.
    """

    name: str
    unit: str
    about: str
    default: float | None = None
    rule: str | None = None
    values: tuple[str, ...] = ()
    kind: str = "number"
    analysis: str | None = None


def _first_of_each(quantities: Iterable[Quantity]) -> Mapping[str, Quantity]:
    found: dict[str, Quantity] = {}
    for quantity in quantities:
        found.setdefault(quantity.name, quantity)
    return MappingProxyType(found)


INPUTS: Mapping[str, Quantity] = _first_of_each(itertools.chain(
    (Quantity(name, unit, about, default=default, rule=rule)
     for name, unit, about, default, rule in _core.inputs()),
    (Quantity(name, "", about, values=tuple(values), kind=kind) for name, about, kind, values in _core.case_choices()),
))
"""All inputs by name: first the numbers, then texts, lists and flags."""

# If an output of the solution is also an output of an analysis, the entry describes the output of the solution.
OUTPUTS: Mapping[str, Quantity] = _first_of_each(
    Quantity(name, unit, about, kind=kind, values=tuple(values), analysis=analysis)
    for name, unit, about, kind, values, analysis in _core.outputs()
)
"""All outputs by name: first the outputs of a solution, then the outputs of the analyses."""

MODELS: tuple[Model, ...] = cast("tuple[Model, ...]", tuple(_core.MODELS))
"""The models, with `auto` first."""

REQUIREMENTS: Mapping[str, Quantity] = _first_of_each(
    Quantity(name, unit, about, default=default, rule=rule)
    for name, unit, about, default, rule in _core.requirements()
)
"""Keys of a requirement (see `select`) that are not inputs of a case."""

_NUMBERS = frozenset(name for name, *_ in _core.inputs())
_OF_A_SOLUTION = [quantity for quantity in OUTPUTS.values() if quantity.analysis is None]


class Case(CaseFields):
    """A screw and its operating point, described by named inputs. The object is immutable.

    Parameters
    ----------
    base : Case or mapping, optional
        Provides the inputs that are not given as keywords.
    **inputs
        Inputs by name, each in the unit at the end of its name. `lead_mm` replaces a lead angle of `base`, and vice
        versa. None removes an input of `base`. Objects with `.to` and `.magnitude` (pint quantities) are converted.

    Raises
    ------
    InputError
        If a name is unknown or a value violates a rule.

    Examples
    --------
    >>> import ballscrew as bs
    >>> screw = bs.Case(ball_diameter_mm=6.35, pitch_circle_diameter_mm=41.5, lead_mm=20)
    >>> screw.lead_mm, screw.axial_load_N
    (20.0, None)
    >>> screw.replace(lead_mm=10).lead_mm
    10.0
    """

    __slots__ = ()

    def __new__(cls, base: Point | _core.Case = None, /, **inputs: Unpack[Inputs]) -> Self:
        given: dict[str, Any] = dict(inputs)
        if isinstance(base, (str, os.PathLike)):
            raise InputError(f"{os.fspath(base)!r} is not a case; to read a case file, use Case.read(path)")
        if base is not None and not isinstance(base, _core.Case):
            given = {**base, **given}
            base = None
        for name, value in given.items():
            if value is not None and type(value) is not float and name in _NUMBERS:
                given[name] = _number(name, value)
        return super().__new__(cls, base, given)

    @classmethod
    def read(cls, path: str | os.PathLike[str]) -> Self:
        """Read a case file."""
        try:
            return cls.from_json(Path(path).read_text(encoding="utf-8-sig"))
        except InputError as error:
            error.add_note(f"in {os.fspath(path)}")
            raise

    @classmethod
    def from_json(cls, text: str) -> Self:
        """Read a case from JSON text."""
        return cls(_core.Case.of_json(text))

    def write(self, path: str | os.PathLike[str]) -> None:
        """Write a case file."""
        Path(path).write_text(self.to_json() + "\n", encoding="utf-8")

    def replace(self, **inputs: Unpack[Inputs]) -> Self:
        """Return a copy of the case with changed inputs. A lead replaces a lead angle, and vice versa."""
        return type(self)(self, **inputs)

    __replace__ = replace

    def to_dict(self) -> dict[str, Any]:
        """Return the given inputs as a dict."""
        return self._to_dict()

    def keys(self) -> Iterable[str]:
        """Return the names of the given inputs. Together with `[]`, this method supports `{**case}`."""
        return self.to_dict().keys()

    def items(self) -> Iterable[tuple[str, Any]]:
        """Return the names and values of the given inputs."""
        return self.to_dict().items()

    def __getitem__(self, name: str) -> Any:
        return self.to_dict()[name]

    def __iter__(self) -> Iterator[str]:
        return iter(self.to_dict())

    def _ipython_key_completions_(self) -> list[str]:
        return list(self.keys())

    def __repr__(self) -> str:
        return f"Case({', '.join(f'{name}={value!r}' for name, value in self.to_dict().items())})"

    def __reduce__(self) -> tuple[Any, ...]:
        return type(self).from_json, (self.to_json(),)

    def _repr_html_(self) -> str:
        rows = [(name, value, INPUTS[name].unit if name in INPUTS else "") for name, value in
                self.to_dict().items()]
        return _html(rows)


class Solution(SolutionFields):
    """Solution at one operating point, with a status, a message, and a property for each output.

    Outputs that the model does not calculate are NaN.

    Attributes
    ----------
    status : str
        `converged`, or the reason why there is no result.
    model : str
        Model that solved the point.
    message : str or None
        Reason why there is no result.
    choice : str or None
        Reason why `auto` chose the model.
    regime : str or None
        Regime of the motion, such as rolling.
    warnings : list of str
        Warnings to read before using the numbers.
    case : Case
        The solved case.
    """

    __slots__ = ()

    @property
    def converged(self) -> bool:
        """True if there is a result."""
        return self.status == "converged"

    @property
    def screw_torque_Nm(self) -> float:
        """Screw torque [N m], which includes balls, preload, seals and support bearings.

        The torque is NaN if load, speed or friction is not given. If the torque cannot be calculated, for example because
        the balls have no steady motion, an `InputError` states the reason and, if an input is the cause, its `key`,
        `value` and `rule`. `to_dict()["torque_parts"]` contains the components of the torque.
        """
        return self.screw_torque()

    def to_dict(self) -> dict[str, Any]:
        """Return a dict with the names and values of `bsm solve --show band --json`.

        Outputs that the model does not calculate are None.
        """
        return self._to_dict()

    @property
    def intervals(self) -> dict[str, Any]:
        """Ends of the 90 % interval of each number that depends on an estimated groove, by name.

        To calculate the intervals, the point is solved again for 128 possible grooves, or for 16 in a warm state. The
        dict is empty if the case contains the groove geometry.
        """
        return _intervals(self.to_dict())

    def __repr__(self) -> str:
        if not self.converged:
            return f"<Solution {self.model}: {self.status}, {self.message}>"
        values = {name: getattr(self, name) for name in _MAIN}
        main = [f"{name} {_short(value)} {OUTPUTS[name].unit}".rstrip() for name, value in values.items()
                if not math.isnan(value)]
        return f"<Solution {self.model}: {', '.join(main)}>"

    if not TYPE_CHECKING:

        def __getattr__(self, name: str) -> NoReturn:
            raise AttributeError(f"a solution has no `{name}`{_near(name, dir(type(self)))}", name=name, obj=self)

    def __reduce__(self) -> tuple[Any, ...]:
        # Solving the case again with the same program gives bit-identical results.
        return type(self), (self.case, self.how)

    def _repr_html_(self) -> str:
        rows = [("model", self.model, ""), ("status", self.status, "")]
        if self.message:
            rows.append(("message", self.message, ""))
        values = self.to_dict()
        ends = _intervals(values)
        rows += [(q.name, _with_interval(values[q.name], ends.get(q.name)), q.unit)
                 for q in _OF_A_SOLUTION if values[q.name] is not None]
        return _html(rows)


_MAIN = ("efficiency", "ball_torque_Nm", "nut_normal_load_N", "nut_contact_angle_deg")


class TextColumn:
    """Column of texts with few distinct values. Each row stores an index into `categories`."""

    __slots__ = ("_found", "_load")

    def __init__(self, load: Callable[[], tuple[Any, list[str]]]) -> None:
        self._load = load
        self._found: tuple[NDArray[np.int8], tuple[str, ...]] | None = None

    def _get(self) -> tuple[NDArray[np.int8], tuple[str, ...]]:
        """Load the texts on first access, because most users do not need the texts."""
        if self._found is None:
            import numpy as np

            buffer, categories = self._load()
            self._found = np.frombuffer(buffer, np.int8), tuple(categories)
        return self._found

    @property
    def codes(self) -> NDArray[np.int8]:
        """Index into `categories` for each row. A missing text has the index -1."""
        return self._get()[0]

    @property
    def categories(self) -> tuple[str, ...]:
        """Distinct texts of the column."""
        return self._get()[1]

    def __len__(self) -> int:
        return len(self.codes)

    def __getitem__(self, row: int) -> str | None:
        code = int(self.codes[row])
        return None if code < 0 else self.categories[code]

    def __eq__(self, word: object) -> Any:
        if isinstance(word, str):
            place = self.categories.index(word) if word in self.categories else -2
            return self.codes == place
        return NotImplemented

    def __reduce__(self) -> tuple[Any, ...]:
        return _text_column, self._get()

    def to_numpy(self) -> NDArray[np.object_]:
        """Return the texts as an array."""
        import numpy as np

        return np.array([*self.categories, None], dtype=object)[self.codes]

    def __repr__(self) -> str:
        return f"TextColumn({len(self)} of {', '.join(self.categories)})"


def _text_column(codes: NDArray[np.int8], categories: Sequence[str]) -> TextColumn:
    return TextColumn(lambda: (codes, list(categories)))


class AxisColumn:
    """Column with the repeated values of a grid axis. Each value is stored only once."""

    __slots__ = ("_each", "_times", "_values")

    def __init__(self, values: Floats, each: int, times: int) -> None:
        self._values = values
        self._each = each
        self._times = times

    def to_numpy(self) -> Floats:
        """Return an array with one value per row."""
        import numpy as np

        return np.tile(np.repeat(self._values, self._each), self._times)


class MessageColumn:
    """Column of messages, most of which are None. Messages are created on first access."""

    __slots__ = ("_length", "_load", "_texts")

    def __init__(self, load: Callable[[], Iterable[tuple[int, str]]], length: int) -> None:
        self._load = load
        self._length = length
        self._texts: dict[int, str] | None = None

    @property
    def texts(self) -> dict[int, str]:
        """Messages by row index. Rows without a message are omitted."""
        if self._texts is None:
            self._texts = dict(self._load())
        return self._texts

    def to_numpy(self) -> NDArray[np.object_]:
        """Return an array with the message of each row, or None."""
        import numpy as np

        column = np.full(self._length, None, dtype=object)
        for row, text in self.texts.items():
            column[row] = text
        return column

    def __reduce__(self) -> tuple[Any, ...]:
        return _message_column, (self.texts, self._length)


def _message_column(texts: Mapping[int, str], length: int) -> MessageColumn:
    return MessageColumn(texts.items, length)


class Table:
    """Table with columns of equal length. The object is immutable.

    `table["efficiency"]` is a read-only NumPy array. Booleans are stored as 1 and 0. A list of names, a slice or a
    mask selects columns or rows and returns a new table, as in `table[["model", "efficiency"]]`, `table[:5]` and
    `table[table.ok]`. To create a data frame, use `to_pandas`, `to_polars`, `to_arrow`, or any library that reads
    Arrow streams.
    """

    def __init__(
        self,
        columns: Mapping[str, Any],
        units: Mapping[str, str],
        length: int,
        rows: _core.Rows | None = None,
    ) -> None:
        self._columns = dict(columns)
        self._units = dict(units)
        self._length = length
        self._rows = rows

    def __len__(self) -> int:
        return self._length

    @property
    def column_names(self) -> list[str]:
        """Names of the columns."""
        return list(self._columns)

    @property
    def units(self) -> dict[str, str]:
        """Unit of each column."""
        return dict(self._units)

    @property
    def shape(self) -> tuple[int, ...]:
        """Number of rows and number of columns."""
        return (self._length, len(self._columns))

    def __contains__(self, name: str) -> bool:
        return name in self._columns

    def __iter__(self) -> Iterator[str]:
        return iter(self._columns)

    def __eq__(self, other: object) -> bool:
        if not isinstance(other, Table):
            return NotImplemented
        kinds = (type(self), self.column_names, self._units) == (type(other), other.column_names, other._units)
        return kinds and all(_same(self[name], other[name]) for name in self._columns)

    __hash__ = None  # type: ignore[assignment]

    def __array__(self, dtype: object = None, copy: bool | None = None) -> NoReturn:
        raise TypeError('a table has columns of several types; select one, such as table["efficiency"], or use to_pandas().to_numpy()')

    @overload
    def __getitem__(self, key: str, /) -> NDArray[Any]: ...

    @overload
    def __getitem__(self, key: list[str] | slice | NDArray[Any] | list[bool] | list[int], /) -> Table: ...

    def __getitem__(self, key: Any, /) -> Any:
        import numpy as np

        if isinstance(key, str):
            return self._array(key)
        if isinstance(key, list) and all(isinstance(name, str) for name in key):
            columns = {name: self._column(name) for name in key}
            return self._part(columns, np.arange(self._length))
        places = key if isinstance(key, slice) else np.asarray(key) if isinstance(key, (list, np.ndarray)) else None
        if places is None or (not isinstance(places, slice) and (places.ndim != 1 or places.dtype.kind not in "biu")):
            raise TypeError(f"a table is indexed with a column name, a list of names, a slice or a mask of rows, not with {key!r}; "
                            "to_pandas() returns a frame, which selects rows with .iloc and .query")
        rows = np.arange(self._length)[places]
        return self._part({name: _rows_of(name, column, rows) for name, column in self._columns.items()}, rows)

    def _part(self, columns: Mapping[str, Any], rows: NDArray[np.int_]) -> Table:
        """Return a new table with the given columns. `rows` contains the indices of its rows in the original table."""
        return Table(columns, {name: unit for name, unit in self._units.items() if name in columns}, len(rows))

    def head(self, rows: int = 5) -> Table:
        """Return the first rows as a new table."""
        return self[: max(rows, 0)]

    def _ipython_key_completions_(self) -> list[str]:
        return self.column_names

    def _column(self, name: str) -> Any:
        try:
            return self._columns[name]
        except KeyError:
            raise KeyError(f"no column `{name}`{_near(name, self)}; the columns are {_few(self._columns)}") from None

    def _array(self, name: str) -> NDArray[Any]:
        column = self._column(name)
        if isinstance(column, (TextColumn, AxisColumn, MessageColumn)):
            return column.to_numpy()
        if isinstance(column, _core.KeptColumn):
            return _kept_values(column)
        array: NDArray[Any] = column
        return array

    @property
    def status(self) -> TextColumn:
        """Status of each row."""
        status: TextColumn = self._columns["status"]
        return status

    @property
    def model(self) -> TextColumn:
        """Model that solved each row."""
        model: TextColumn = self._columns["model"]
        return model

    @property
    def ok(self) -> NDArray[np.bool_]:
        """True for rows with a result."""
        ok: NDArray[np.bool_] = self.status == "converged"
        return ok

    def message(self, row: int) -> str | None:
        """Return the reason why a row has no result.

        If the table was created with `text=True` and the row has a result, return why `auto` chose the model.
        """
        if not -self._length <= row < self._length:
            raise IndexError(f"row {row} of {self._length}")
        messages = self._columns.get("message")
        return messages.texts.get(row % self._length) if isinstance(messages, MessageColumn) else None

    def to_dict(self) -> dict[str, list[Any]]:
        """Return a dict that maps each column name to a list of values. Missing values are None."""
        return {name: [None if isinstance(v, float) and math.isnan(v) else v for v in self[name].tolist()]
                for name in self._columns}

    def __arrow_c_stream__(self, requested_schema: object | None = None) -> object:
        # According to the Arrow interface, a producer may ignore the requested schema.
        return self._arrow()

    def __reduce__(self) -> tuple[Any, ...]:
        return _thawed, (type(self), {**vars(self), "_rows": None})

    def _arrow(self) -> Any:
        import numpy as np

        columns: list[tuple[str, str, str, Any, list[str]]] = []
        for name, column in self._columns.items():
            unit = self._units.get(name, "")
            quantity = OUTPUTS.get(name)
            if isinstance(column, (AxisColumn, MessageColumn)):
                column = column.to_numpy()
            if isinstance(column, TextColumn):
                columns.append((name, unit, "words", column.codes, list(column.categories)))
            elif isinstance(column, _core.KeptColumn):
                columns.append((name, unit, "kept", column, []))
            elif column.dtype == object:
                columns.append((name, unit, "texts", column.tolist(), []))
            elif column.dtype == bool:
                columns.append((name, unit, "flags", column.astype(np.float64), []))
            elif quantity is not None and quantity.kind == "boolean":
                columns.append((name, unit, "flags", column, []))
            else:
                columns.append((name, unit, "numbers", np.ascontiguousarray(column), []))
        return _core.to_arrow(columns)

    def to_arrow(self) -> pa.Table:
        """Return a pyarrow table. The metadata of its fields contain the units."""
        table: pa.Table = _library("pyarrow", "to_arrow").table(self)
        return table

    def to_polars(self) -> pl.DataFrame:
        """Return a polars data frame."""
        frame: pl.DataFrame = _library("polars", "to_polars").DataFrame(self)
        return frame

    def to_pandas(self) -> pd.DataFrame:
        """Return a pandas data frame, in which `model` and `status` are categorical."""
        pandas = _library("pandas", "to_pandas")
        data: dict[str, Any] = {}
        for name, column in self._columns.items():
            data[name] = (
                pandas.Categorical.from_codes(column.codes, list(column.categories))
                if isinstance(column, TextColumn)
                else self[name]
            )
        frame: pd.DataFrame = pandas.DataFrame(data)
        return frame

    def write(self, path: str | os.PathLike[str]) -> None:
        """Write the table to a .csv, .jsonl or .parquet file, in the format of the program."""
        if self._rows is not None:
            self._rows.write(Path(path))
        elif any(isinstance(column, _core.KeptColumn) or self[name].dtype in (object, bool)
                 for name, column in self._columns.items()):
            raise TypeError("this table contains texts, or was pickled or selected; write it with to_pandas() or to_polars()")
        else:
            _core.write_numbers([(name, self[name]) for name in self._columns], Path(path))

    def __repr__(self) -> str:
        return f"<{type(self).__name__} {self._length} rows: {_few(self._columns)}>"

    def _repr_html_(self) -> str:
        import numpy as np

        failed = int(np.count_nonzero(~self.ok)) if "status" in self._columns else 0
        top = self[:10]
        filled = [name for name in self._columns if name != "message" or any(top["message"])]
        shown = filled[:12]
        few = [top[name] for name in shown]
        head = "".join(f"<th>{_escape(name)}</th>" for name in shown)
        body = "".join(
            "<tr>" + "".join(f"<td>{_escape(_short(column[row]))}</td>" for column in few) + "</tr>"
            for row in range(min(10, self._length))
        )
        words = f"{self._length} rows, {len(self._columns)} columns"
        words += f", {failed} without a result" if failed else ""
        return f"<table><tr>{head}</tr>{body}</table><p>{words}</p>"


def _rows_of(name: str, column: Any, rows: NDArray[np.int_]) -> Any:
    """Return the rows of a column that have the given indices."""
    if isinstance(column, TextColumn):
        return _text_column(column.codes[rows], column.categories)
    if isinstance(column, MessageColumn):
        whole = column.texts
        return _message_column({place: whole[row] for place, row in enumerate(rows.tolist()) if row in whole}, len(rows))
    if isinstance(column, _core.KeptColumn):
        values = _kept_values(column)
        if values.dtype == object and not all(value is None or isinstance(value, str) for value in values):
            raise TypeError(f"column `{name}` contains integers with missing values; select its rows in to_pandas() or to_polars()")
        return _kept(values[rows])
    part = (column.to_numpy() if isinstance(column, AxisColumn) else column)[rows]
    part.flags.writeable = False
    return part


def _thawed(kind: type[Table], state: Mapping[str, Any]) -> Table:
    table = object.__new__(kind)
    vars(table).update(state)
    for column in table._columns.values():
        if not isinstance(column, (TextColumn, AxisColumn, MessageColumn, _core.KeptColumn)):
            column.flags.writeable = False
    return table


class Grid(Table):
    """Table with one row per point of a grid. The first columns contain the axes. The last axis varies fastest."""

    def __init__(
        self,
        columns: Mapping[str, Any],
        units: Mapping[str, str],
        length: int,
        rows: _core.Rows,
        axes: Mapping[str, Floats],
        case: Case,
        settings: Mapping[str, Any],
    ) -> None:
        repeated, each = {}, length
        for name, values in axes.items():
            each //= max(len(values), 1)
            repeated[name] = AxisColumn(values, each, length // max(each * len(values), 1))
        super().__init__({**repeated, **columns}, units, length, rows)
        self._axes = dict(axes)
        self.case = case
        self.settings = dict(settings)

    @property
    def axes(self) -> dict[str, Floats]:
        """Values of each varied input, by name."""
        return dict(self._axes)

    @property
    def shape(self) -> tuple[int, ...]:
        """Number of values of each axis."""
        return tuple(len(values) for values in self._axes.values())

    def __eq__(self, other: object) -> bool:
        if not isinstance(other, Grid):
            return NotImplemented
        asked = (self.case, self.settings, list(self._axes)) == (other.case, other.settings, list(other._axes))
        return asked and all(_same(self._axes[name], other._axes[name]) for name in self._axes) and super().__eq__(other)

    __hash__ = None

    def grid(self, name: str) -> NDArray[Any]:
        """Return a column in the shape of the grid."""
        return self[name].reshape(self.shape)

    def __repr__(self) -> str:
        axes = " x ".join(f"{len(values)} {name}" for name, values in self._axes.items())
        return f"<{type(self).__name__} {axes}: {_few(name for name in self._columns if name not in self._axes)}>"

    def to_xarray(self) -> xr.Dataset:
        """Return an xarray dataset, whose dimensions are the axes of the grid in the same order."""
        import numpy as np

        xarray = _library("xarray", "to_xarray")

        def about(name: str) -> dict[str, str]:
            quantity = INPUTS.get(name) or OUTPUTS.get(name)
            return {"units": quantity.unit, "long_name": quantity.about} if quantity else {}

        dims = list(self._axes)
        data = {name: (dims, self.grid(name), about(name)) for name in self._columns if name not in self._axes}
        # NetCDF files cannot store a missing text.
        data["message"] = (dims, np.where(self.grid("message"), self.grid("message"), ""), {})
        coords = {name: (name, values, about(name)) for name, values in self._axes.items()}
        settings = {name: value for name, value in self.settings.items() if value is not None}
        dataset: xr.Dataset = xarray.Dataset(data, coords, {"case": self.case.to_json(), **settings})
        return dataset


class Nuts(Table):
    """Table of nuts from the catalog or from a manufacturer, with one row per nut.

    Attributes
    ----------
    warnings : list of str
        Messages about rows of a manufacturer's table whose ratings contradict their geometry, and warnings about the
        first nut.
    """

    def __init__(
        self,
        columns: Mapping[str, Any],
        units: Mapping[str, str],
        length: int,
        nuts: _core.Nuts | None,
        warnings: Sequence[str] = (),
        places: NDArray[np.int_] | None = None,
    ) -> None:
        super().__init__(columns, units, length)
        self._nuts = nuts
        self.warnings = list(warnings)
        # Indices of the rows in the compiled module, if this table contains only selected rows.
        self._places = places

    if TYPE_CHECKING:

        @overload
        def __getitem__(self, key: str, /) -> NDArray[Any]: ...

        @overload
        def __getitem__(self, key: list[str] | slice | NDArray[Any] | list[bool] | list[int], /) -> Nuts: ...

        def __getitem__(self, key: Any, /) -> Any: ...

        def head(self, rows: int = 5) -> Nuts: ...

    def _part(self, columns: Mapping[str, Any], rows: NDArray[np.int_]) -> Nuts:
        units = {name: unit for name, unit in self._units.items() if name in columns}
        places = rows if self._places is None else self._places[rows]
        return Nuts(columns, units, len(rows), self._nuts, self.warnings, places)

    def case(self, row: int = 0) -> Case:
        """Return the nut of a row as a case for `ratings`, `nut` and `axis`.

        If the table was created with a requirement, the case contains the operating point of the requirement.
        """
        if not -self._length <= row < self._length:
            raise IndexError(f"row {row} of {self._length}")
        if self._nuts is None:
            raise TypeError("a pickled table has no cases; call select_nuts again")
        row %= self._length
        return Case(self._nuts.case(row if self._places is None else int(self._places[row])))

    def __reduce__(self) -> tuple[Any, ...]:
        return _thawed, (type(self), {**vars(self), "_nuts": None})


class Section(Mapping[str, Any]):
    """Mapping of names to values, with the names of the program's JSON output. The object is read-only.

    Each number is also an attribute, such as `nut_mass_kg`. Numbers that were not calculated are None.
    """

    __slots__ = ("_entries",)

    def __init__(self, entries: Mapping[str, Any]) -> None:
        self._entries = dict(entries)

    def __getitem__(self, name: str) -> Any:
        if name not in self._entries:
            inside = {name: key for key, value in self._entries.items() if isinstance(value, Mapping) for name in value}
            raise KeyError(f"{name} is an entry of [{inside[name]!r}]" if name in inside
                           else f"{name}{_near(name, [*self._entries, *inside])}")
        return self._entries[name]

    def __iter__(self) -> Iterator[str]:
        return iter(self._entries)

    def __len__(self) -> int:
        return len(self._entries)

    def _ipython_key_completions_(self) -> list[str]:
        return list(self._entries)

    def _value(self, name: str) -> Any:
        """Return the value of a property, or None if the answer has no result."""
        return self._entries.get(name)

    if not TYPE_CHECKING:

        def __getattr__(self, name: str) -> NoReturn:
            kind = type(self)
            raise AttributeError(f"a {kind.__name__} has no `{name}`{_near(name, dir(kind))}", name=name, obj=self)

    def to_dict(self) -> dict[str, Any]:
        """Return the entries as a plain dict."""
        return dict(self._entries)

    @property
    def intervals(self) -> dict[str, Any]:
        """Ends of the 90 % interval of each number that depends on an estimated groove, by name.

        The intervals of tables and rules have the same layout as the tables and rules. The dict is empty if the case
        contains the groove geometry.
        """
        return _intervals(self._entries)

    def __repr__(self) -> str:
        return f"<{type(self).__name__}: {_few(self._entries)}>"


class Report(Section):
    """Result of an analysis, with the names of the program's JSON output. The object is read-only.

    Attributes
    ----------
    found : bool
        False if there is no result. The program would then exit with code 3.
    warnings : list of str
        Warnings to read before using the numbers.
    """

    __slots__ = ("found", "warnings")

    def __init__(self, entries: Mapping[str, Any], found: bool, warnings: Sequence[str]) -> None:
        super().__init__(entries)
        self.found = found
        self.warnings = list(warnings)

    @property
    def notes(self) -> list[str]:
        """Notes about the defaults that were used and the effects that were neglected."""
        notes: list[str] = self._entries.get("notes", [])
        return notes

    def __repr__(self) -> str:
        groove = ", groove estimated" if "groove_estimate" in self._entries else ""
        return f"<{type(self).__name__} found={self.found}{groove}: {_few(self._entries)}>"

    def _repr_html_(self) -> str:
        named = {**OUTPUTS, **INPUTS}
        ends = self.intervals
        estimated = self._entries.get("inputs", {}).get("estimated_inputs", ())
        rows: list[tuple[str, Any, str]] = []
        tables = ""
        for name, value in self._entries.items():
            for key, inner in value.items() if isinstance(value, Mapping) else [(name, value)]:
                if _is_plain(inner):
                    text = _with_interval(inner, ends.get(key)) + (" estimated" if key in estimated else "")
                    rows.append((key, text, named[key].unit if key in named else ""))
            if isinstance(value, list) and value and isinstance(value[0], Mapping):
                tables += _html_lines(name, value[:20])
        return _html(rows[:100]) + tables


class NotGiven(NamedTuple):
    """A missing input that a calculation treated as zero, or whose effect it omitted.

    Attributes
    ----------
    number : str
        Name of the calculated number.
    text : str
        The missing input, and how the calculation treats it.
    """

    number: str
    text: str


def _not_given(report: Report) -> list[NotGiven]:
    return [NotGiven(**row) for row in report.get("not_given", [])]


class MotionReport(Report):
    """Analysis of a steady motion.

    If there is no steady motion, the report contains `status` and ``message`` instead of numbers.
    """

    __slots__ = ()

    @property
    def model(self) -> str:
        """Model that calculated the motion."""
        model: str = self["model"]
        return model

    @property
    def status(self) -> str:
        """`converged`, or the reason why there is no steady motion."""
        status: str = self.get("status", "converged")
        return status

    @property
    def message(self) -> str | None:
        """Reason why there is no steady motion."""
        message: str | None = self.get("message")
        return message

    @property
    def verdicts(self) -> dict[str, bool]:
        """Boolean results of the analysis, by name, such as `jams`."""
        return {name: verdict["answer"] for name, verdict in self.get("verdicts", {}).items()}

    @property
    def lacks(self) -> list[str]:
        """Numbers that were not calculated, each with the inputs that are missing for it."""
        lacks: list[str] = self.get("lacks", [])
        return lacks


class SlipReport(SlipFields, MotionReport):
    """Slip at the contacts: speeds, ratios, moments and powers."""

    __slots__ = ()


class JamReport(JamFields, MotionReport):
    """Jamming: contact loads and approaches, forces at wedge and ball return, critical friction, and margins."""

    __slots__ = ()


class Ellipse(NamedTuple):
    """Distributions over a contact ellipse.

    The rows of the arrays run along the groove and the columns across it. Values outside the ellipse are NaN.

    Attributes
    ----------
    contact : str
        Name of the contact, nut or screw.
    contact_angle_deg, normal_load_N, max_pressure_MPa : float
        Contact angle, normal load and maximum pressure.
    semi_axes_mm : list of float
        Semi-axis across the groove and semi-axis along the groove.
    friction_force_N : list of float
        Components of the friction force across and along the groove.
    friction_over_load : float
        Ratio of friction force to normal load.
    spin_rad_s, creep_speed_m_s : float
        Angular velocity of spin, and creep speed of the friction law.
    saturated : bool
        True if all points of the ellipse slide.
    sticking_share : float
        Fraction of the load that is carried by points that stick.
    rolling_lines : list of float
        Positions of the lines of pure rolling, measured across the groove and divided by the semi-axis.
    spin_poles : list of list of float
        Positions of the points without slip, divided by the semi-axes.
    places : array
        Coordinates of the grid points, divided by the semi-axes, from -1 to 1.
    pressure_MPa, slip_across_m_s, slip_along_m_s : array
        Pressure, and slip velocity across and along the groove.
    friction_across, friction_along : array
        Friction stress across and along the groove, divided by the pressure.
    """

    contact: str
    contact_angle_deg: float
    normal_load_N: float
    semi_axes_mm: list[float]
    max_pressure_MPa: float
    friction_force_N: list[float]
    friction_over_load: float
    spin_rad_s: float
    creep_speed_m_s: float
    saturated: bool
    rolling_lines: list[float]
    spin_poles: list[list[float]]
    places: Floats
    pressure_MPa: Floats
    slip_across_m_s: Floats
    slip_along_m_s: Floats
    friction_across: Floats
    friction_along: Floats
    sticking_share: float


class EllipsesReport(MotionReport):
    """Distributions of pressure, slip and friction over the contact ellipses."""

    __slots__ = ()

    @property
    def contacts(self) -> list[Ellipse]:
        """Ellipses of the contacts with nut and screw."""
        return [Ellipse(**contact) for contact in self.get("contacts", [])]


class ModelOptimum(ModelOptimumFields, Section):
    """Contact angle at which the efficiency of a model is highest."""

    __slots__ = ()


class OptimumReport(OptimumFields, Report):
    """Angles of maximum efficiency, and self-locking limits."""

    __slots__ = ()

    @property
    def by_model(self) -> ModelOptimum | None:
        """Contact angle at which the efficiency of the requested model is highest."""
        return ModelOptimum(self["by_model"]) if "by_model" in self else None


class RatingSteps(RatingStepsFields, Section):
    """Intermediate values in the calculation of the load ratings."""

    __slots__ = ()


class RatingsReport(RatingsFields, Report):
    """Load ratings, life, stiffness, mass and permissible speed of a nut."""

    __slots__ = ()

    @property
    def preloaded(self) -> bool:
        """True if the stiffness applies to a preloaded nut."""
        preloaded: bool = self["preloaded"]
        return preloaded

    @property
    def steps(self) -> RatingSteps:
        """Intermediate values of the calculation."""
        return RatingSteps(self["steps"])


class SampleReport(Report):
    """Quantiles of the results for nuts with random ball diameters."""

    __slots__ = ()

    @property
    def carried(self) -> int:
        """Number of random nuts that have an equilibrium."""
        carried: int = self["carried"]
        return carried

    @property
    def failed(self) -> int:
        """Number of random nuts that have no equilibrium."""
        failed: int = self["failed"]
        return failed

    @property
    def quantiles(self) -> dict[str, dict[str, float]]:
        """Quantiles of each result, by name."""
        quantiles: dict[str, dict[str, float]] = self["quantiles"]
        return quantiles


class NutReport(NutFields, Report):
    """Results for a nut, with tables of its balls and of its load-deflection curve.

    Attributes
    ----------
    balls : Table
        Table with one row per ball.
    curve : Table
        Table with one row per point of the load-deflection curve.
    """

    __slots__ = ("balls", "curve")

    def __init__(
        self, entries: Mapping[str, Any], found: bool, warnings: Sequence[str], balls: Table, curve: Table
    ) -> None:
        super().__init__(entries, found, warnings)
        self.balls = balls
        self.curve = curve

    @property
    def status(self) -> str:
        """`converged`, or the reason why the nut has no equilibrium."""
        status: str = self["status"]
        return status

    @property
    def message(self) -> str | None:
        """Reason why the nut has no equilibrium."""
        message: str | None = self["message"]
        return message

    @property
    def model(self) -> str | None:
        """Model that calculated the contact friction."""
        model: str | None = self.get("model")
        return model

    @property
    def not_given(self) -> list[NotGiven]:
        """Missing inputs that the calculation treated as zero, or whose effects it omitted."""
        return _not_given(self)


class Rule(NamedTuple):
    """A rule for an axis and the result of its check.

    Attributes
    ----------
    rule : str
        Title of the rule.
    name, symbol, unit : str
        Name, symbol and unit of the number that the rule limits.
    value : float or None
        Value of the number.
    must_be : str
        Comparison between value and limit, `>=` or `<=`.
    limit : float or None
        Limit, or None if nothing is required.
    margin : float or None
        Safety margin. The axis satisfies the rule if the margin is at least 1.
    passes : bool or None
        True if the axis satisfies the rule or nothing is required, and False if it violates the rule. None if the rule
        is undecided because the groove is estimated and the 90 % interval of the number contains the limit.
    source : str
        Source of the rule.
    remedy : str or None
        Smallest change of one input with which the axis would satisfy a violated rule.
    """

    rule: str
    name: str
    symbol: str
    unit: str
    value: float | None
    must_be: str
    limit: float | None
    margin: float | None
    passes: bool | None
    source: str
    remedy: str | None


class AxisScrew(ScrewFields, Section):
    """Data of the screw from which the results for an axis were calculated."""

    __slots__ = ()


class Phase(PhaseFields, Section):
    """A phase in the load cycle of an axis."""

    __slots__ = ()


class AxisReport(AxisFields, Report):
    """Results for an axis, with its rules and the phases of its load cycle. `found` is true if no rule fails."""

    __slots__ = ()

    def _value(self, name: str) -> Any:
        return self["results"][name]

    @property
    def passes(self) -> bool | None:
        """True if every rule passes, False if a rule fails, and None if a rule is undecided because the groove is estimated."""
        passes: bool | None = self["passes"]
        return passes

    @property
    def rules(self) -> list[Rule]:
        """Rules with their limits and margins."""
        return [Rule(**row) for row in self["rules"]]

    @property
    def phases(self) -> list[Phase]:
        """Phases of the load cycle."""
        return [Phase(phase) for phase in self["phases"]]

    @property
    def screw(self) -> AxisScrew:
        """Data of the screw from which the results for the axis were calculated."""
        return AxisScrew(self["screw"])

    @property
    def case(self) -> Case:
        """The case from which the results for the axis were calculated."""
        return Case(self["inputs"])

    @property
    def not_given(self) -> list[NotGiven]:
        """Missing inputs that the calculation treated as zero, or whose effects it omitted."""
        return _not_given(self)

    @property
    def not_modeled(self) -> list[str]:
        """Effects that the calculation does not include."""
        not_modeled: list[str] = self["not_modeled"]
        return not_modeled


class Step(NamedTuple):
    """A step in the selection of a screw.

    Attributes
    ----------
    step : int
        Number of the step in the procedure.
    name : str
        Name of the number that the step calculates.
    value : float or None
        Value of the number.
    required : str or None
        Requirement as text.
    passes : bool
        True if the value meets the requirement.
    """

    step: int
    name: str
    value: float | None
    required: str | None
    passes: bool


class SelectReport(Report):
    """Result of the selection of a screw.

    If no screw meets the requirement, `found` is false, and `reasons` lists the violated limits.
    """

    __slots__ = ()

    @property
    def case(self) -> Case:
        """Selected screw as a case for the other functions."""
        return Case(self["case"])

    @property
    def steps(self) -> list[Step]:
        """Steps of the selection."""
        return [Step(**row) for row in self["steps"]]

    @property
    def reasons(self) -> list[str]:
        """Limits that determine the size of the screw, or limits that no screw satisfies."""
        reasons: list[str] = self["reasons"]
        return reasons


class FitReport(Report):
    """Values of an input at which an output has its measured value or a rule reaches its limit."""

    __slots__ = ()

    @property
    def fitted(self) -> list[float]:
        """Values of the input in ascending order."""
        return [value for row in self["found"] for name, value in row.items() if name in INPUTS]

    @property
    def kept(self) -> list[tuple[float, float]]:
        """Ranges of the input in which the axis satisfies the rule."""
        return [(low, high) for low, high in self.get("kept", [])]

    @property
    def reachable(self) -> tuple[float, float] | None:
        """Smallest and largest value of the output, or of the margin of the rule, in the search range."""
        low_and_high: list[float] | None = self["reachable"]
        return None if low_and_high is None else (low_and_high[0], low_and_high[1])

    @property
    def message(self) -> str:
        """Text that describes the result."""
        message: str = self["message"]
        return message


class FittedValue(NamedTuple):
    """Fitted value of an input. It has a standard deviation if the points determine the input."""

    value: float
    standard_deviation: float | None


class FittedPoint(NamedTuple):
    """Measured and fitted values of the output at one point."""

    measured: float
    fitted: float


class CalibrationReport(Report):
    """Inputs that were fitted to measured points."""

    __slots__ = ()

    @property
    def message(self) -> str | None:
        """Reason why the measured points do not determine the inputs."""
        message: str | None = self.get("message")
        return message

    @property
    def fitted(self) -> dict[str, FittedValue]:
        """Fitted values of the inputs, by name."""
        return {name: FittedValue(**row) for name, row in self.get("found", {}).items()}

    @property
    def points(self) -> list[FittedPoint]:
        """Measured and fitted values of the output at each point."""
        return [FittedPoint(**row) for row in self.get("points", [])]

    @property
    def root_mean_square(self) -> float | None:
        """Root mean square of the residuals, in the unit of the output."""
        root_mean_square: float | None = self.get("root_mean_square")
        return root_mean_square

    @property
    def condition(self) -> float | None:
        """Condition number. If it exceeds a few thousand, the points do not determine the inputs."""
        condition: float | None = self.get("condition")
        return condition


class Solver(TypedDict, total=False):
    """Solver settings, which are keywords of every function that solves points. `solve` describes each setting."""

    model: Model
    tolerance: float
    accuracy: float
    creep: float
    control: Control | None
    friction: Friction


_SOLVER: Mapping[str, Any] = {
    "model": "auto", "tolerance": 1e-2, "accuracy": 1e-8, "creep": 1e-4, "control": None, "friction": "local",
}
"""Defaults of the solver settings, in the order in which the compiled module expects them."""


class Question(Inputs, Solver, total=False):
    """Inputs that replace inputs of a case, and solver settings."""


class Linspace(NamedTuple):
    """Equally spaced values that include both ends."""

    start: float
    stop: float
    number: int


def linspace(start: float, stop: float, count: int) -> Linspace:
    """Return equally spaced values for `sweep`, including both ends."""
    return Linspace(float(start), float(stop), int(count))


class Uniform(NamedTuple):
    """Uniform distribution from `low` to `high`."""

    low: float
    high: float


class Normal(NamedTuple):
    """Normal distribution with a mean and a standard deviation."""

    mean: float
    deviation: float


def uniform(low: float, high: float) -> Uniform:
    """Return a uniform distribution from `low` to `high`, for `draw` and `plan`."""
    return Uniform(low, high)


def normal(mean: float, deviation: float) -> Normal:
    """Return a normal distribution with the given mean and standard deviation, for `draw` and `plan`."""
    return Normal(mean, deviation)


def _laws(draw: Mapping[str, Uniform | Normal]) -> list[tuple[str, Uniform | Normal]]:
    """Return the random inputs with their distributions."""
    for name, law in draw.items():
        if not isinstance(law, (Uniform, Normal)):
            raise InputError(f"`{name}` is {law!r}; give uniform(low, high) or normal(mean, deviation)", key=name)
    return list(draw.items())


def draw(laws: Mapping[str, Uniform | Normal], /, samples: int, seed: int = 0) -> dict[str, Floats]:
    """Draw random points for `solve_many`. The points are identical to those of `bsm sweep --draw` on every machine.

    Parameters
    ----------
    laws : mapping
        Distribution of each drawn input: `uniform(low, high)` or `normal(mean, deviation)`.
    samples : int
        Number of points.
    seed : int
        Seed of the random number generator.

    Returns
    -------
    dict
        Array of values for each input.

    Raises
    ------
    InputError
        If an input is unknown, a distribution is invalid, or `samples` or `seed` is negative.

    Examples
    --------
    >>> import ballscrew as bs
    >>> points = bs.draw({"friction_coefficient": bs.uniform(0.02, 0.1)}, samples=1000, seed=1)
    >>> table = bs.solve_many(points, bs.Case(lead_angle_deg=5, contact_angle_deg=45), model="closed-form")
    >>> len(table), bool(table["efficiency"].min() > 0.8)
    (1000, True)
    """
    import numpy as np

    for name, value in {"samples": samples, "seed": seed}.items():
        if not 0 <= value < 1 << 64:
            raise InputError(f"{name} is {value}, but must be a whole number from 0 to 2**64 - 1", key=name)
    return {name: np.frombuffer(values, np.float64) for name, values in _core.draws(seed, samples, _laws(laws))}


def _axes(vary: Mapping[str, Linspace | Iterable[float]]) -> list[tuple[str, Linspace | list[float]]]:
    """Return the varied inputs with their values."""
    axes: list[tuple[str, Linspace | list[float]]] = []
    for name, values in vary.items():
        if isinstance(values, (Uniform, Normal)):
            raise InputError(f"`{name}` is random; to solve random points, use solve_many(draw(...))", key=name)
        if not isinstance(values, Iterable) or isinstance(values, str):
            raise InputError(f"`{name}` is {values!r}; give a list of values, such as [{values!r}]", key=name)
        if isinstance(values, Linspace):
            axes.append((name, values))
        elif isinstance(values, tuple) and len(values) == 3 and isinstance(values[2], int):
            text = f"linspace({', '.join(map(repr, values))})"
            raise InputError(f"`{name}` is {values!r}; give {text} for a range, {[*values]!r} for three values", key=name)
        else:
            axes.append((name, [_number(name, value) for value in values]))
    return axes


def _taken(keywords: dict[str, Any]) -> _core.How:
    """Remove the solver settings from a dict of keywords, and return these settings."""
    take = keywords.pop
    return cast("_core.How", tuple([take(name, default) for name, default in _SOLVER.items()]))


def _checked(how: _core.How) -> _core.How:
    """Check the types of the solver settings."""
    for (name, default), value in zip(_SOLVER.items(), how, strict=True):
        number = isinstance(default, float)
        if isinstance(value, bool) or not isinstance(value, (int, float) if number else (str, type(default))):
            raise InputError(f"{name} is {value!r}, but must be a {'number' if number else 'text'}", key=name)
    return how


def _how(solver: Solver) -> _core.How:
    """Return the solver settings.

    Raises
    ------
    TypeError
        If a keyword is not a solver setting.
    """
    keywords: dict[str, Any] = {**solver}
    how = _taken(keywords)
    for name in keywords:
        raise TypeError(f"there is no keyword `{name}`{_near(name, _SOLVER)}")
    return _checked(how)


def _list(word: str, names: Sequence[str]) -> list[str]:
    """Return a list of names. Reject a single string, which Python would treat as a list of letters."""
    if isinstance(names, str):
        raise InputError(f"{word} takes a list of names, such as [{names!r}]", key=word)
    return list(names)


def _columns(names: Sequence[str] | None) -> list[str] | None:
    return None if names is None else _list("columns", names)


def _case(case: Point, inputs: Inputs) -> Case:
    if isinstance(case, Case) and not inputs:
        return case
    return Case(case, **inputs)


def _asked(case: Point, question: Question) -> tuple[Case, _core.How]:
    """Separate keywords into inputs and solver settings. Return the case with these inputs, and the settings."""
    given: dict[str, Any] = {**question}
    how = _checked(_taken(given))
    for name in given:
        if name not in INPUTS and (near := _near(name, _SOLVER)):
            raise InputError(f"unknown key `{name}`{near}", key=name)
    return _case(case, cast("Inputs", given)), how


def solve(case: Point = None, /, *, check: bool = True, **question: Unpack[Question]) -> Solution:
    """Solve one point.

    Parameters
    ----------
    case : Case or mapping, optional
        Screw and operating point.
    check : bool
        Whether to raise an exception if there is no result. Missing inputs and inputs that violate a rule always raise
        an exception.
    **question
        Inputs that replace inputs of `case`, each in the unit at the end of its name, and solver settings:

        model : str, default "auto"
            One of `MODELS`. `auto` chooses the fastest model that is accurate enough.
        tolerance : float, default 1e-2
            Largest efficiency error that `auto` accepts.
        accuracy : float, default 1e-8
            Quadrature error relative to the friction in model `traction`, from 1e-13 to 1e-4.
        creep : float, default 1e-4
            Creep speed in model `traction`, divided by the surface speed of the ball.
        control : {"nut", "screw"}, optional
            Controlling raceway in model `raceway-control`. By default, the spin moments determine the controlling
            raceway.
        friction : {"local", "contact"}, default "local"
            How model `raceway-control` calculates the friction of a lubricant: at every point of a contact ("local"),
            or once for each contact ("contact"), which takes half the time.

    Returns
    -------
    Solution

    Raises
    ------
    InputError
        If inputs are missing or violate a rule.
    NoSolutionError, NotConvergedError
        If there is no result and `check` is true.

    Examples
    --------
    >>> import ballscrew as bs
    >>> bs.solve(model="closed-form", contact_angle_deg=45, lead_angle_deg=8, friction_coefficient=0.01).status
    'converged'
    """
    answer = Solution(*_asked(case, question))
    if check and not answer.converged:
        kind = {"no_solution": NoSolutionError, "not_converged": NotConvergedError}
        words = f"{answer.model}: {answer.status}, {answer.message}"
        raise kind.get(answer.status, SolveError)(words, answer)
    return answer


def sensitivities(case: Point = None, /, **question: Unpack[Question]) -> Table:
    """Calculate exact derivatives of efficiency and torque with respect to every input of the model.

    Parameters
    ----------
    case, **question
        As in `solve`.

    Returns
    -------
    Table
        Table with one row per input, ordered by its effect. `input` and `value` are the name and the value of the input.
        `efficiency` and `ball_torque_Nm` are derivatives per unit of the input; `efficiency_relative` and
        `ball_torque_relative` are changes in percent per percent of the input.

    Raises
    ------
    InputError, SolveError
        As in `solve`.

    Examples
    --------
    >>> import ballscrew as bs
    >>> table = bs.sensitivities(model="closed-form", contact_angle_deg=45, lead_angle_deg=8, friction_coefficient=0.01)
    >>> table["input"][0]
    'friction_coefficient'
    """
    rows = _core.sensitivities(*_asked(case, question))
    if rows is None:
        raise NotConvergedError("the sensitivities cannot be calculated at this point", solve(case, **question))
    names = ["input", "value", "efficiency", "ball_torque_Nm", "efficiency_relative", "ball_torque_relative"]
    return _listed(names, rows)


def compare(case: Point = None, /, **inputs: Unpack[Inputs]) -> Table:
    """Solve a case with every model whose inputs it contains, like `bsm solve --model all`.

    Parameters
    ----------
    case, **inputs
        As in `solve`.

    Returns
    -------
    Table
        Table with one row per model: `model`, `status`, all outputs of a solution, and two deviations from the model
        `traction` or, if `traction` has no solution, from the solved model with the most inputs: `efficiency_deviation`
        (difference of the efficiencies) and `loss_deviation` (relative difference of the losses).

    Raises
    ------
    InputError
        If the inputs of the case are not sufficient for any model.

    Examples
    --------
    >>> import ballscrew as bs
    >>> bs.compare(contact_angle_deg=45, lead_angle_deg=8, friction_coefficient=0.01)["model"].tolist()
    ['closed-form']
    """
    answer, _, _ = _core.compare(_case(case, inputs))
    rows = answer["models"]
    outputs = (quantity.name for quantity in _OF_A_SOLUTION)
    names = ["model", "status", *outputs, "efficiency_deviation", "loss_deviation"]
    return _listed(names, [[row[name] for name in names] for row in rows])


def solve_many(
    points: Any,
    /,
    base: Point = None,
    *,
    columns: Sequence[Output] | None = None,
    keep: Sequence[str] = (),
    missing: Literal["invalid", "base"] = "invalid",
    progress: bool | Progress | None = None,
    threads: int | None = None,
    text: bool = False,
    **solver: Unpack[Solver],
) -> Table:
    """Solve many points on all cores. The result has one row per point, in the same order.

    Parameters
    ----------
    points : mapping or frame
        Columns of inputs. Either a mapping of names to one-dimensional arrays or numbers, or any object that exports an
        Arrow stream (polars, pyarrow, pandas 3, DuckDB, or a `Table`). A number applies to all rows. Arrays of doubles
        are not copied, so do not change them while the table is in use.
    base : Case or mapping, optional
        Inputs that are not columns.
    columns : sequence of str, optional
        Names of outputs (see `OUTPUTS`). Defaults to all outputs of a solution.
    keep : sequence of str
        Other columns to copy to the result, of any type except lists and structures. The columns of a frame keep their
        types.
    missing : {"invalid", "base"}
        Meaning of null: "invalid" rejects the row, and "base" uses the value of `base`. NaN is always invalid.
    progress : bool or callable, optional
        True shows the progress if standard error is a terminal. A function is called with the number of finished rows
        and the total number of rows.
    threads : int, optional
        Number of threads. Defaults to the environment variable RAYON_NUM_THREADS or, if it is not set, to the number of
        cores.
    text : bool
        If true, also store the reasons for the choice of `auto`, which need about 100 bytes per row. `message(row)` and
        the column ``message`` of `write` contain these reasons. The reason why a row has no result is always stored.
    **solver
        Solver settings as in `solve`: model, tolerance, accuracy, creep, control, friction.

    Returns
    -------
    Table
        Table with the inputs, `model`, `status`, ``message`` and the outputs. The outputs of a row without a result are
        NaN, and its message states the reason.

    Raises
    ------
    InputError
        If a column or output is unknown, or if inputs are missing in all rows.

    Examples
    --------
    >>> import ballscrew as bs
    >>> points = {"friction_coefficient": [0.01, 0.02], "contact_angle_deg": 45, "lead_angle_deg": 8}
    >>> bs.solve_many(points, model="closed-form", columns=["efficiency"])["efficiency"].round(3)
    array([0.98 , 0.961])
    """
    import numpy as np

    if missing not in ("invalid", "base"):
        raise InputError(f"missing is {missing!r}, but must be 'invalid' or 'base'", key="missing")
    case, keep = _case(base, {}), _list("keep", keep)
    if isinstance(points, Table):
        # Output columns of an earlier run are ignored.
        points = {n: column if isinstance(column, _core.KeptColumn) else points[n]
                  for n, column in points._columns.items() if n in INPUTS or n in keep}
    numbers: list[tuple[str, Floats, list[int]]] = []
    kept: list[tuple[str, _core.KeptColumn]] = []
    fixed: dict[str, Any] = {}
    try:
        if isinstance(points, Mapping):
            for name, values in points.items():
                if name in keep:
                    kept.append((name, _kept(values)))
                    continue
                array = _column(name, values)
                if array.ndim == 0:
                    fixed[name] = float(array)
                else:
                    numbers.append((name, array, []))
        elif hasattr(points, "__arrow_c_stream__"):
            for name, read in _read_frame(points, keep):
                if isinstance(read, tuple):
                    buffer, gaps = read
                    numbers.append((name, np.frombuffer(buffer, np.float64), gaps if missing == "base" else []))
                else:
                    kept.append((name, read))
        else:
            raise _no_points(points)
    except InputError as error:
        error.add_note("to copy a column that is not an input, such as a column of names, use keep=")
        raise
    if fixed:
        case = case.replace(**fixed)
    lengths: dict[str, int] = {column[0]: len(column[1]) for column in numbers}
    lengths |= {column[0]: len(column[1]) for column in kept}
    length = max(lengths.values(), default=1 if fixed else 0)
    for column_name, rows_of_it in lengths.items():
        if rows_of_it != length:
            message = f"column `{column_name}` has {rows_of_it} rows, but another column has {length}"
            raise InputError(message, key=column_name)
    rows = _core.solve_many(
        case, numbers, kept, length, _how(solver), _columns(columns), threads, _shown(progress), text
    )
    taken = set(rows.inputs())
    inputs: dict[str, Any] = {name: values for name, values, _ in numbers if name in taken}
    return _answered(rows, {**inputs, **dict(kept)})


def _kept(values: Any) -> _core.KeptColumn:
    """Convert a copied column for the compiled module. Numbers and times keep their types; other values become text.
    """
    import numpy as np

    if isinstance(values, _core.KeptColumn):
        return values
    array = np.asarray(values)
    kinds = {"i": "int64", "u": "uint64", "f": "float64", "b": "bool", "M": "datetime64[us]"}
    kind = kinds.get(array.dtype.kind)
    if kind is None or array.ndim != 1:
        return _core.KeptColumn.of_texts([None if value is None else str(value) for value in values])
    array = np.ascontiguousarray(array.astype(kind))
    return _core.KeptColumn.of_numbers(array.view({"bool": np.uint8, "datetime64[us]": np.int64}.get(kind, kind)), kind)


def _kept_values(column: _core.KeptColumn) -> NDArray[Any]:
    """Return the values of a copied column as a NumPy array."""
    import numpy as np

    values = column.values()
    if isinstance(values, tuple):
        buffer, kind = values
        array = np.frombuffer(buffer, {"bool": "uint8"}.get(kind, kind)).astype(kind, copy=False)
    else:
        array = np.array(values, dtype=object)
    array.flags.writeable = False
    return array


def _read_frame(frame: Any, keep: list[str]) -> list[tuple[str, Any]]:
    """Read each column of a data frame as texts, or as numbers with the indices of the rows without a value."""
    try:
        return _core.read_arrow(frame, keep)
    except ImportError:
        import numpy as np

        # Without pyarrow, a missing value in pandas is a NaN.
        read: list[tuple[str, Any]] = []
        for name in frame.columns:
            if name in keep:
                read.append((name, _kept(frame[name])))
            else:
                column = _column(name, frame[name])
                read.append((name, (column, np.flatnonzero(np.isnan(column)).tolist())))
        return read


def sweep(
    base: Case | Mapping[str, Any],
    /,
    *,
    vary: Mapping[str, Linspace | Iterable[float]],
    columns: Sequence[Output] | None = None,
    progress: bool | Progress | None = None,
    threads: int | None = None,
    text: bool = False,
    **solver: Unpack[Solver],
) -> Grid:
    """Solve a full grid over one or more inputs. `auto` chooses a model for each point.

    Parameters
    ----------
    base : Case or mapping
        Inputs that are not varied.
    vary : mapping
        Values of each varied input: `linspace(start, stop, count)` or any numbers. The last input varies fastest.
    columns, progress, threads, text, **solver
        As in `solve_many`.

    Returns
    -------
    Grid

    Raises
    ------
    InputError
        If an input is invalid, or if a value of an axis violates a rule.

    Examples
    --------
    >>> import ballscrew as bs
    >>> screw = bs.Case(lead_angle_deg=5, contact_angle_deg=45)
    >>> grid = bs.sweep(screw, vary={"friction_coefficient": bs.linspace(0.02, 0.1, 5)}, columns=["efficiency"])
    >>> grid.shape, grid.grid("efficiency").round(2)
    ((5,), array([0.96, 0.92, 0.89, 0.85, 0.82]))
    """
    import numpy as np

    case = _case(base, {})
    how = _how(solver)
    rows, found = _core.sweep(case, _axes(vary), how, _columns(columns), threads, _shown(progress), text)
    table = _answered(rows, {})
    varied = {name: np.array(axis) for name, axis in found}
    units = {**table.units, **{name: INPUTS[name].unit for name in varied}}
    return Grid(table._columns, units, len(table), rows, varied, case, dict(zip(_SOLVER, how, strict=True)))


def gradient(
    points: Any,
    /,
    output: Output,
    wrt: Sequence[str],
    base: Point = None,
    *,
    method: Literal["exact", "difference"] = "exact",
    step: float = 1e-4,
    threads: int | None = None,
    **solver: Unpack[Solver],
) -> tuple[Any, Any]:
    """Calculate an output and its derivatives, for example for `scipy.optimize.minimize(..., jac=True)`.

    Parameters
    ----------
    points : mapping or frame
        Inputs. For a single point, a mapping of names to numbers; for many points, a mapping of names to arrays, or a
        frame.
    output : str
        `efficiency` or `ball_torque_Nm` with method "exact", or any numeric output with method "difference".
    wrt : sequence of str
        Inputs with respect to which the output is differentiated.
    base : Case or mapping, optional
        Inputs that are not in `points`.
    method : {"exact", "difference"}
        Exact derivatives of the model, or central differences.
    step : float
        Relative step of the differences.
    threads, **solver
        As in `solve_many`.

    Returns
    -------
    values, derivatives : arrays
        Arrays of shape (n,) and (n, k) for n points and k inputs, or of shape () and (k,) for a single point. For many
        points, the values of a point without a solution are NaN; `solve_many` states the reason.

    Raises
    ------
    InputError
        If an input is invalid, or if an input in `wrt` also determines another input that exact derivatives hold
        constant.
    SolveError
        If a single point has no solution, as in `solve`.

    Examples
    --------
    >>> import ballscrew as bs
    >>> point = {"contact_angle_deg": 45, "lead_angle_deg": 8, "friction_coefficient": 0.01}
    >>> value, slope = bs.gradient(point, "efficiency", ["friction_coefficient"], model="closed-form")
    >>> round(float(value), 3), slope.round(2)
    (0.98, array([-1.96]))
    """
    import numpy as np

    wrt = _list("wrt", wrt)
    if isinstance(points, Mapping):
        columns = {name: _column(name, values) for name, values in points.items()}
    elif hasattr(points, "__arrow_c_stream__") and not isinstance(points, Table):
        frame = _read_frame(points, [])
        columns = {name: np.frombuffer(read[0], np.float64) for name, read in frame if isinstance(read, tuple)}
    else:
        raise _no_points(points)
    one = all(values.ndim == 0 for values in columns.values())
    length = max((len(v) for v in columns.values() if v.ndim), default=1)
    columns = {name: np.broadcast_to(values, (length,)) for name, values in columns.items()}
    case = _case(base, {})
    if method == "exact":
        if output not in ("efficiency", "ball_torque_Nm"):
            hint = "; use method='difference'" if output in OUTPUTS else _near(output, OUTPUTS)
            raise InputError(f"exact derivatives are available only for efficiency and ball_torque_Nm{hint}", key=output)
        whole = [(name, np.ascontiguousarray(column)) for name, column in columns.items()]
        found = _core.gradient(case, whole, length, wrt, output != "efficiency", _how(solver), threads)
        values = np.frombuffer(found[0], np.float64)
        slopes = np.frombuffer(found[1], np.float64).reshape(length, len(wrt))
    elif method == "difference":
        def at(changed: Mapping[str, Floats]) -> Floats:
            answers = solve_many({**columns, **changed}, case, columns=[output], threads=threads, **solver)
            return answers[output]

        values = at({})
        slopes = np.full((length, len(wrt)), np.nan)
        for place, name in enumerate(wrt):
            middle = columns.get(name)
            if middle is None:
                given = case.to_dict().get(name, INPUTS[name].default if name in INPUTS else None)
                if given is None:
                    raise InputError(f"`{name}` is neither in points nor in base", key=name)
                middle = np.full(length, float(given))
            width = np.where(middle == 0.0, step, np.abs(middle) * step)
            ends = at({name: middle + width}) - at({name: middle - width})
            slopes[:, place] = ends / (2.0 * width)
    else:
        raise InputError(f"method is {method!r}, but must be 'exact' or 'difference'", key="method")
    if not one:
        return values, slopes
    if np.isnan([values[0], *slopes[0]]).any():
        point = case.replace(**cast("Inputs", {name: column[0] for name, column in columns.items()}))
        words = f"{output} and its derivatives cannot be calculated at this point"
        raise NotConvergedError(words, solve(point, **solver))
    return values[0], slopes[0]


def slip(case: Point = None, /, **question: Unpack[Question]) -> SlipReport:
    """Calculate the slip of the balls, like `bsm solve --show slip`.

    Parameters
    ----------
    case, **question
        As in `solve`. The model must calculate the motion of the balls.

    Returns
    -------
    SlipReport
        Speeds, ratios, moments and powers of the slip at the contacts. The name of each number ends with its unit
        (see `OUTPUTS`). If there is no steady motion, `found` is false, and `status` and ``message`` state the reason.

    Raises
    ------
    InputError
        If inputs are missing or violate a rule.

    Examples
    --------
    >>> import ballscrew as bs
    >>> screw = bs.Case(ball_diameter_mm=6.35, pitch_circle_diameter_mm=41.5, lead_mm=20, contact_angle_deg=45,
    ...                  nut_conformity=0.53, screw_conformity=0.53, friction_coefficient=0.06)
    >>> report = bs.slip(screw, screw_speed_rpm=1500, axial_load_N=8000, loaded_balls=70)
    >>> report.found, report.nut_slide_roll_ratio < 0.05
    (True, True)
    """
    return SlipReport(*_core.slip(*_asked(case, question)))


def ellipses(case: Point = None, /, *, points: int = 20, **question: Unpack[Question]) -> EllipsesReport:
    """Calculate pressure, slip and friction over the contact ellipses, like `bsm solve --show ellipses`.

    Parameters
    ----------
    case, **question
        As in `solve`. The model must calculate the motion of the balls with elastic contacts.
    points : int
        Number of grid points on each semi-axis, 1 to 500.

    Returns
    -------
    EllipsesReport
        `contacts` contains an `Ellipse` with arrays for each contact. If there is no steady motion, `found` is false, as
        in `slip`.

    Raises
    ------
    InputError
        If inputs are missing or violate a rule.

    Examples
    --------
    >>> import ballscrew as bs
    >>> nut, screw = bs.ellipses(bs.Case.read("examples/feed_drive_oil.json")).contacts
    >>> nut.pressure_MPa.shape, bool(nut.pressure_MPa[20, 20] == nut.max_pressure_MPa)
    ((41, 41), True)
    """
    import numpy as np

    if not 1 <= points <= 500:
        raise InputError(f"points is {points}, but must be from 1 to 500", key="points")
    report = EllipsesReport(*_core.ellipses(*_asked(case, question), points))
    for contact in report["contacts"] if report.found else []:
        side = len(contact["places"])
        for name, value in contact.items():
            if isinstance(value, list) and len(value) == side * side:
                contact[name] = np.array(value, dtype=float).reshape(side, side)
        contact["places"] = np.array(contact["places"])
    return report


def jam(case: Point = None, /, **question: Unpack[Question]) -> JamReport:
    """Analyze jamming of the balls in the nut and at its ball return, like `bsm solve --show jam`.

    Parameters
    ----------
    case, **question
        As in `solve`. `apex_half_angle_deg`, `return_angle_deg` and the other inputs for jamming (see `INPUTS`)
        describe the ball return.

    Returns
    -------
    JamReport
        Contact loads and approaches, forces at wedge and ball return, critical friction, margins, and `jams`. If there
        is no steady motion, `found` is false, as in `slip`.

    Raises
    ------
    InputError
        If inputs are missing or violate a rule.

    Examples
    --------
    >>> import ballscrew as bs
    >>> bs.jam(bs.Case.read("examples/jamming.json")).found
    True
    """
    return JamReport(*_core.jam(*_asked(case, question)))


def ratings(nut: Point = None, /, **inputs: Unpack[Inputs]) -> RatingsReport:
    """Calculate load ratings, life and stiffness of a nut, like `bsm solve --show ratings`.

    Parameters
    ----------
    nut : Case or mapping, optional
        Inputs that describe the nut.
    **inputs
        Inputs that replace inputs of `nut`. Ball diameter, conformities, `loaded_balls_per_turn` and `loaded_turns` are
        required.

    Returns
    -------
    RatingsReport
        Dynamic and static load rating [N], stiffnesses [N/um], mass [kg] and permissible speed [rpm]. If a load and a
        speed are given, the report also contains the life in revolutions and hours. To calculate the life under a
        cycle, use `axis`.

    Raises
    ------
    InputError
        If inputs are missing or violate a rule.

    Examples
    --------
    >>> import ballscrew as bs
    >>> nut = bs.Case.read("examples/nut.json")
    >>> bs.ratings(nut, axial_load_N=8000, screw_speed_rpm=500).dynamic_load_rating_N > 50_000
    True
    """
    return RatingsReport(*_core.ratings(_case(nut, inputs)))


@overload
def nut(case: Point = None, /, *, samples: None = None, **question: Unpack[Question]) -> NutReport: ...


@overload
def nut(case: Point = None, /, *, samples: int, **question: Unpack[Question]) -> SampleReport: ...


def nut(case: Point = None, /, *, samples: int | None = None, **question: Unpack[Question]) -> NutReport | SampleReport:
    """Calculate the load of every ball of a nut, and its stiffness, preload and life, like `bsm nut`.

    Parameters
    ----------
    case, **question
        As in `solve`. Turns, circuits, preload and loads describe the nut.
    samples : int, optional
        Number of nuts with random ball diameters and random phases of the lead error. The report then contains
        quantiles of their results. The input `seed` is the seed of the random numbers.

    Returns
    -------
    NutReport or SampleReport
        Numbers by name, and the tables `balls` and `curve`. With `samples`, quantiles of the results. If the nut has no
        equilibrium, `found` is false, and `status` and ``message`` state the reason.

    Raises
    ------
    InputError
        If inputs are missing or violate a rule.

    Examples
    --------
    >>> import ballscrew as bs
    >>> nut = bs.nut(bs.Case.read("examples/nut.json"), axial_load_N=8000)
    >>> nut.found, len(nut.balls)
    (True, 96)
    """
    asked = _asked(case, question)
    if samples is not None:
        return SampleReport(*_core.nut_samples(*asked, samples))
    (entries, found, warnings), balls, curve = _core.nut(*asked)
    tables = []
    for columns, rows in zip(_core.nut_columns(), (balls, curve), strict=True):
        names = [name for name, _ in columns]
        tables.append(_listed(names, rows, dict(columns)))
    return NutReport(entries, found, warnings, *tables)


def optimum(case: Point = None, /, *, model: Model | None = None, **inputs: Unpack[Inputs]) -> OptimumReport:
    """Calculate the angles of maximum efficiency and the self-locking limits, like `bsm solve --show optimum`.

    Parameters
    ----------
    case, **inputs
        Screw with a friction coefficient and one of the two angles, contact angle or lead angle. The other angle is
        optimized.
    model : str, optional
        Model for which the optimum contact angle is also searched: `rigid`, `elastic` or `traction`. By default, only
        the optimum of the closed form is calculated.

    Returns
    -------
    OptimumReport
        Angles [deg] and efficiencies for driving and back-driving.

    Raises
    ------
    InputError
        If inputs are missing or violate a rule.

    Examples
    --------
    >>> import ballscrew as bs
    >>> bs.optimum(contact_angle_deg=45, lead_angle_deg=8, friction_coefficient=0.06).found
    True
    """
    return OptimumReport(*_core.optimum(_case(case, inputs), model))


def axis(
    case: Point = None,
    /,
    *,
    figures: str | os.PathLike[str] | None = None,
    **question: Unpack[Question],
) -> AxisReport:
    """Analyze a feed axis, like `bsm axis`: rules with limits and margins, torque, power, heat and life.

    Parameters
    ----------
    case, **question
        As in `solve`. `stroke_mm`, `moved_mass_kg`, `support`, `cycle` and other inputs (see `INPUTS`) describe the
        axis.
    figures : path, optional
        Folder for report.html (a calculation sheet of two pages), results.json and figures. The folder is created if it
        does not exist.

    Returns
    -------
    AxisReport
        `found` is true if no rule fails.

    Raises
    ------
    InputError
        If inputs are missing or violate a rule.

    Examples
    --------
    >>> import ballscrew as bs
    >>> bs.axis(bs.Case.read("examples/axis.json")).found
    True
    """
    answer, files = _core.axis(*_asked(case, question), figures is not None)
    _write_report(figures, files)
    return AxisReport(*answer)


def select_nuts(
    lists: Mapping[str, Any] | str | None = None,
    /,
    *,
    where: Sequence[str] = (),
    requirement: Mapping[str, Any] | str | os.PathLike[str] | None = None,
    manufacturers: Any = None,
    columns_from: Mapping[str, str | None] | None = None,
    pareto: bool = False,
    sort: str | None = None,
    descending: bool = False,
    first: int | None = None,
) -> Nuts:
    """List nuts with manufacturers' sizes, with standard sizes or from a table, like `bsm select --from`.

    Parameters
    ----------
    lists : mapping or "manufacturers" or "standard", optional
        Sizes to list. Defaults to the sizes of manufacturers.
    where : sequence of str
        Conditions such as `"dynamic_load_rating_N>=40000"` or `"make=rolled"`. The columns of texts can occur in
        conditions, but the result contains only the columns of numbers.
    requirement : mapping or path, optional
        Requirement as for `select`. The list then contains only nuts that meet all limits of the requirement. Results
        of `axis` become columns for filtering and sorting: life, critical speed, buckling, static safety, stiffness,
        torque, efficiency, heat, mass and inertia.
    manufacturers : mapping, frame or path, optional
        Table of a manufacturer's nuts, which replaces `lists`. A path names a CSV file. The columns are `nut`,
        `lead_mm`, `ball_diameter_mm`, `circuits` or `loaded_turns`, `core_diameter_mm` or `pitch_circle_diameter_mm`,
        `dynamic_load_rating_N`, `static_load_rating_N` and `stiffness_N_um`, in any unit. The program uses the ratings
        in the table, and adds the calculated ratings as columns `our_...`. With `requirement`, each nut is checked with
        the rules of `axis`: `passes` is true if the nut satisfies all rules, and `failed_rules` names the rules that it
        violates (None if there are none). Nuts that pass come first, ordered by the mass of screw and nut.
    columns_from : mapping, optional
        Maps the column names of `manufacturers` to names of this package. None ignores a column.
    pareto : bool
        If true, list only nuts that are Pareto-optimal in dynamic load rating, stiffness and mass.
    sort : str, optional
        Column by which the nuts are sorted.
    descending : bool
        If true, sort in descending order.
    first : int, optional
        Maximum number of rows.

    Returns
    -------
    Nuts
        Table with one row per nut. `case(row)` returns the nut of a row as a case for `ratings`, `nut` and `axis`.

    Raises
    ------
    InputError
        If a list, condition, name or requirement is invalid.

    Examples
    --------
    >>> import ballscrew as bs
    >>> nuts = bs.select_nuts(where=["dynamic_load_rating_N>=40000", "lead_mm=10"], sort="nut_mass_kg", first=3)
    >>> nuts.case(0).lead_mm
    10.0
    """
    import numpy as np

    required = None if requirement is None else _requirement(requirement)
    if manufacturers is not None:
        if lists is not None or where or pareto or sort is not None or descending or first is not None:
            raise InputError("manufacturers lists all nuts of the table, so only requirement and columns_from can be combined with it",
                             key="manufacturers")
        names = dict(columns_from or {})
        try:
            table = _csv(manufacturers, names, gaps=True)
        except InputError as error:
            error.add_note("columns_from maps column names to names of this package, or to None for columns to ignore")
            raise
        rows = _core.manufacturers(table, names, required)
        found, verdicts, grooves = rows["columns"], rows["verdicts"], rows["grooves"]
        kept, warnings = rows["nuts"], rows["warnings"]
        columns: dict[str, Any] = {"nut": np.array(rows["names"], dtype=object)}
        columns |= {name: np.frombuffer(buffer, np.float64) for name, _, buffer in found}
        if required is not None:
            columns["passes"] = np.array([passes is True for passes, _ in verdicts], dtype=bool)
            columns["undecided"] = np.array([passes is None for passes, _ in verdicts], dtype=bool)
            columns["failed_rules"] = np.array(["; ".join(failed) or None for _, failed in verdicts], dtype=object)
        if any(groove is not None for groove in grooves):
            columns["groove"] = np.array(grooves, dtype=object)
        for name in ("nut", "passes", "undecided", "failed_rules", "groove"):
            if name in columns:
                columns[name].flags.writeable = False
    else:
        if columns_from is not None:
            raise InputError("columns_from applies only to the table of a manufacturer", key="columns_from")
        found, kept = _core.select_nuts(_sizes(lists), required, _list("where", where), pareto, sort, descending, first)
        columns = {name: np.frombuffer(buffer, np.float64) for name, _, buffer in found}
        warnings = []
    units = {name: unit for name, unit, _ in found}
    return Nuts(columns, units, len(next(iter(columns.values()))), kept, warnings)


@overload
def fit(
    case: Case | Mapping[str, Any],
    measured: Mapping[str, float] | None = None,
    /,
    *,
    limit: str | None = None,
    points: None = None,
    inputs: str | Sequence[str] | Mapping[str, tuple[float, float] | None] = "friction_coefficient",
    errors: None = None,
    **solver: Unpack[Solver],
) -> FitReport: ...


@overload
def fit(
    case: Case | Mapping[str, Any],
    measured: str,
    /,
    *,
    points: Any,
    inputs: str | Sequence[str] | Mapping[str, tuple[float, float] | None] = "friction_coefficient",
    errors: Literal["relative", "absolute"] | None = None,
    **solver: Unpack[Solver],
) -> CalibrationReport: ...


def fit(
    case: Case | Mapping[str, Any],
    measured: Mapping[str, float] | str | None = None,
    /,
    *,
    limit: str | None = None,
    points: Any = None,
    inputs: str | Sequence[str] | Mapping[str, tuple[float, float] | None] = "friction_coefficient",
    errors: Literal["relative", "absolute"] | None = None,
    **solver: Unpack[Solver],
) -> FitReport | CalibrationReport:
    """Find values of inputs at which an output has its measured value or a rule is at its limit, like `bsm fit`.

    Parameters
    ----------
    case : Case or mapping
        Inputs that are not fitted.
    measured : mapping or str
        One output of `solve`, `nut` or `axis` with its measured value, such as `{"screw_torque_Nm": 26.0}`. With
        `points`, only the name of the output.
    limit : str, optional
        Title of a rule of the axis, such as `"critical speed"`. The function then searches for the limit of this rule
        instead of a measured value.
    points : mapping, frame or path, optional
        Measured points, with one column for the output and columns for inputs, in any units. A path names a CSV file.
        All other inputs come from `case`. The fit minimizes the sum of squared residuals, each divided by its error.
    inputs : str, sequence of str or mapping
        Name of the input to fit, or a mapping of its name to a search range, such as `{"seal_torque_Nm": (0, 1)}`. None
        selects the default range. With `points`, several inputs are permitted.
    errors : {"relative", "absolute"}, optional
        Errors of the measured values in `points`: proportional to the values ("relative", the default), or equal at all
        points ("absolute"). Alternatively, `points` may contain a column of standard deviations, such as
        `screw_torque_Nm_error`.
    **solver
        As in `solve_many`.

    Returns
    -------
    FitReport or CalibrationReport
        For one measured value, `fitted` lists all solutions for the input. For a rule, `kept` lists the ranges of the
        input in which the axis satisfies the rule. With `points`, `fitted` maps each input to its value and standard
        deviation, and `points` contains measured and fitted values. `found` is false if no value of the input
        reproduces the measurement.

    Raises
    ------
    InputError
        If an input is invalid, a table cannot be read, or the search range of an input is unknown.

    Examples
    --------
    >>> import ballscrew as bs
    >>> screw = bs.Case(lead_angle_deg=5, contact_angle_deg=45)
    >>> points = {"contact_angle_deg": [40, 45, 50], "efficiency": [0.86, 0.87, 0.88]}
    >>> report = bs.fit(screw, "efficiency", points=points, model="closed-form")
    >>> round(report.fitted["friction_coefficient"].value, 4)
    0.0689
    """
    how = _how(solver)
    sought = _sought(inputs)
    if points is not None:
        if not isinstance(measured, str):
            raise InputError("with points, measured must be the name of the output, which is a column of points")
        return CalibrationReport(*_core.fit_table(_case(case, {}), how, sought, measured, errors, _csv(points)))
    if errors is not None:
        raise InputError("errors can be given only together with points")
    if len(sought) != 1:
        raise InputError("one measured value or one limit determines only one input; several inputs require points")
    if limit is not None:
        if measured is not None:
            raise InputError("give measured or limit, not both")
        return FitReport(*_core.fit(_case(case, {}), how, sought[0], limit))
    if measured is None or isinstance(measured, str) or len(measured) != 1:
        raise InputError("measured takes one output and its value, such as {'screw_torque_Nm': 26.0}")
    [(name, value)] = measured.items()
    return FitReport(*_core.fit(_case(case, {}), how, sought[0], (name, _number(name, value))))


def _sought(inputs: str | Sequence[str] | Mapping[str, tuple[float, float] | None]) -> list[_core.Sought]:
    """Return the inputs to fit, each with its search range."""
    if isinstance(inputs, str):
        return [(inputs, None)]
    if not isinstance(inputs, Mapping):
        return [(name, None) for name in inputs]
    return [(name, None if limits is None else (_number(name, limits[0]), _number(name, limits[1])))
            for name, limits in inputs.items()]


def _csv(data: Any, names: Mapping[str, str | None] = MappingProxyType({}), gaps: bool = False) -> bytes:
    """Convert a table to CSV.

    * `names`: new names of columns. The column `nut` and ignored columns may contain text.
    * `gaps`: if true, NaN is written as an empty cell.
    """
    if isinstance(data, (str, os.PathLike)):
        return Path(data).read_bytes()
    import csv
    import io

    import numpy as np

    own = {name: names.get(name, name) for name in data} if isinstance(data, (Mapping, Table)) else {}
    texts = ["nut", *(name for name, ours in names.items() if ours in ("nut", None))]
    columns: dict[str, Any] = {}
    if own:
        for name, ours in own.items():
            if ours is not None:
                columns[name] = np.asarray(data[name], dtype=object) if name in texts else _column(name, data[name])
    elif hasattr(data, "__arrow_c_stream__"):
        for name, read in _read_frame(data, texts):
            if names.get(name, name) is not None:
                columns[name] = np.frombuffer(read[0], np.float64) if isinstance(read, tuple) else _kept_values(read)
    else:
        raise InputError(f"data is {type(data).__name__}; give a mapping of names to arrays, a frame, or a path")
    length = max((column.size for column in columns.values()), default=0)
    for name, column in columns.items():
        if column.ndim and len(column) != length:
            raise InputError(f"column `{name}` has {len(column)} rows, but another column has {length}", key=name)
    text = io.StringIO()
    lines = csv.writer(text, lineterminator="\n")
    lines.writerow(columns)
    for row in zip(*(np.broadcast_to(column, (length,)).tolist() for column in columns.values()), strict=True):
        lines.writerow("" if gaps and isinstance(cell, float) and math.isnan(cell) else cell for cell in row)
    return text.getvalue().encode()


def select(
    requirement: Mapping[str, Any] | str | os.PathLike[str] | None = None,
    /,
    *,
    free: bool = False,
    lists: Mapping[str, Any] | str | None = None,
    **changes: Any,
) -> SelectReport:
    """Select the best screw for a requirement, like `bsm select`.

    Parameters
    ----------
    requirement : mapping or path, optional
        Inputs of a case and keys of `REQUIREMENTS`, or the path of a file that contains them.
    free : bool
        If true, the dimensions and the contact angle vary continuously.
    lists : mapping or "manufacturers" or "standard", optional
        Sizes from which the screw is chosen. Defaults to the sizes of manufacturers.
    **changes
        Keys that replace keys of `requirement`.

    Returns
    -------
    SelectReport
        `case` contains the selected screw as a case for the other functions.

    Raises
    ------
    InputError
        If the requirement is incomplete or violates a rule.

    Examples
    --------
    >>> import ballscrew as bs
    >>> report = bs.select(axial_load_N=4000, screw_speed_rpm=1500, stroke_mm=600, lead_mm=10,
    ...                    friction_coefficient=0.05, required_life_h=5000)
    >>> report.found, report.case.lead_mm
    (True, 10.0)
    """
    return SelectReport(*_core.select({**_requirement(requirement or {}), **changes}, free, _sizes(lists)))


def _sizes(lists: Mapping[str, Any] | str | None) -> str | dict[str, Any] | None:
    """Return the list of sizes as an argument for the compiled module."""
    return lists if lists is None or isinstance(lists, str) else dict(lists)


def _requirement(requirement: Mapping[str, Any] | str | os.PathLike[str]) -> dict[str, Any]:
    if isinstance(requirement, Mapping):
        return dict(requirement)
    return _core.entries(Path(requirement).read_text(encoding="utf-8"))


def validate(
    figures: str | os.PathLike[str] | None = None, *, data: str | os.PathLike[str] | None = None
) -> Table:
    """Compare the program with published results, like `bsm validate`.

    Parameters
    ----------
    figures : path, optional
        Folder for report.html, results.json and figures. The folder is created if it does not exist.
    data : path, optional
        Folder with published data in the layout of `validation/published`. Defaults to the built-in data.

    Returns
    -------
    Table
        Table with one row per check and the columns `key`, `source`, `claim`, `claimed`, `measured`, `unit`,
        `criterion`, `note` and `verdict` (pass, fail or finding).

    Raises
    ------
    InputError
        If the published data cannot be read.
    """
    checks, files = _core.validate(figures is not None, Path(data) if data is not None else None)
    _write_report(figures, files)
    names = ["key", "source", "claim", "claimed", "measured", "unit", "criterion", "note", "verdict"]
    return _listed(names, [[check[name] for name in names] for check in checks])


def _write_report(folder: str | os.PathLike[str] | None, files: Iterable[tuple[str, str]]) -> None:
    """Write the files of a report into its folder."""
    for name, text in files:
        path = Path(cast("str | os.PathLike[str]", folder)) / name
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_text(text, encoding="utf-8", newline="")


def _listed(names: Sequence[str], rows: Sequence[Sequence[Any]], units: Mapping[str, str] | None = None) -> Table:
    """Create a table from rows of values."""
    import numpy as np

    columns = {}
    for place, name in enumerate(names):
        values = [row[place] for row in rows]
        if any(isinstance(value, str) for value in values):
            column = np.array(values, dtype=object)
        else:
            column = np.array([math.nan if v is None else float(v) for v in values])
        column.flags.writeable = False
        columns[name] = column
    if units is None:
        units = {name: OUTPUTS[name].unit for name in names if name in OUTPUTS}
    return Table(columns, units, len(rows))


def _answered(rows: _core.Rows, inputs: Mapping[str, Any]) -> Table:
    """Create a table of solved rows with their inputs and results."""
    import numpy as np

    columns: dict[str, Any] = dict(inputs)
    columns["model"] = TextColumn(rows.models)
    columns["status"] = TextColumn(rows.statuses)
    columns["message"] = MessageColumn(rows.messages, len(rows))
    for name, buffer in rows.outputs():
        numbers = np.frombuffer(buffer, np.float64)
        columns[name] = _texts(numbers, OUTPUTS[name].values) if OUTPUTS[name].values else numbers
    units = {name: (INPUTS.get(name) or OUTPUTS[name]).unit
             for name in columns if name in INPUTS or name in OUTPUTS}
    return Table(columns, units, len(rows), rows)


def _texts(places: Floats, values: Sequence[str]) -> TextColumn:
    """Create a text column from indices into `values`. NaN stands for a missing text."""
    import numpy as np

    return TextColumn(lambda: (np.where(np.isnan(places), -1, places).astype(np.int8), list(values)))


def _number(name: str, value: Any) -> float:
    """Return the value of an input as a number in the unit at the end of the input's name."""
    if hasattr(value, "magnitude") and hasattr(value, "to"):
        value = _converted(name, value)
    if isinstance(value, (bool, str)):
        raise InputError(f"`{name}` is {value!r}, but must be a number", key=name)
    try:
        return float(value)
    except (TypeError, ValueError):
        raise InputError(f"`{name}` is {value!r}, but must be a number", key=name) from None


def _converted(name: str, value: Any) -> Any:
    """Return the magnitude of a quantity with a unit (pint)."""
    if name not in INPUTS:
        raise InputError(f"`{name}` must be a plain number; only inputs accept quantities with units", key=name)
    try:
        return value.to(_pint_unit(INPUTS[name].unit)).magnitude
    except Exception as error:
        raise InputError(f"`{name}`: {error}", key=name) from error


def _pint_unit(unit: str) -> str:
    """Return a unit in the syntax of pint: mm2/s is mm^2/s, N m is N*m, and C means degrees Celsius, not coulomb."""
    if unit == "C":
        return "degC"
    if unit in ("HRC", "HV10"):
        return "dimensionless"
    return re.sub(r"([a-z])(\d)", r"\1^\2", unit).replace(" ", "*") or "dimensionless"


def _no_points(points: Any) -> InputError:
    """Return the error for an object that does not contain columns of points."""
    kind = type(points).__name__
    if hasattr(points, "collect"):
        return InputError(f"points is {kind}, which has no rows yet; give points.collect()")
    if isinstance(points, Case):
        return InputError("points is a case; the first argument must be the points, and the second may be a case with their common inputs")
    return InputError(f"points is {kind}; give a mapping of names to arrays, or a frame with an Arrow stream")


def _library(name: str, method: str) -> Any:
    """Import an optional library that a method needs."""
    try:
        return import_module(name)
    except ModuleNotFoundError as error:
        if error.name != name:
            raise
        words = f"{method}() needs {name}: pip install {name}"
        raise ModuleNotFoundError(words, name=name) from None


def _column(name: str, values: Any) -> Floats:
    """Return a contiguous, read-only array of doubles. An array that already has this layout is not copied."""
    import numpy as np

    if isinstance(values, (Uniform, Normal)):
        raise InputError(f"`{name}` is random; draw random points with draw({{{name!r}: {values!r}, ...}}, samples)", key=name)
    if isinstance(values, Linspace):
        values = np.linspace(*values)
    if hasattr(values, "magnitude") and hasattr(values, "to"):
        values = _converted(name, values)
    if isinstance(values, np.ma.MaskedArray):
        masked: Any = values.astype(np.float64)
        values = masked.filled(np.nan)
    try:
        array = np.asarray(values, dtype=np.float64, order="C").view()
    except (TypeError, ValueError):
        cells = np.asarray(values, dtype=object)
        row = next((row for row, value in enumerate(cells.flat) if not _is_number(value)), None)
        if row is None or cells.ndim != 1:
            raise InputError(f"column `{name}` contains a value that is not a number", key=name) from None
        raise InputError(f"column `{name}` holds {cells[row]!r} in row {row}, which is not a number", key=name,
                         row=row) from None
    if array.ndim > 1:
        raise InputError(f"column `{name}` has {array.ndim} dimensions; give one, such as values.ravel()",
                         key=name)
    array.flags.writeable = False
    return array


def _is_number(value: Any) -> bool:
    try:
        float(value)
    except (TypeError, ValueError):
        return False
    return True


def _shown(progress: bool | Progress | None) -> Progress | None:
    """Return the progress function, which is called with the numbers of finished rows and of all rows."""
    if progress is True:
        import sys

        if not sys.stderr.isatty():
            return None

        def show(done: int, total: int) -> None:
            end = "\n" if done == total else ""
            print(f"\r{done:,} of {total:,} points", end=end, file=sys.stderr, flush=True)

        return show
    return progress or None


def _same(one: NDArray[Any], other: NDArray[Any]) -> bool:
    """Return true if two columns are equal. Missing values count as equal."""
    import numpy as np

    return np.array_equal(one, other, equal_nan=one.dtype.kind == other.dtype.kind == "f")


def _near(name: str, names: Iterable[str]) -> str:
    """Return a suggestion for a misspelled name."""
    near = difflib.get_close_matches(name, [known for known in names if not known.startswith("_")], 1)
    return f", did you mean `{near[0]}`?" if near else ""


def _few(names: Iterable[str]) -> str:
    """Return a text with the first eight names and the number of further names."""
    shown = list(names)
    more = f", and {len(shown) - 8} more" if len(shown) > 8 else ""
    return ", ".join(shown[:8]) + more


def _is_plain(value: Any) -> bool:
    return isinstance(value, (str, int, float))


def _html_lines(title: str, lines: Sequence[Mapping[str, Any]]) -> str:
    """Return an HTML table of entries with the same fields. Only the first eight fields are shown."""
    names = [name for name in lines[0] if any(_is_plain(line.get(name)) for line in lines)][:8]
    head = "".join(f"<th>{_escape(name)}</th>" for name in names)

    def cell(line: Mapping[str, Any], name: str) -> str:
        value = line.get(name)
        return f"<td>{_escape(_short(value)[:120]) if _is_plain(value) else ''}</td>"

    body = "".join(f"<tr>{''.join(cell(line, name) for name in names)}</tr>" for line in lines)
    return f"<p>{_escape(title)}</p><table><tr>{head}</tr>{body}</table>"


def _intervals(entries: Mapping[str, Any]) -> dict[str, Any]:
    """Return the 90 % intervals of the results over the possible grooves."""
    return dict(entries.get("groove_estimate", {}).get("intervals", {}))


def _with_interval(value: Any, ends: Sequence[float] | None) -> str:
    """Return a value with its 90 % interval, if it has one."""
    if ends is None or not isinstance(value, float):
        return _short(value)
    return f"{_short(value)} ({ends[0]:.4g} to {ends[1]:.4g})"


def _short(value: Any) -> str:
    if value is None:
        return ""
    return f"{value:.6g}" if isinstance(value, float) else str(value)


def _escape(text: Any) -> str:
    import html

    return html.escape(str(text))


def _html(rows: Iterable[tuple[Any, Any, str]]) -> str:
    """Return an HTML table of names, values and units."""
    body = "".join(
        f"<tr><td>{_escape(name)}</td><td>{_escape(_short(value))}</td><td>{_escape(unit)}</td></tr>"
        for name, value, unit in rows
    )
    return f"<table>{body}</table>"
