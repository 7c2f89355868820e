"""What the program can do the package can: every command and every option of `--help`, or why it is left out."""

from __future__ import annotations

import inspect
import re
import subprocess
from collections.abc import Callable
from typing import Any

import pytest
from conftest import program

import ballscrew as bs
from ballscrew._vocabulary import Inputs

# Functions of commands that have another name, or more than one.
FUNCTIONS: dict[str, list[Callable[..., Any]]] = {
    "solve": [bs.solve, bs.sensitivities],
    "batch": [bs.solve_many, bs.plan],
    "sweep": [bs.sweep, bs.plan],
    "shard": [bs.Plan.open, bs.Plan.run, bs.run_shard],
    "verify": [bs.Plan.verify],
}

WITHOUT = {
    "tradeoff": "measures the program on a machine",
    "view": "a page of its own; a notebook shows scenes, answers and tables",
    "schema": "INPUTS, OUTPUTS and the types of the package say it",
    "completions": "of a shell",
    "help": "help()",
}

# By option, or by command and option where only one command has it so.
LEFT_OUT = {
    "help": "help()",
    "version": "__version__",
    "set": "keywords",
    "format": "reports are mappings, to_json() is of the solution",
    "quiet": "nothing is shown without progress=True",
    "keep-going": "a row has a status",
    "output": "Table.write(), and what a Report holds",
    "columns": "outputs=; column_names of a table",
    "delimiter": "pandas.read_csv(sep=) reads such a table",
    "decimal": "pandas.read_csv(decimal=) reads such a table",
    "plot": "ballscrew.plot, or any other library, draws the numbers",
    "table": "the balls and the steps of a report",
    "solve sensitivities": "a function of its own",
    "solve band": "to_dict() has it, as --band=always",
    "sweep map": "plot.map()",
    "sweep plot-output": "plot.map() and plot.curves() take it",
    "sweep plan": "a function of its own",
    "sweep resume": "Plan.run() goes on",
    "sweep metadata": "Grid has scene and settings, a folder its plan",
    "batch plan": "a function of its own",
    "batch resume": "Plan.run() goes on",
    "batch metadata": "a folder has its plan",
    "batch columns-from": "columns are named in the call",
    "batch same-signs": "pandas.DataFrame.to_csv(sep=, decimal=) writes such a table",
    "shard index": "run(range(index, plan.shards, of))",
    "shard of": "run(range(index, plan.shards, of))",
    "nut curve": "NutReport.curve",
    "catalog pick": "Nuts.scene()",
}


def helped(*command: str) -> str:
    """What `--help` says, unwrapped."""
    run = subprocess.run([program(), *command, "--help"], capture_output=True, text=True, check=True)
    return run.stdout


def commands() -> list[str]:
    """The commands of the program."""
    return re.findall(r"^  (\w+)  ", helped().split("Commands:")[1].split("Options:")[0], re.MULTILINE)


def options(command: str) -> dict[str, str]:
    """The options of a command and what is said of each."""
    parts = re.split(r"^\s+(?:-\w, )?--([a-z-]+)", helped(command), flags=re.MULTILINE)
    return dict(zip(parts[1::2], parts[2::2], strict=True))


def parameters(command: str) -> dict[str, inspect.Parameter]:
    """The parameters of the functions of a command."""
    functions = FUNCTIONS[command] if command in FUNCTIONS else [getattr(bs, command)]
    found: dict[str, inspect.Parameter] = {}
    for function in functions:
        found.update(inspect.signature(function).parameters)
    return found


def is_input(name: str, given: dict[str, inspect.Parameter]) -> bool:
    """True if it is given as one of the inputs."""
    takes_inputs = any(parameter.kind is parameter.VAR_KEYWORD for parameter in given.values())
    return takes_inputs and name in Inputs.__annotations__


def test_every_command_is_a_function() -> None:
    found = commands()
    assert len(found) > 15
    for command in found:
        there = command in FUNCTIONS or hasattr(bs, command)
        assert there != (command in WITHOUT), command
    assert set(WITHOUT) <= set(found)


def test_every_option_is_a_keyword() -> None:
    needless = set(LEFT_OUT)
    for command in commands():
        if command in WITHOUT:
            continue
        given = parameters(command)
        for option in options(command):
            name = option.replace("-", "_")
            if name in given or is_input(name, given):
                # A reason that holds no more.
                assert f"{command} {option}" not in LEFT_OUT, f"{command} --{option} is there"
                continue
            reasons = {option, f"{command} {option}"} & set(LEFT_OUT)
            assert reasons, f"bsm {command} --{option} is neither in the package nor left out for a reason"
            needless -= reasons
    assert not needless, "reasons without an option"


@pytest.mark.parametrize("command", ["solve", "sweep", "batch", "fit", "nut", "size", "slip", "jam"])
def test_what_is_not_given_is_the_same(command: str) -> None:
    given, compared = parameters(command), 0
    for option, words in options(command).items():
        default = re.search(r"\[default: ([^\]]+)\]", words)
        parameter = given.get(option.replace("-", "_"))
        if default is None or parameter is None:
            continue
        ours, theirs = parameter.default, default[1]
        assert (float(theirs) if isinstance(ours, (int, float)) else theirs) == ours, f"{command} --{option}"
        compared += 1
    assert compared > 0
