"""Names of inputs and outputs, which are read from the compiled module.

`_vocabulary.pyi` contains the same names for type checkers and editors. The build of the package writes this file.
"""

from typing import Any, Literal, TypedDict

from ballscrew import _core

Model = Literal[tuple(_core.MODELS)]
Control = Literal[tuple(_core.RACEWAYS)]
Friction = Literal[tuple(_core.FRICTIONS)]
Output = Literal[tuple(dict.fromkeys(name for name, *_ in _core.outputs()))]

Inputs = TypedDict(
    "Inputs",
    {
        "description": str | None,
        **{name: float | None for name, *_ in _core.inputs()},
        **{name: float | None for name in _core.names_in_other_units()},
        **{name: Any for name, *_ in _core.case_choices()},
    },
    total=False,
)


def _property(read, place, type_, about, unit, unless=""):
    def value(self):
        return read(self, place)

    value.__annotations__ = {"return": type_}
    of_unit = f" [{unit}]" if unit else ""
    return property(value, doc=f"{about[0].upper()}{about[1:]}{of_unit}{unless}.")


class CaseFields(_core.Case):
    """Base class of `Case`, with a property for each input."""

    __slots__ = ()


for _place, (_name, _unit, _about, _default, _) in enumerate(_core.inputs()):
    _unless = f"; defaults to {_default:g}" if _default is not None else ""
    setattr(CaseFields, _name, _property(_core.Case._number, _place, float | None, _about, _unit, _unless))


for _name, _about, *_ in _core.case_choices():
    setattr(CaseFields, _name, _property(_core.Case._entry, _name, Any, _about, ""))


class SolutionFields(_core.Solution):
    """Base class of `Solution`, with a property for each output. An output that the model does not calculate is NaN."""

    __slots__ = ()


_NUMBER = _core.Solution._number, float
_KINDS = {"boolean": (_core.Solution._flag, bool | None), "string": (_core.Solution._word, str | None)}

for _place, (_name, _unit, _about, _kind, _, _analysis) in enumerate(_core.outputs()):
    if _analysis is None:
        _read, _type = _KINDS.get(_kind, _NUMBER)
        setattr(SolutionFields, _name, _property(_read, _place, _type, _about, _unit))


_TYPES = {"number": float | None, "integer": int | None, "boolean": bool | None, "string": str | None}


def _of_section(section, name):
    return section._value(name)


def _section(name, about, *tables):
    """Create a class with a property for each column of the given tables of the program."""
    columns = [column for table in tables for column in _core.columns(table)]
    properties = {column: _property(_of_section, column, _TYPES[kind], meaning, unit) for column, unit, meaning, kind in columns}
    return type(name, (), {"__slots__": (), "__doc__": about, "__module__": __name__, **properties})


SlipFields = _section("SlipFields", "A property for each number of `slip`.", "slip")
JamFields = _section("JamFields", "A property for each number of `jam`.", "jam")
OptimumFields = _section("OptimumFields", "A property for each number of `optimum`.", "optimum")
ModelOptimumFields = _section("ModelOptimumFields", "A property for each optimum of a model.", "best")
RatingsFields = _section("RatingsFields", "A property for each number of `ratings`.", "ratings", "as used")
RatingStepsFields = _section("RatingStepsFields", "A property for each intermediate value of the load ratings.", "steps")
NutFields = _section("NutFields", "A property for each number of `nut`.", "nut")
AxisFields = _section("AxisFields", "A property for each number of `axis`.", "axis")
ScrewFields = _section("ScrewFields", "A property for each number of the screw of an axis.", "screw")
PhaseFields = _section("PhaseFields", "A property for each number of a phase of an axis.", "phase", "torques")

SECTIONS = (
    SlipFields, JamFields, OptimumFields, ModelOptimumFields, RatingsFields, RatingStepsFields, NutFields, AxisFields,
    ScrewFields, PhaseFields,
)
"""All classes with a property for each number in a section of an answer."""
