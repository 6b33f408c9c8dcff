"""`devseg batch`: thousands of meshes, each in a process of its own, on one machine or on many."""

from __future__ import annotations

import itertools
import os
import time
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path

from devseg.apart import NO_LIMITS, Limits, ended_by_signals
from devseg.batch_executors import executor
from devseg.batch_report import write_report
from devseg.batch_store import Record, Store
from devseg.batch_task import Task, batch_key, fingerprint, option_values, task_key
from devseg.errors import DevsegError
from devseg.outputs import to_json
from devseg.pipeline import RunOptions

# What is looked for in folders.
EXTENSIONS = (".obj", ".ply", ".stl", ".off", ".gltf", ".glb", ".3ds", ".dae", ".3mf")


@dataclass(frozen=True)
class BatchOptions:
    """What `devseg batch` is to do.

    Attributes:
        run: with every mesh; its folder is that of the batch.
        limits: of every mesh.
        jobs: meshes at a time.
        rank: of this process, from 0.
        world_size: how many processes share the meshes.
        executor: local, dask or dask:ADDRESS.
        keep: whether the files are kept, beside figures and small pictures.
    """

    run: RunOptions
    limits: Limits = NO_LIMITS
    jobs: int = 1
    rank: int = 0
    world_size: int = 1
    executor: str = "local"
    keep: bool = True


@dataclass(frozen=True)
class Step:
    """A mesh that has just ended, and how the work stands.

    Attributes:
        record: how it ended.
        done: meshes that this process has done.
        all: meshes that it has to do, without those that were finished before.
        rate: meshes each second.
        seconds_left: as far as the rate tells.
    """

    record: Record
    done: int
    all: int
    rate: float
    seconds_left: float


def find_inputs(paths: Sequence[Path]) -> dict[str, Path]:
    """The meshes of files and folders by name, sorted; a name is a path below all of them.

    Raises:
        DevsegError: where there are none.
    """
    found: set[Path] = set()
    tops: set[Path] = set()
    for path in map(Path.absolute, paths):
        if not path.is_dir():
            found.add(path)
            tops.add(path.parent)
            continue
        tops.add(path)
        found.update(f for f in path.rglob("*") if f.suffix.lower() in EXTENSIONS and f.is_file())
    if not found:
        raise DevsegError(
            f"expected meshes ({', '.join(e[1:] for e in EXTENSIONS)}) in "
            f"{', '.join(map(str, paths))}, found none"
        )
    top = Path(os.path.commonpath(tops))
    return {path.relative_to(top).as_posix(): path for path in sorted(found)}


def slurm_rank(environment: Mapping[str, str]) -> tuple[int, int] | None:
    """Rank and world size of a job array of SLURM; None outside of one."""
    if "SLURM_ARRAY_TASK_ID" not in environment:
        return None
    values = {
        name: int(environment.get(f"SLURM_ARRAY_TASK_{name}", default))
        for name, default in (("ID", ""), ("MIN", "0"), ("STEP", "1"), ("COUNT", "1"))
    }
    return (values["ID"] - values["MIN"]) // values["STEP"], values["COUNT"]


def run_batch(
    inputs: Mapping[str, Path], options: BatchOptions, tell: Callable[[Step], None]
) -> list[Record | None]:
    """Does what is left to do of this rank's share, and writes the report of all ranks.

    Args:
        inputs: files by name, the same ones for every rank.
        options: what to do with them.
        tell: called after each mesh.

    Returns:
        The records of all inputs; None for those that other ranks have not done yet.

    Raises:
        DevsegError: where nothing can be run or written.
    """
    store = Store(options.run.out)
    programs = fingerprint()
    batch = batch_key(options.run, programs)
    store.sweep()
    manifest = {
        "batch": batch,
        "options": option_values(options.run),
        "inputs": sorted(inputs),
    }
    store.write("manifest.json", to_json(manifest))
    with ended_by_signals():
        mine = itertools.islice(sorted(inputs), options.rank, None, options.world_size)
        tasks = [
            Task(
                name,
                inputs[name],
                options.run.out.absolute(),
                options.run,
                options.limits,
                programs,
                batch,
                task_key(inputs[name], batch),
                options.keep,
            )
            for name in mine
        ]
        left = [task for task in tasks if not task.is_done(store.record(task.name))]
        for step in _steps(left, options):
            tell(step)
    records = write_report(store)
    store.sweep()
    return records


def _steps(tasks: Sequence[Task], options: BatchOptions) -> Iterator[Step]:
    start = time.monotonic()
    run = executor(options.executor, min(options.jobs, max(len(tasks), 1)))
    for done, record in enumerate(run(tasks) if tasks else (), start=1):
        rate = done / max(time.monotonic() - start, 1e-9)
        yield Step(record, done, len(tasks), rate, (len(tasks) - done) / rate)
