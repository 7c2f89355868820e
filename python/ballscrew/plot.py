"""Draw figures with matplotlib. Every function except `save` draws into axes and returns the axes."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from ballscrew._api import INPUTS, OUTPUTS, Grid, Table
from ballscrew._errors import InputError

if TYPE_CHECKING:
    from os import PathLike

    from matplotlib.axes import Axes

__all__ = ["curves", "heatmap", "pareto", "save"]


def curves(
    table: Table,
    x: str,
    y: str,
    *,
    by: str | None = None,
    error: str | tuple[str, str] | None = None,
    ax: Axes | None = None,
) -> Axes:
    """Draw an output as a function of an input, with one line for each value of another input.

    Rows without a result leave gaps in the lines.

    Parameters
    ----------
    table : Table
        Result of `solve_many` or `sweep`.
    x, y : str
        Names of the columns on the horizontal and the vertical axis.
    by : str, optional
        Column whose value is constant on each line. For a grid of two inputs, it defaults to the other input.
    error : str or tuple of str, optional
        Column with the error of `y`, such as "efficiency_error_bound", which is drawn as a band on both sides of the
        line. Or two columns with the lower and the upper end of an interval of `y`, such as ("band_efficiency_low",
        "band_efficiency_high"), between which the band is drawn.
    ax : matplotlib axes, optional
        Axes to draw into.

    Returns
    -------
    matplotlib axes
        The given axes or, if no axes are given, new axes.

    Raises
    ------
    InputError
        If the grid varies several inputs in addition to `x`, and `by` is not given.
    KeyError
        If the table has no column with a given name.

    Examples
    --------
    >>> import ballscrew as bs
    >>> screw = bs.Case.read("examples/feed_drive.json")
    >>> grid = bs.sweep(screw, vary={"screw_speed_rpm": [500, 1000], "axial_load_N": [2e3, 8e3]}, columns=["efficiency"])
    >>> axes = bs.plot.curves(grid, "screw_speed_rpm", "efficiency", by="axial_load_N")
    >>> len(axes.lines)
    2
    """
    import numpy as np

    axes = _axes(ax)
    others = [name for name in table.axes if name != x] if isinstance(table, Grid) else []
    if by is None and len(others) > 1:
        raise InputError(f"by is required: the grid varies {', '.join(others)} besides {x}")
    by = by or next(iter(others), None)
    lines: list[tuple[Any, str | None]] = [(slice(None), None)]
    if by is not None:
        lines = [(table[by] == value, f"{value:g} {_unit(by)}".rstrip()) for value in np.unique(table[by])]
    for of_line, label in lines:
        xs, ys = table[x][of_line], table[y][of_line]
        (line,) = axes.plot(xs, ys, label=label)
        if error is not None:
            if isinstance(error, str):
                wide = table[error][of_line]
                low, high = ys - wide, ys + wide
            else:
                low, high = (table[end][of_line] for end in error)
            axes.fill_between(xs, low, high, color=line.get_color(), alpha=0.2, linewidth=0)
    if by is not None:
        axes.legend(title=_quantity(by))
    axes.set_xlabel(_label(x))
    axes.set_ylabel(_label(y))
    return axes


def heatmap(grid: Grid, output: str, *, ax: Axes | None = None) -> Axes:
    """Draw an output as a function of the two axes of a grid. The first axis is horizontal.

    Points without a result leave gaps.

    Parameters
    ----------
    grid : Grid
        Result of `sweep` for two inputs.
    output : str
        Name of the output.
    ax : matplotlib axes, optional
        Axes to draw into.

    Returns
    -------
    matplotlib axes
        The given axes or, if no axes are given, new axes.

    Raises
    ------
    ValueError
        If the grid does not have two axes.
    """
    if len(grid.axes) != 2:
        raise ValueError(f"a heatmap requires a grid with two axes, but this grid has {len(grid.axes)}")
    axes = _axes(ax)
    (x, xs), (y, ys) = grid.axes.items()
    drawn = axes.pcolormesh(xs, ys, grid.grid(output).T, shading="nearest")
    axes.figure.colorbar(drawn, ax=axes, label=_label(output))
    axes.set_xlabel(_label(x))
    axes.set_ylabel(_label(y))
    return axes


def pareto(
    nuts: Table, x: str = "nut_mass_kg", y: str = "dynamic_load_rating_N", *, ax: Axes | None = None
) -> Axes:
    """Draw a point for each nut of a catalog, and a line through the nuts that are Pareto-optimal in `x` and `y`.

    Parameters
    ----------
    nuts : Table
        Result of `select_nuts`.
    x, y : str
        Names of the columns on the horizontal and the vertical axis. Small values of `x` and large values of `y` are
        better.
    ax : matplotlib axes, optional
        Axes to draw into.

    Returns
    -------
    matplotlib axes
        The given axes or, if no axes are given, new axes.
    """
    import numpy as np

    axes = _axes(ax)
    order = np.lexsort((-nuts[y], nuts[x]))
    xs, ys = nuts[x][order], nuts[y][order]
    best = np.flatnonzero(np.diff(np.maximum.accumulate(ys), prepend=-np.inf) > 0)
    axes.plot(xs, ys, ".", markersize=2, alpha=0.5)
    axes.step(xs[best], ys[best], where="post")
    axes.set_xlabel(_label(x))
    axes.set_ylabel(_label(y))
    return axes


def save(axes: Axes, path: str | PathLike[str], *, size_mm: tuple[float, float] | None = None, title: str | None = None) -> None:
    """Write the figure that contains the axes to a file. A PDF embeds its fonts as TrueType, which journals require.

    Parameters
    ----------
    axes : matplotlib axes
        Axes that a function of this module returned.
    path : path
        Path of the file. The file extension determines the format.
    size_mm : tuple of float, optional
        Width and height of the figure in millimeters.
    title : str, optional
        Title above the axes.

    Raises
    ------
    OSError
        If the file cannot be written.
    """
    import matplotlib as mpl

    figure: Any = axes.figure
    if size_mm is not None:
        figure.set_size_inches(*(length / 25.4 for length in size_mm))
    if title is not None:
        axes.set_title(title)
    with mpl.rc_context({"pdf.fonttype": 42, "ps.fonttype": 42}):
        figure.savefig(path, bbox_inches=None if size_mm else "tight")


def _axes(ax: Axes | None) -> Axes:
    if ax is not None:
        return ax
    import matplotlib.pyplot as plt

    # The layout adapts to the size that `save` sets, so that no label is cut off.
    axes: Axes = plt.subplots(layout="constrained")[1]
    return axes


def _unit(name: str) -> str:
    quantity = INPUTS.get(name) or OUTPUTS.get(name)
    return quantity.unit if quantity else ""


def _quantity(name: str) -> str:
    """Return the name of a quantity as words, without its unit."""
    unit = _unit(name)
    ending = unit.replace("/", "_").replace("^", "").replace(" ", "")
    bare = name.removesuffix(f"_{ending}") if ending else name
    return bare.replace("_", " ")


def _label(name: str) -> str:
    unit = _unit(name)
    return f"{_quantity(name)} [{unit}]" if unit else _quantity(name)
