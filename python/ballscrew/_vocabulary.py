"""Names of inputs and outputs, from the compiled module.

`_vocabulary.pyi` contains the same names for type checkers and editors. It is written when the package is built.
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
        "description": str,
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
    """A property for each input."""

    __slots__ = ()


for _place, (_name, _unit, _about, _default, _) in enumerate(_core.inputs()):
    _unless = f"; defaults to {_default:g}" if _default is not None else ""
    setattr(CaseFields, _name, _property(_core.Case.number, _place, float | None, _about, _unit, _unless))


for _name, _about, *_ in _core.case_choices():
    setattr(CaseFields, _name, _property(_core.Case.entry, _name, Any, _about, ""))


class SolutionFields(_core.Solution):
    """A property for each output. It is NaN if the model does not calculate the output."""

    __slots__ = ()


_NUMBER = _core.Solution.number, float
_KINDS = {"boolean": (_core.Solution.flag, bool | None), "string": (_core.Solution.word, str | None)}

for _place, (_name, _unit, _about, _kind, _, _analysis) in enumerate(_core.outputs()):
    if _analysis is None:
        _read, _type = _KINDS.get(_kind, _NUMBER)
        setattr(SolutionFields, _name, _property(_read, _place, _type, _about, _unit))
