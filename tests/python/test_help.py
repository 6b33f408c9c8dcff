"""What the command line tells about itself: examples, completion, and what is installed."""

from __future__ import annotations

import argparse
import json
import shlex
import subprocess
from pathlib import Path

import pytest

import devseg
from devseg.cli import _parser, main
from devseg.help_text import EXAMPLES


def commands() -> dict[str, argparse.ArgumentParser]:
    actions = _parser()._actions
    return next(a.choices for a in actions if isinstance(a, argparse._SubParsersAction))


def test_every_command_has_examples_and_every_example_is_right(
    capsys: pytest.CaptureFixture[str],
) -> None:
    assert set(EXAMPLES) == set(commands())
    for name, examples in EXAMPLES.items():
        assert examples
        for line, what in examples:
            words = shlex.split(line.partition(" > ")[0])
            assert words[:2] == ["devseg", name]
            assert _parser().parse_args(words[1:]).subparser.prog == f"devseg {name}"
            assert line in commands()[name].format_help() and what
    with pytest.raises(SystemExit):
        main(["batch", "--help"])
    assert "\n  devseg batch meshes -o out --jobs 8\n" in capsys.readouterr().out


@pytest.mark.parametrize("shell", ["bash", "zsh", "fish", "tcsh"])
def test_completion(shell: str, capsys: pytest.CaptureFixture[str], tmp_path: Path) -> None:
    assert main(["completion", shell]) == 0
    script = capsys.readouterr().out
    assert "measure" in script and "world-size" in script
    if shell == "bash":
        (tmp_path / "devseg").write_text(script)
        completed = subprocess.run(
            ["bash", "-c", "source ./devseg; COMP_WORDS=(devseg ba); COMP_CWORD=1; _shtab_devseg; "
             'echo "${COMPREPLY[@]}"'],
            cwd=tmp_path, capture_output=True, text=True, check=True,
        )  # fmt: skip
        assert completed.stdout == "batch\n" and completed.stderr == ""
    if shell == "fish":
        start = "complete -c devseg -n '__fish_seen_subcommand_from batch'"
        lines = script.splitlines()
        assert f"{start} -s o -l out -r -F -d 'for all'" in lines
        assert any(line.startswith(f"{start} -l seams -x -a 'smooth edges' -d ") for line in lines)
        # Every quotation ends in its line.
        assert all(len(shlex.split(line.replace("\\'", ""))) > 3 for line in lines)


def test_info_for_programs_tells_the_same_as_for_people(
    capsys: pytest.CaptureFixture[str],
) -> None:
    assert main(["info", "--json"]) == 0
    found = json.loads(capsys.readouterr().out)
    assert found["versions"]["devseg"] == devseg.__version__ and found["error"] is None
    assert [one["flavour"] for one in found["plugins"]] == ["pymeshlab-2025.07"] * 2
    assert "export_pattern" in found["filters"]
    assert found["hosts"][0]["kind"] == "pymeshlab"
    assert main(["info"]) == 0
    text = capsys.readouterr().out
    for line in [*found["filters"], *(line for h in found["hosts"] for line in h["about"])]:
        assert line in text


def test_info_without_plugins_is_no_error(
    capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch, tmp_path: Path
) -> None:
    monkeypatch.setenv("DEVSEG_PLUGIN_DIR", str(tmp_path))
    monkeypatch.setattr("devseg.plugins._loaded", [])
    assert main(["info", "--json"]) == 0
    found = json.loads(capsys.readouterr().out)
    assert "expected the plugins" in found["error"] and found["plugins"] == []
