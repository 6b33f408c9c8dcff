"""The folder of a batch: results that are whole or absent, and records from which it goes on.

    manifest.json       the options and the inputs, the same from every rank
    meshes/NAME/        the files of `devseg run`
    pictures/NAME.png   small, for the report
    records/NAME.json   how a mesh ended; written last
    .work/              what is unfinished, one folder for each process

NAME is the name of the input with its extension and its folders. Every step is a rename, so that
several machines can share the folder and any of them may be killed at any time.
"""

from __future__ import annotations

import contextlib
import json
import os
import shutil
import socket
import tempfile
from collections.abc import Iterator, Sequence
from pathlib import Path
from typing import Any

from devseg.errors import DevsegError
from devseg.outputs import to_json

Record = dict[str, Any]


class Store:
    """The folder, wherever it is looked at from."""

    def __init__(self, root: Path) -> None:
        self.root = root
        self._work = root / ".work"

    def files(self, name: str) -> Path:
        """The folder of the files of a mesh."""
        return self.root / "meshes" / name

    def picture(self, name: str) -> Path:
        """The small picture of a mesh."""
        return self.root / "pictures" / f"{name}.png"

    def _record(self, name: str) -> Path:
        return self.root / "records" / f"{name}.json"

    def record(self, name: str) -> Record | None:
        """How a mesh ended; None where it did not yet."""
        try:
            found: Record = json.loads(self._record(name).read_text(encoding="utf-8"))
        except FileNotFoundError:
            return None
        return found

    def records(self, names: Sequence[str]) -> list[Record | None]:
        """Those of all meshes, in the same order."""
        return [self.record(name) for name in names]

    def write(self, file: str, text: str) -> None:
        """Writes a text at once, or not at all."""
        with self.working() as folder:
            (folder / "text").write_text(text, encoding="utf-8")
            _move(folder / "text", self.root / file)

    def read_manifest(self) -> dict[str, Any]:
        """The options and the inputs.

        Raises:
            DevsegError: where the folder holds no batch.
        """
        try:
            text = (self.root / "manifest.json").read_text(encoding="utf-8")
        except OSError as error:
            raise DevsegError(
                f"{self.root}: expected the folder of a batch, found no manifest.json; check -o DIR"
            ) from error
        found: dict[str, Any] = json.loads(text)
        return found

    @contextlib.contextmanager
    def working(self) -> Iterator[Path]:
        """A folder on the same disk for unfinished files, which goes with the block.

        Raises:
            DevsegError: where nothing can be written.
        """
        try:
            folder = self._new_folder()
        except OSError as error:
            raise DevsegError(
                f"cannot write into {self.root} ({error.strerror}); choose another -o DIR"
            ) from error
        try:
            yield folder
        finally:
            shutil.rmtree(folder, ignore_errors=True)

    def _new_folder(self) -> Path:
        prefix = f"{socket.gethostname()}+{os.getpid()}+"
        while True:
            self._work.mkdir(parents=True, exist_ok=True)
            # Another rank may have ended and swept in between.
            with contextlib.suppress(FileNotFoundError):
                return Path(tempfile.mkdtemp(prefix=prefix, dir=self._work))

    def publish(self, record: Record, made: Path) -> None:
        """Puts the result of a mesh in the place of what is there.

        Args:
            record: how it ended.
            made: a working folder with the folder `files` and `small.png`, or without them.
        """
        name = record["mesh"]
        # Without a record the mesh is run again, whatever else a process that is killed leaves.
        self._record(name).unlink(missing_ok=True)
        for source, target in (
            (made / "files", self.files(name)),
            (made / "small.png", self.picture(name)),
        ):
            if target.exists():
                target.rename(made / f"old-{source.name}")
            if source.exists():
                _move(source, target)
        (made / "record").write_text(to_json(record), encoding="utf-8")
        _move(made / "record", self._record(name))

    def sweep(self) -> None:
        """Removes what killed processes of this machine have left."""
        if not self._work.is_dir():
            return
        for folder in self._work.iterdir():
            host, _, rest = folder.name.partition("+")
            pid = rest.partition("+")[0]
            if host == socket.gethostname() and not _runs(int(pid)):
                shutil.rmtree(folder, ignore_errors=True)
        with contextlib.suppress(OSError):  # others are at work
            self._work.rmdir()


def _runs(pid: int) -> bool:
    # One that nobody has waited for has ended all the same.
    with contextlib.suppress(OSError):
        state = Path(f"/proc/{pid}/stat").read_text().rpartition(")")[2].split()[0]
        return state not in "ZX"
    return False


def _move(source: Path, target: Path) -> None:
    target.parent.mkdir(parents=True, exist_ok=True)
    source.replace(target)
