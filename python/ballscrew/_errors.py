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
    """Raised if an input, a column or a setting is invalid.

    Attributes
    ----------
    key : str or None
        Name of the invalid input or column.
    value : float or None
        Value of the input, if it violates a rule.
    rule : str or None
        Rule that the value violates, worded as the text after "must be".
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
    """Raised if a point has no result.

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
    """Raised if the equations have no solution at a point."""


class NotConvergedError(SolveError):
    """Raised if the solver found no solution although a solution may exist."""


class PartError(BallscrewError):
    """Raised if a part is missing or damaged, or could not be solved."""
