"""Makes stand-ins for libraries that pymeshlab's wheel needs and bare containers lack.

    python stand_ins.py PYMESHLAB DIR

PYMESHLAB is the folder of the package. OpenGL draws on screens, and com_err serves the Kerberos of
Qt's network: neither is used where there is no screen, so that functions without content will do.
devseg loads a stand-in where the system has no such library, see requirements.py.
"""

from __future__ import annotations

import re
import subprocess
import sys
import tempfile
from pathlib import Path

_GL = re.compile(r"gl[A-Z]\w*")
# Functions, and a list that has no elements.
_COM_ERR = """void *_et_list;
long add_error_table(void) { return 0; }
long remove_error_table(void) { return 0; }
const char *error_message(void) { return "unknown error"; }
"""


def symbols(libraries: list[Path], kind: str) -> set[str]:
    """Names that libraries have (defined) or lack (undefined), without their versions."""
    command = ["nm", "--dynamic", f"--{kind}-only", "--format=posix", *map(str, libraries)]
    found = subprocess.run(command, check=True, capture_output=True, text=True).stdout
    lines = [line.split() for line in found.splitlines()]
    return {words[0].partition("@")[0] for words in lines if len(words) > 1}


def sources(pymeshlab: Path) -> dict[str, str]:
    """The texts of the stand-ins, by the names that their libraries have for the loader."""
    libraries = [path for path in sorted(pymeshlab.rglob("*.so*")) if path.is_file()]
    missing = symbols(libraries, "undefined") - symbols(libraries, "defined")
    names = sorted(name for name in missing if _GL.fullmatch(name))
    text = "".join(f"long {name}(void) {{ return 0; }}\n" for name in names)
    return {"libGL.so.1": text, "libOpenGL.so.0": text, "libcom_err.so.2": _COM_ERR}


def make(pymeshlab: Path, folder: Path) -> None:
    """Compiles them into the folder, as stand_in_NAME."""
    for name, text in sources(pymeshlab).items():
        with tempfile.TemporaryDirectory() as work:
            source = Path(work) / "source.c"
            source.write_text(text)
            subprocess.run(
                ["cc", "-shared", "-fPIC", "-O1", "-s", "-nostdlib", f"-Wl,-soname,{name}",
                 "-o", folder / f"stand_in_{name.partition('.')[0]}.so", source],
                check=True,
            )  # fmt: skip


if __name__ == "__main__":
    make(*map(Path, sys.argv[1:]))
