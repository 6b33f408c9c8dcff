"""One mesh of a batch: what is to be done, doing it, and what is kept of it."""

from __future__ import annotations

import dataclasses
import functools
import hashlib
import json
import shutil
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from devseg.apart import Crashed, Limits, OverMemory, OverTime, Tell, run_watched
from devseg.batch_store import Record, Store
from devseg.errors import DevsegError, one_line
from devseg.pipeline import RunOptions, process, versions
from devseg.plugins import plugin_paths

# How a mesh ends. One that was not reached yet is MISSING in the report.
PATTERN, REFUSED, CRASHED = "pattern", "refused", "crashed"
OVER_TIME, OVER_MEMORY, MISSING = "over time", "over memory", "not run yet"
ENDINGS = (PATTERN, REFUSED, CRASHED, OVER_TIME, OVER_MEMORY, MISSING)

# The version of Python shapes nothing: machines of a cluster may differ in it.
_SHAPING = ("devseg", "pymeshlab", "numpy", "pillow")

# Pixels of the small pictures' sides, of those of the pictures.
_SMALLER = 4


@dataclass(frozen=True)
class Task:
    """A mesh to be done.

    Attributes:
        name: of the mesh within the batch.
        path: of its file.
        out: folder of the batch.
        options: of `devseg run`.
        limits: of its process.
        fingerprint: of the programs that shall do it.
        batch: of the options and the programs.
        key: of all that shapes the result; a record with the same key is finished.
        keep: whether the files are kept, beside figures and a small picture.
    """

    name: str
    path: Path
    out: Path
    options: RunOptions
    limits: Limits
    fingerprint: str
    batch: str
    key: str
    keep: bool = True

    def is_done(self, record: Record | None) -> bool:
        """Whether this is the record of the same task."""
        if record is None or record["key"] != self.key:
            return False
        within = record["ending"] not in (OVER_TIME, OVER_MEMORY)
        return within or record["limits"] == dataclasses.asdict(self.limits)


@functools.cache
def fingerprint() -> str:
    """Of the programs that shape results here: versions, and the very plugins."""
    digest = hashlib.sha256()
    found = versions()
    digest.update(json.dumps({name: found[name] for name in _SHAPING}).encode())
    for path in plugin_paths():
        digest.update(path.read_bytes())
    return digest.hexdigest()


def option_values(options: RunOptions) -> dict[str, Any]:
    """The options as plain data, without the folder."""
    values = dataclasses.asdict(options)
    del values["out"]
    plain: dict[str, Any] = json.loads(json.dumps(values, default=str))
    return plain


def batch_key(options: RunOptions, programs: str) -> str:
    """Of the options and the programs."""
    text = json.dumps(option_values(options), sort_keys=True) + programs
    return hashlib.sha256(text.encode()).hexdigest()[:32]


def task_key(path: Path, batch: str) -> str:
    """Of a file's content and of its batch."""
    digest = hashlib.sha256(batch.encode())
    try:
        with path.open("rb") as file:
            while block := file.read(1 << 20):
                digest.update(block)
    except OSError as error:  # running it will tell
        digest.update(type(error).__name__.encode())
    return digest.hexdigest()[:32]


def run_task(task: Task) -> Record:
    """Does a task in a child process, publishes its result and returns its record.

    Raises:
        DevsegError: where the programs here are not those that the batch began with.
        OSError: for a full disk and the like, which is no fault of the mesh.
    """
    if fingerprint() != task.fingerprint:
        raise DevsegError(
            "expected the same devseg, pymeshlab, numpy and pillow as where the batch was started, "
            f"found others ({versions()}); install the same ones on all machines"
        )
    store = Store(task.out)
    with store.working() as folder:
        ended = run_watched(task.name, lambda tell: _work(task, folder, tell), task.limits)
        if isinstance(ended.error, OSError):
            raise ended.error
        outcome = _failure(task, ended.error) if ended.error else ended.result
        record = {
            **_identity(task),
            **(outcome or {}),
            "seconds": round(ended.seconds, 3),
            "cpu_seconds": round(ended.cpu_seconds, 3),
            "memory_mb": round(ended.memory / 2**20),
        }
        if ended.error or not task.keep:
            shutil.rmtree(folder / "files", ignore_errors=True)
        store.publish(record, folder)
    return record


def lost(task: Task) -> Record:
    """The record of a task whose worker ended with it, again and again."""
    store = Store(task.out)
    record = {
        **_identity(task),
        "ending": CRASHED,
        "reason": "its worker was ended by the system, most likely for lack of memory; take fewer "
        "--jobs, or set --memory",
        "warnings": [],
    }
    with store.working() as folder:
        store.publish(record, folder)
    return record


def _identity(task: Task) -> Record:
    return {
        "mesh": task.name,
        "batch": task.batch,
        "key": task.key,
        "limits": dataclasses.asdict(task.limits),
    }


def _work(task: Task, folder: Path, tell: Tell) -> Record:
    files = folder / "files"
    files.mkdir()
    result = process(task.path, task.options, files, tell)
    if task.options.picture:
        from PIL import Image

        with Image.open(files / result["outputs"]["png"]) as image:
            small = image.reduce(_SMALLER).convert("P", palette=Image.Palette.ADAPTIVE, colors=64)
            small.save(folder / "small.png")
    return {
        "ending": PATTERN,
        "reason": "",
        "warnings": [_plain_words(task, text) for text in result["warnings"]],
        **figures(result),
    }


def figures(result: dict[str, Any]) -> dict[str, Any]:
    """What a report shows of NAME.json."""
    flat = result["parametrization"]
    return {
        "faces": result["mesh"]["faces"],
        "charts": flat["charts_number"],
        "disks": flat["disk_charts_number"],
        "l2": flat["l2_stretch"],
        "linf": flat["linf_stretch"],
        "worst_chart_l2": max(flat["chart_l2_stretch"], default=None),
        "seam_length": flat["seam_length"],
        "flipped": flat["flipped_faces_number"],
        "overlapping": flat["overlapping_faces_number"],
        "packing": flat["packing_efficiency"],
        "size_mm": result["size_mm"],
        "stages": result["seconds"],
    }


def _failure(task: Task, error: BaseException) -> Record:
    endings = {Crashed: CRASHED, OverTime: OVER_TIME, OverMemory: OVER_MEMORY}
    if isinstance(error, DevsegError):
        ending, text = endings.get(type(error), REFUSED), str(error)
    else:
        ending, text = CRASHED, f"unexpected {type(error).__name__}: {error}"
    return {"ending": ending, "reason": _plain_words(task, text), "warnings": []}


def _plain_words(task: Task, text: str) -> str:
    """A message without the folder of the mesh, which is another one on every machine."""
    text = one_line(text).replace(str(task.path), task.name)
    return text.removeprefix(f"{task.name}: ")
