"""Exceptions of the package."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from ballscrew._api import Solution

__all__ = [
    "BallscrewError",
    "InputError",
    "NoSolutionError",
    "NotConvergedError",
    "PartError",
    "SolveError",
]


class BallscrewError(Exception):
    """Base class of all exceptions of the package."""


class InputError(BallscrewError, ValueError):
    """An input, a column or a setting cannot be used.

    Attributes
    ----------
    key : str or None
        Name of the invalid input or column.
    value : float or None
        Value of the input, if it violates a rule.
    rule : str or None
        Rule for the value, as the text after "must be".
    nearest : str or None
        Known name that is closest to an unknown name.
    row : int or None
        Index of the invalid row of a table. The first row has the index 0.
    """

    def __init__(
        self,
        message: str,
        *,
        key: str | None = None,
        value: float | None = None,
        rule: str | None = None,
        nearest: str | None = None,
        row: int | None = None,
    ) -> None:
        super().__init__(message)
        self.key = key
        self.value = value
        self.rule = rule
        self.nearest = nearest
        self.row = row


class SolveError(BallscrewError, ArithmeticError):
    """A point has no result.

    Attributes
    ----------
    solution : Solution
        The solution, with its status and message.
    """

    def __init__(self, message: str, solution: Solution) -> None:
        super().__init__(message)
        self.solution = solution

    def __reduce__(self) -> tuple[Any, ...]:
        return type(self), (str(self), self.solution)


class NoSolutionError(SolveError):
    """The equations have no solution at this point."""


class NotConvergedError(SolveError):
    """The solver found no solution, but a solution may exist."""


class PartError(BallscrewError):
    """A part is missing or damaged, or could not be solved."""
