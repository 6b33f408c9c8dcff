"""Scripts that complete words of the command line in a shell."""

from __future__ import annotations

import argparse
from collections.abc import Iterator
from pathlib import Path

SHELLS = ("bash", "zsh", "fish", "tcsh")


def completion(parser: argparse.ArgumentParser, shell: str) -> str:
    """The script for one of the shells; names of files are completed where paths are expected."""
    if shell == "fish":
        return "\n".join(_fish(parser))
    import shtab

    _complete_paths(parser)
    return shtab.complete(parser, shell=shell)


def _complete_paths(parser: argparse.ArgumentParser) -> None:
    import shtab

    for command in _commands(parser).values():
        _complete_paths(command)
    for action in parser._actions:
        if action.type is Path:
            action.complete = shtab.FILE  # type: ignore[attr-defined]


def _commands(parser: argparse.ArgumentParser) -> dict[str, argparse.ArgumentParser]:
    found: dict[str, argparse.ArgumentParser] = {}
    for action in parser._actions:
        if isinstance(action, argparse._SubParsersAction):
            found.update(action.choices)
    return found


def _fish(parser: argparse.ArgumentParser) -> Iterator[str]:
    """Lines for fish, which shtab does not know."""
    yield f"complete -c {parser.prog} -f"
    commands = _commands(parser)
    for name, command in {"": parser, **commands}.items():
        condition = f"__fish_seen_subcommand_from {name}" if name else "__fish_use_subcommand"
        start = f"complete -c {parser.prog} -n '{condition}'"
        for action in command._actions:
            if isinstance(action, argparse._SubParsersAction):
                for one in action._choices_actions:
                    yield f"{start} -a {one.dest} -d {_quoted(one.help)}"
            else:
                yield f"{start}{_fish_option(action)}"


def _fish_option(action: argparse.Action) -> str:
    """What an option, or a word without one, takes."""
    words = [
        f" -{'l' if o.startswith('--') else 's'} {o.lstrip('-')}" for o in action.option_strings
    ]
    if action.choices is not None:
        words.append(f" -x -a {_quoted(' '.join(map(str, action.choices)))}")
    elif action.type is Path:
        words.append(" -r -F" if words else " -F")
    elif action.nargs != 0 and words:
        words.append(" -x" if action.nargs != "?" else " -f")
    return "".join(words) + f" -d {_quoted(action.help)}"


def _quoted(text: str | None) -> str:
    return "'" + (text or "").replace("%%", "%").replace("\\", "\\\\").replace("'", "\\'") + "'"
