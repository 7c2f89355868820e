"""Writes `ballscrew/_vocabulary.py` from the installed core: `python python/write_vocabulary.py [--check]`.

It does not import the package, which needs the file that is written here.
"""

from __future__ import annotations

import importlib.machinery
import importlib.util
import sys
import textwrap
from pathlib import Path
from types import ModuleType

TARGET = Path(__file__).with_name("ballscrew") / "_vocabulary.py"


def core() -> ModuleType:
    """The compiled part of the package, installed or made beside the sources."""
    for folder in sys.path:
        for ending in importlib.machinery.EXTENSION_SUFFIXES:
            path = Path(folder) / "ballscrew" / f"_core{ending}"
            if path.exists():
                spec = importlib.util.spec_from_file_location("ballscrew._core", path)
                assert spec is not None and spec.loader is not None
                module = importlib.util.module_from_spec(spec)
                spec.loader.exec_module(module)
                return module
    sys.exit("install the package first: pip install ./python")


def text() -> str:
    """The text of the module."""
    found = core()
    outputs = found.outputs()
    solution = [output for output in outputs if output[5] is None]
    parts = [
        '"""The words of the program with their types. Written by `python python/write_vocabulary.py`."""',
        "",
        # Without annotations as strings, each of which a TypedDict would compile at every import.
        "from typing import Any, Literal, TypedDict",
        "",
        "from ballscrew import _core",
        "",
        f"Model = Literal[{_list(found.models())}]",
        f"Control = Literal[{_list(found.races())}]",
        f"Friction = Literal[{_list(found.frictions())}]",
        f"Output = Literal[{_list(list(dict.fromkeys(output[0] for output in outputs)))}]",
        "",
        "",
        "class Inputs(TypedDict, total=False):",
        '    """Inputs of a scene."""',
        "",
        "    description: str",
    ]
    parts += [f"    {name}: float | None" for name, *_ in found.inputs()]
    parts += [f"    {name}: Any" for name in found.scene_words()]
    parts += ["", "", "class SceneFields(_core.Scene):", '    """A property for each input."""', "", "    __slots__ = ()"]
    for place, (name, unit, about, default, _) in enumerate(found.inputs()):
        unless = f"; {default:g} unless given" if default is not None else ""
        parts += _property(name, "float | None", about, unit, unless, f"self.number({place})")
    parts += ["", "", "class SolutionFields(_core.Solution):", '    """A property for each output; NaN where the model has none."""']
    parts += ["", "    __slots__ = ()"]
    for place, (name, unit, about, kind, _, _) in enumerate(solution):
        if kind in ("number", "integer"):
            parts += _property(name, "float", about, unit, "", f"self.number({place})")
        else:
            word = {"boolean": "flag", "string": "word"}[kind]
            type_ = {"boolean": "bool | None", "string": "str | None"}[kind]
            parts += _property(name, type_, about, unit, "", f"self.{word}({place})")
    return "\n".join(parts) + "\n"


def _list(names: list[str]) -> str:
    rows = "".join(f'    "{name}",\n' for name in names)
    return f"\n{rows}"


def _property(name: str, kind: str, about: str, unit: str, unless: str, value: str) -> list[str]:
    of_unit = f" [{unit}]" if unit else ""
    lines = textwrap.wrap(f'"""{about[0].upper()}{about[1:]}{of_unit}{unless}."""', 100)
    return ["", "    @property", f"    def {name}(self) -> {kind}:", *(f"        {line}" for line in lines), f"        return {value}"]


def main() -> None:
    """Writes, or with `--check` compares."""
    if "--check" in sys.argv:
        if TARGET.read_text(encoding="utf-8") != text():
            sys.exit(f"{TARGET.name} is old: python python/write_vocabulary.py")
    else:
        TARGET.write_text(text(), encoding="utf-8")


if __name__ == "__main__":
    main()
