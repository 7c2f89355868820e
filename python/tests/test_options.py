"""Tests that every command and every option of `--help` has a function or keyword in the package, or a reason why it
is left out."""

from __future__ import annotations

import inspect
import re
import subprocess
from collections.abc import Callable
from typing import Any

import pytest
from conftest import program

import ballscrew as bs
from ballscrew._api import _SOLVER, Question, Solver
from ballscrew._vocabulary import Inputs

# For each `**` parameter, the types that describe its keywords.
KEYWORDS: dict[str, Any] = {"inputs": Inputs, "changes": Inputs, "solver": Solver, "question": Question}

# Functions that correspond to each command.
FUNCTIONS: dict[str, list[Callable[..., Any]]] = {
    "solve": [bs.solve, bs.sensitivities, bs.compare, bs.slip, bs.ellipses, bs.jam, bs.optimum, bs.ratings],
    "nut": [bs.nut],
    "axis": [bs.axis],
    "select": [bs.select, bs.select_nuts],
    "sweep": [bs.sweep, bs.solve_many, bs.plan],
    "parts run": [bs.Plan.open, bs.Plan.run, bs.run_part],
    "parts check": [bs.Plan.verify],
    "fit": [bs.fit],
    "validate": [bs.validate],
}

WITHOUT = {
    "tradeoff": "measures the program on a machine",
    "view": "a separate page; notebooks show cases, answers and tables",
    "schema": "INPUTS, OUTPUTS and the types of the package contain this information",
}

# Reasons why an option has no keyword, by option, or by command and option if the reason applies to one command.
LEFT_OUT = {
    "help": "help()",
    "set": "keywords",
    "json": "reports are mappings, and a solution has to_json()",
    "quiet": "nothing is shown without progress=True",
    "keep-going": "a row has a status",
    "output": "Table.write(), Nuts.case(), figures= for pages, and the entries of a Report",
    "delimiter": "pandas.read_csv(sep=) reads such a table",
    "decimal": "pandas.read_csv(decimal=) reads such a table",
    "names": "columns are named in the call",
    "csv-format": "pandas.DataFrame.to_csv(sep=, decimal=) writes such a table",
    "figures": "ballscrew.plot, or any other library, draws the numbers",
    "show": "each value has its own function or entry of a Report",
    "sweep plan": "a separate function",
    "sweep resume": "Plan.run() continues an interrupted run",
    "parts run only": "run(range(index, plan.parts, of))",
    "fit input": "inputs=, which does not hide the Python function input()",
    "select from": "lists= and manufacturers=",
    "select columns": "Nuts is a mapping of columns",
    "units": "results have the units in their names; the input display_units determines the units of a sheet",
    "validate from": "data=",
    "validate only": "each check is a row of the table",
}


def helped(*command: str) -> str:
    """Return the output of a command with `--help`."""
    run = subprocess.run([program(), *command, "--help"], capture_output=True, text=True, check=True)
    return run.stdout


def commands(*of: str) -> list[str]:
    """Return the commands of the program. Subcommands have two words."""
    if "Commands:" not in (text := helped(*of)):
        return [" ".join(of)]
    names = re.findall(r"^  (\w+)  ", text.split("Commands:")[1].split("Options:")[0], re.MULTILINE)
    return [command for name in names if name != "help" for command in commands(*of, name)]


def options(command: str) -> dict[str, str]:
    """Return the options of a command with their descriptions."""
    parts = re.split(r"^  (?:-\w, |    )--([a-z-]+)", helped(*command.split()), flags=re.MULTILINE)
    return {option: " ".join(words.split()) for option, words in zip(parts[1::2], parts[2::2], strict=True)}


def parameters(command: str) -> dict[str, inspect.Parameter]:
    """Return the parameters of the functions of a command. If several functions have a parameter, the first one counts."""
    found: dict[str, inspect.Parameter] = {}
    for function in FUNCTIONS[command]:
        found = {**inspect.signature(function).parameters, **found}
    return found


def is_keyword(name: str, given: dict[str, inspect.Parameter]) -> bool:
    """Return true if the option corresponds to an input or a solver setting."""
    kinds = [KEYWORDS[parameter.name] for parameter in given.values() if parameter.kind is parameter.VAR_KEYWORD]
    return any(name in kind.__annotations__ for kind in kinds)


def test_every_command_has_a_python_function() -> None:
    found = commands()
    assert len(found) == len(set(found)) and set(found) == {*FUNCTIONS, *WITHOUT}


def test_every_command_option_is_a_keyword_argument() -> None:
    needless = set(LEFT_OUT)
    for command in FUNCTIONS:
        given = parameters(command)
        for option in options(command):
            name = option.replace("-", "_")
            if name in given or is_keyword(name, given):
                # If the option has a keyword, the stated reason no longer applies.
                assert f"{command} {option}" not in LEFT_OUT, f"{command} --{option} is there"
                continue
            reasons = {option, f"{command} {option}"} & set(LEFT_OUT)
            assert reasons, f"bsm {command} --{option} is neither in the package nor left out for a reason"
            needless -= reasons
    assert not needless, "reasons without an option"


@pytest.mark.parametrize("command", ["solve", "nut", "axis", "sweep", "fit"])
def test_default_arguments_equal_the_defaults_of_the_program(command: str) -> None:
    given, said = parameters(command), options(command)
    theirs = {option.replace("-", "_"): found[1] for option, words in said.items()
              if (found := re.search(r"\[default: ([^\]]+)\]", words))}
    # The help text for a model setting states the default in words.
    settings = {name: re.findall(r"defaults to (\d[\d.e-]*)", said[name])[0]
                for name in ("tolerance", "accuracy", "creep")}
    for name, default in (theirs | settings).items():
        if is_keyword(name, given) or name in given:
            ours = _SOLVER[name] if name in _SOLVER else given[name].default
            assert (float(default) if isinstance(ours, (int, float)) else default) == ours, f"{command} {name}"
    assert theirs["model"] == "auto"
