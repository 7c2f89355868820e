"""Writes `_vocabulary.py` from the core: `python -m ballscrew._write_vocabulary [--check]`."""

from __future__ import annotations

import sys
import textwrap
from pathlib import Path

from ballscrew import _core

TARGET = Path(__file__).with_name("_vocabulary.py")

# What a scene says besides numbers.
WORDS = _core.scene_words()


def text() -> str:
    """The text of the module."""
    inputs = _core.inputs()
    outputs = _core.outputs()
    solution = [output for output in outputs if output[5] is None]
    parts = [
        '"""The words of the program with their types. Written by `python -m ballscrew._write_vocabulary`."""',
        "",
        "from __future__ import annotations",
        "",
        "from typing import Any, Literal, TypedDict",
        "",
        f"Model = Literal[{_list(_core.models())}]",
        f"Control = Literal[{_list(_core.races())}]",
        f"Output = Literal[{_list([output[0] for output in outputs])}]",
        "",
        "",
        "class Inputs(TypedDict, total=False):",
        '    """Inputs of a scene."""',
        "",
        "    description: str",
    ]
    parts += [f"    {name}: float" for name, *_ in inputs]
    parts += [f"    {name}: Any" for name in WORDS]
    parts += ["", "", "class SceneFields:", '    """A property for each input."""', "", "    __slots__ = ()", ""]
    parts += ["    def number(self, place: int) -> float | None:", "        raise NotImplementedError"]
    for place, (name, unit, about, default, _) in enumerate(inputs):
        unless = f"; {default:g} unless given" if default is not None else ""
        parts += _property(name, "float | None", f"{_sentence(about)} [{unit}]{unless}.", f"self.number({place})")
    parts += ["", "", "class SolutionFields:", '    """A property for each output."""', "", "    __slots__ = ()", ""]
    parts += ["    def value(self, place: int) -> Any:", "        raise NotImplementedError"]
    kinds = {"number": "float", "integer": "float", "boolean": "bool | None", "string": "str | None"}
    for place, (name, unit, about, kind, _, _) in enumerate(solution):
        value = f"self.value({place})"
        if kinds[kind] == "float":
            value = f"_or_nan({value})"
        parts += _property(name, kinds[kind], f"{_sentence(about)} [{unit}].", value)
    parts += ["", "", "def _or_nan(value: Any) -> float:", '    return float("nan") if value is None else value']
    return "\n".join(parts) + "\n"


def _list(names: list[str]) -> str:
    rows = "".join(f'    "{name}",\n' for name in names)
    return f"\n{rows}"


def _sentence(about: str) -> str:
    return about[0].upper() + about[1:]


def _property(name: str, kind: str, about: str, value: str) -> list[str]:
    about = about.replace(" []", "")
    lines = textwrap.wrap(f'"""{about}"""', 100)
    return ["", "    @property", f"    def {name}(self) -> {kind}:", *(f"        {line}" for line in lines),
            f"        return {value}  # type: ignore[no-any-return]" if kind != "float" and "value" in value
            else f"        return {value}"]


def main() -> None:
    """Writes, or with `--check` compares."""
    if "--check" in sys.argv:
        if TARGET.read_text(encoding="utf-8") != text():
            sys.exit(f"{TARGET.name} is old: python -m ballscrew._write_vocabulary")
    else:
        TARGET.write_text(text(), encoding="utf-8")


if __name__ == "__main__":
    main()
