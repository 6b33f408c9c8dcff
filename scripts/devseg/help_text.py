"""What `--help` shows below the options of each command: examples that work."""

from __future__ import annotations

import argparse
from typing import Any

# Command lines by command, each with what it is for.
EXAMPLES: dict[str, list[tuple[str, str]]] = {
    "run": [
        ("devseg run toy.obj -o out --height-mm 250", "a pattern of a toy 25 cm high"),
        (
            "devseg run toy.obj -o out --method plush --preset sewing --formats pdf --page a4 "
            "--seam-allowance-mm 6",
            "to print and to sew",
        ),
        (
            "devseg run toy.obj -o out --method papercraft --target-faces 600 --formats pdf",
            "to fold",
        ),
        ("devseg run scan.ply -o out --max-l2-stretch 1.01", "as few charts as that allows"),
        ("devseg run scene.glb -o out --object Body --longest 10in", "one object of a file"),
    ],
    "batch": [
        ("devseg batch meshes -o out --jobs 8", "a folder; again after a stop: it goes on"),
        (
            "devseg batch a.obj more -o out --formats ply --no-picture --timeout 60 --memory 4",
            "with limits for each mesh",
        ),
        (
            "devseg batch meshes -o /shared/out --rank 3 --world-size 16",
            "one share of sixteen; in a job array of SLURM without both options",
        ),
        (
            "devseg batch meshes -o /shared/out --executor dask:tcp://host:8786",
            "on a Dask cluster",
        ),
    ],
    "compare": [
        ("devseg compare toy.obj --methods dcharts,plush --charts 12", "two methods"),
        ("devseg compare toy.obj -o out --json", "all methods, for programs"),
    ],
    "measure": [
        ("devseg measure out/toy.ply", "what devseg has made"),
        ("devseg measure other.obj --json", "any mesh with texture coordinates"),
    ],
    "edit": [
        ("devseg edit out/toy.ply --join 3,5 --split 2 -o new.ply", "numbers of the pattern"),
        ("devseg edit out/toy.ply --remove-seam 14 -o new.ply", "a seam by its number"),
    ],
    "info": [("devseg info", "for people"), ("devseg info --json", "for programs")],
    "completion": [
        (
            "devseg completion bash > ~/.local/share/bash-completion/completions/devseg",
            "bash, from the next shell on",
        ),
        ("devseg completion zsh > ~/.zfunc/_devseg", "zsh, with ~/.zfunc in fpath"),
        ("devseg completion fish > ~/.config/fish/completions/devseg.fish", "fish"),
    ],
}


def add_examples(commands: Any) -> None:
    """Adds the examples to the help of all commands of a parser."""
    for name, parser in commands.choices.items():
        lines = [f"  {line}\n      {what}" for line, what in EXAMPLES.get(name, [])]
        parser.formatter_class = argparse.RawDescriptionHelpFormatter
        parser.epilog = "\n".join(["examples:", *lines])
