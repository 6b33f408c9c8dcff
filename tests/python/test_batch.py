"""Thousands of meshes: workers, records, resuming, shards, Dask and the report."""

from __future__ import annotations

import concurrent.futures
import csv
import json
import os
import random
import re
import signal
import socket
import subprocess
import sys
import time
from collections.abc import Callable, Iterator
from pathlib import Path
from types import ModuleType, SimpleNamespace

import pytest

import meshes
from conftest import ROOT
from devseg import batch, batch_cli, batch_task
from devseg.apart import Crashed, Limits, OverMemory, OverTime, run_watched
from devseg.batch import BatchOptions, Step, find_inputs, run_batch, slurm_rank
from devseg.batch_executors import run_here, run_on_dask
from devseg.batch_report import summary
from devseg.batch_store import Store
from devseg.batch_task import CRASHED, OVER_TIME, PATTERN, REFUSED, Task
from devseg.batch_worker import Worker
from devseg.cli import main
from devseg.errors import DevsegError
from devseg.methods import METHODS
from devseg.pipeline import RunOptions
from devseg.progress import CLEAR_LINE

REPORT = ("report.csv", "index.html")


@pytest.fixture
def folder(tmp_path: Path) -> Path:
    """Five small meshes in two folders, and one that is broken."""
    top = tmp_path / "meshes"
    for k in range(5):
        one = top / f"part {k % 2}" / f"{k}.obj"
        one.parent.mkdir(parents=True, exist_ok=True)
        meshes.write_obj(one, *meshes.cylinder(height=1 + k, around=8 + k, along=3))
    (top / "broken <b>.obj").write_text("v 0 0 0\nf 1 2 9\n")
    return top


def run_options(out: Path, picture: bool = False, **segmentation: object) -> RunOptions:
    method = METHODS["dcharts"]
    flatten = "symmetric-dirichlet"
    return RunOptions(out, method, segmentation, flatten, ("svg",), {}, picture=picture)


def options(out: Path, picture: bool = False, **others: object) -> BatchOptions:
    return BatchOptions(run_options(out, picture), Limits(100), **others)


def report(out: Path) -> list[bytes]:
    return [(out / name).read_bytes() for name in REPORT]


def quiet(_: Step) -> None:
    """Nobody watches."""


def test_a_batch_has_a_result_a_record_and_a_picture_of_each_mesh(
    folder: Path, tmp_path: Path
) -> None:
    out = tmp_path / "out"
    steps: list[Step] = []
    records = run_batch(find_inputs([folder]), options(out, True, jobs=2), steps.append)
    names = [f"part {k % 2}/{k}.obj" for k in (0, 2, 4, 1, 3)]
    assert [r["mesh"] for r in records] == ["broken <b>.obj", *names]
    assert [r["ending"] for r in records] == [REFUSED, *[PATTERN] * 5]
    assert records[0]["reason"].startswith("face in line 2 names vertex 2")
    assert str(folder) not in json.dumps(records)
    assert sorted(step.done for step in steps) == list(range(1, 7))
    assert all(step.all == 6 and step.rate > 0 for step in steps) and steps[-1].seconds_left == 0
    for name in names:
        stem = Path(name).stem
        kinds = ("json", "png", "svg")
        files = sorted(p.name for p in Store(out).files(name).iterdir())
        assert files == [f"{stem}.{kind}" for kind in kinds]
        assert Store(out).picture(name).stat().st_size < 30000
    assert not Store(out).files("broken <b>.obj").exists() and not (out / ".work").exists()
    with (out / "report.csv").open() as file:
        rows = list(csv.DictReader(file))
    assert [row["mesh"] for row in rows] == [r["mesh"] for r in records]
    assert float(rows[1]["l2"]) == records[1]["l2"] and rows[0]["charts"] == ""
    with (out / "times.csv").open() as file:
        assert all(float(row["seconds"]) > 0 for row in csv.DictReader(file))
    assert summary(records).startswith("6 meshes: 5 patterns, 1 refused, median charts ")

    check_page(out)


def check_page(out: Path) -> None:
    """Names stand there as they are, and nothing comes from elsewhere."""
    page = (out / "index.html").read_text()
    assert "broken &lt;b&gt;.obj" in page and "broken <b>" not in page
    for link in re.findall(r'(?:src|href)="([^"]+)"', page):
        assert (out / link.replace("%20", " ")).exists(), link
    rows = [json.loads(row.replace("&quot;", '"')) for row in re.findall(r'data-row="(.*?)"', page)]
    assert len(rows) == 6 and all(row["charts"] >= 1 for row in rows[1:])
    assert not re.search(r"<!--[A-Z]+-->", page)


def test_jobs_ranks_and_order_change_no_byte_of_the_report(folder: Path, tmp_path: Path) -> None:
    inputs = find_inputs([folder])
    run_batch(inputs, options(tmp_path / "one"), quiet)
    run_batch(inputs, options(tmp_path / "two", jobs=2), quiet)
    for rank in (2, 0, 1):
        shard = options(tmp_path / "three", rank=rank, world_size=3)
        seen = run_batch(dict(reversed(inputs.items())), shard, quiet)
        assert sum(r is None for r in seen) == {2: 4, 0: 2, 1: 0}[rank]
        if rank == 2:
            assert "not run yet" in (tmp_path / "three" / "report.csv").read_text()
    assert report(tmp_path / "one") == report(tmp_path / "two") == report(tmp_path / "three")


def test_only_what_changed_is_run_again(folder: Path, tmp_path: Path) -> None:
    out = tmp_path / "out"

    def ran(chosen: BatchOptions) -> list[str]:
        steps: list[Step] = []
        run_batch(find_inputs([folder]), chosen, steps.append)
        return sorted(step.record["mesh"] for step in steps)

    assert len(ran(options(out))) == 6
    before = report(out)
    assert ran(options(out, jobs=2)) == [] and report(out) == before
    changed = folder / "part 0" / "2.obj"
    meshes.write_obj(changed, *meshes.cube())
    assert ran(options(out)) == ["part 0/2.obj"] and report(out) != before
    (out / "records" / "part 1" / "1.obj.json").unlink()
    assert ran(options(out)) == ["part 1/1.obj"]
    other = BatchOptions(run_options(out, charts_number=4), Limits(100))
    assert len(ran(other)) == 6 and ran(other) == []


def task(path: Path, out: Path, limits: Limits = Limits(100)) -> Task:  # noqa: B008
    return Task(
        path.name, path, out, options(out).run, limits, batch_task.fingerprint(), "batch", "key"
    )


def test_a_crash_is_told_and_the_next_mesh_is_done(
    folder: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    def crash(*_: object) -> None:
        os.kill(os.getpid(), signal.SIGSEGV)

    one = task(folder / "part 0" / "0.obj", tmp_path / "out")
    with monkeypatch.context() as patch:
        patch.setattr(batch_task, "process", crash)
        record = batch_task.run_task(one)
    assert record["ending"] == CRASHED and "crashed with SIGSEGV" in record["reason"]
    assert Store(one.out).record(one.name) == record and not Store(one.out).files(one.name).exists()
    assert batch_task.run_task(one)["ending"] == PATTERN


def test_a_mesh_over_its_limit_is_run_again_with_another_limit(
    folder: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    def wait(*_: object) -> None:
        time.sleep(60)

    one = task(folder / "part 0" / "0.obj", tmp_path / "out", Limits(0.1))
    with monkeypatch.context() as patch:
        patch.setattr(batch_task, "process", wait)
        record = batch_task.run_task(one)
    assert record["ending"] == OVER_TIME and "took more than 0.1 s" in record["reason"]
    assert one.is_done(record)
    assert not task(one.path, one.out, Limits(10)).is_done(record)


def test_a_full_disk_is_no_fault_of_the_mesh(
    folder: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    def fail(*_: object) -> None:
        raise OSError(28, "No space left on device", "a.svg")

    one = task(folder / "part 0" / "0.obj", tmp_path / "out")
    monkeypatch.setattr(batch_task, "process", fail)
    with pytest.raises(OSError, match="No space"):
        batch_task.run_task(one)
    assert Store(one.out).record(one.name) is None


WORK = {
    "endless": ("while True: pass", OverTime),
    "waiting": ("import time; time.sleep(99)", OverTime),
    "hungry": ("a = bytearray(1 << 29); import time; time.sleep(9)", OverMemory),
    "crash": ("import os; os.abort()", Crashed),
}


@pytest.mark.parametrize("name", WORK)
def test_limits_end_the_work(name: str) -> None:
    code, error = WORK[name]
    start = time.monotonic()
    # The memory of pytest itself counts, as it is the child's as well.
    ended = run_watched("a", lambda _: exec(code), Limits(0.5, (1 << 29)))
    assert type(ended.error) is error and ended.result is None
    assert time.monotonic() - start < 20
    if name == "endless":
        assert ended.cpu_seconds > 0.4
    if name == "hungry":
        assert ended.memory > 1 << 29


def test_work_within_its_limits_tells_what_it_used() -> None:
    ended = run_watched("a", lambda _: sum(range(10**6)), Limits(100, 1 << 34))
    assert ended.result == 499999500000 and ended.error is None
    assert 0 < ended.cpu_seconds < 100 and ended.memory > 1 << 20


@pytest.fixture
def worker() -> Iterator[Worker]:
    one = Worker()
    yield one
    one.close()


def test_a_worker_is_kept_and_replaced_where_it_ends(
    folder: Path, tmp_path: Path, worker: Worker
) -> None:
    one = task(folder / "part 0" / "0.obj", tmp_path / "out")
    worker.run(one)
    first = worker._process.pid
    worker.run(one)
    assert worker._process.pid == first
    worker._process.kill()
    assert worker.run(one)["ending"] == PATTERN
    assert worker._process.pid != first


def test_other_programs_refuse_the_work(folder: Path, tmp_path: Path, worker: Worker) -> None:
    path = folder / "part 0" / "0.obj"
    other = Task(path.name, path, tmp_path, options(tmp_path).run, Limits(9), "other", "b", "key")
    with pytest.raises(DevsegError, match="expected the same devseg"):
        worker.run(other)


@pytest.fixture
def command(monkeypatch: pytest.MonkeyPatch) -> Callable[..., list[str]]:
    """A command line of its own process."""
    monkeypatch.setenv("PYTHONPATH", str(ROOT / "scripts"))
    return lambda *words: [sys.executable, "-m", "devseg", *map(str, words)]


def test_a_batch_that_is_killed_goes_on(
    folder: Path, tmp_path: Path, command: Callable[..., list[str]]
) -> None:
    whole, out = tmp_path / "whole", tmp_path / "out"
    run_batch(find_inputs([folder]), options(whole, jobs=2), quiet)
    random.seed(7)
    kills = int(os.environ.get("DEVSEG_BATCH_KILLS", "3"))
    for kill in range(kills):
        words = command("batch", folder, "-o", out, "--jobs", 2, "--formats", "svg")
        words += ["--timeout", "100", "--seams", "edges", "--no-picture"]
        process = subprocess.Popen(
            words, stderr=subprocess.PIPE, stdout=subprocess.DEVNULL, start_new_session=True
        )
        if kill % 3:  # else at any time, before the first mesh is done as well
            process.stderr.readline()
        time.sleep(random.uniform(0, 0.5))
        os.killpg(process.pid, signal.SIGKILL)  # with its workers and their children
        process.wait()
        process.stderr.close()
        for name in (p.parent.name for p in out.glob("meshes/*/*/*.json")):
            found = next(out.glob(f"meshes/*/{name}"))
            assert len(list(found.iterdir())) == 2, "half a result"
    steps: list[Step] = []
    run_batch(find_inputs([folder]), options(out, jobs=2), steps.append)
    assert len(steps) < 6, "nothing of what was finished is done again"
    assert report(out) == report(whole)
    assert not (out / ".work").exists()


def test_what_an_ended_process_has_left_is_swept_although_nobody_waited(tmp_path: Path) -> None:
    process = subprocess.Popen([sys.executable, "-c", ""])
    stat = Path(f"/proc/{process.pid}/stat")
    while stat.read_text().rpartition(")")[2].split()[0] != "Z":
        time.sleep(0.01)
    left = tmp_path / ".work" / f"{socket.gethostname()}+{process.pid}+a"
    at_work = tmp_path / ".work" / f"{socket.gethostname()}+{os.getpid()}+b"
    for folder in (left, at_work):
        folder.mkdir(parents=True)
    Store(tmp_path).sweep()
    process.wait()
    assert not left.exists()
    assert at_work.exists()


def test_an_interrupted_batch_ends_its_workers(
    folder: Path, tmp_path: Path, command: Callable[..., list[str]]
) -> None:
    out = tmp_path / "out"
    words = command("batch", folder, "-o", out, "--jobs", 2)
    process = subprocess.Popen(words, stderr=subprocess.PIPE, stdout=subprocess.PIPE, text=True)
    first = process.stderr.readline()
    assert re.match(r"1/6, \S+ a second, .* left: ", first)
    children = Path(f"/proc/{process.pid}/task/{process.pid}/children")
    workers = [
        int(pid)
        for one in Path(f"/proc/{process.pid}/task").iterdir()
        for pid in (one / "children").read_text().split()
    ]
    assert workers or not children.exists()
    process.send_signal(signal.SIGTERM)
    _, error = process.communicate(timeout=30)
    assert process.returncode == 1 and error.splitlines()[-1].startswith("devseg: error: interrup")
    assert "Traceback" not in error
    assert not any(Path(f"/proc/{pid}").exists() for pid in workers)


def test_nothing_is_lost_or_doubled_on_dask(folder: Path, tmp_path: Path) -> None:
    distributed = pytest.importorskip("distributed")
    out = tmp_path / "out"
    inputs = find_inputs([folder])
    tasks = [task(path, out) for path in inputs.values()]
    cluster = distributed.LocalCluster(
        n_workers=2, threads_per_worker=1, dashboard_address=None, memory_limit=0, silence_logs=50
    )
    with cluster:
        records = []
        for record in run_on_dask(tasks, 2, cluster.scheduler_address):
            if not records:
                os.kill(next(iter(cluster.workers.values())).pid, signal.SIGKILL)
            records.append(record)
    assert sorted(r["mesh"] for r in records) == sorted(path.name for path in inputs.values())
    assert sum(r["ending"] == PATTERN for r in records) == 5
    assert all(Store(out).record(r["mesh"]) is not None for r in records)


def test_an_executor_that_fails_starts_nothing_more(folder: Path, tmp_path: Path) -> None:
    good = task(folder / "part 0" / "0.obj", tmp_path)
    bad = Task(good.name, good.path, tmp_path, good.options, Limits(9), "other", "b", "key")
    with pytest.raises(DevsegError, match="expected the same devseg"):
        list(run_here([bad, *[good] * 5], 1))


def test_names_are_paths_below_all_inputs(folder: Path, tmp_path: Path) -> None:
    assert list(find_inputs([folder / "part 0" / "2.obj"])) == ["2.obj"]
    assert list(find_inputs([folder / "part 1", folder / "part 0" / "2.obj"])) == [
        "part 0/2.obj", *(f"part 1/{k}.obj" for k in (1, 3)),
    ]  # fmt: skip
    (tmp_path / "empty").mkdir()
    with pytest.raises(DevsegError, match="expected meshes"):
        find_inputs([tmp_path / "empty"])


def test_ranks_of_slurm() -> None:
    array = {f"SLURM_ARRAY_TASK_{k}": v for k, v in (("ID", "7"), ("MIN", "1"), ("COUNT", "4"))}
    assert slurm_rank({}) is None
    assert slurm_rank({**array, "SLURM_ARRAY_TASK_STEP": "2"}) == (3, 4)
    assert slurm_rank({"SLURM_ARRAY_TASK_ID": "0"}) == (0, 1)


def test_the_command_tells_how_many_have_no_pattern(
    folder: Path, tmp_path: Path, capfd: pytest.CaptureFixture[str]
) -> None:
    out = tmp_path / "out"
    words = ["batch", str(folder), "-o", str(out), "--formats", "ply", "--no-picture"]
    assert main([*words, "--json"]) == 1
    printed, error = capfd.readouterr()
    assert len(json.loads(printed)) == 6
    assert error.splitlines()[-1] == (
        "devseg: error: expected a pattern of every mesh, found 1 of 6 without one; "
        f"{out / 'index.html'} has the reasons"
    )
    (folder / "broken <b>.obj").unlink()
    assert main(words) == 0
    printed, error = capfd.readouterr()
    assert printed.startswith("5 meshes: 5 patterns, median charts") and error == ""


@pytest.mark.parametrize(
    ("words", "message"),
    [
        (["--rank", "0"], "--rank and --world-size go together"),
        (["--rank", "2", "--world-size", "2"], "expected a number from 0 to 1, found 2"),
        (["--jobs", "0"], "expected a whole number of at least 1"),
        (["--timeout", "0"], "expected a number above 0"),
        (["--executor", "ray"], "expected local, dask or dask:ADDRESS"),
        (["--list-objects"], "--list-objects does not apply"),
    ],
)
def test_wrong_usage(words: list[str], message: str, capfd: pytest.CaptureFixture[str]) -> None:
    with pytest.raises(SystemExit) as caught:
        main(["batch", "a.obj", "-o", "out", *words])
    assert caught.value.code == 2 and message in capfd.readouterr().err


def test_without_dask_the_extra_is_named(
    monkeypatch: pytest.MonkeyPatch, tmp_path: Path, folder: Path
) -> None:
    monkeypatch.setitem(sys.modules, "distributed", None)
    with pytest.raises(DevsegError, match=r"pip install 'devseg\[cluster\]'"):
        list(run_on_dask([task(folder / "part 0" / "0.obj", tmp_path)], 1, ""))


def test_a_folder_that_cannot_be_written_is_told(
    folder: Path, tmp_path: Path, fails: Callable[..., str]
) -> None:
    (tmp_path / "file").write_text("")
    assert "cannot write into" in fails("batch", folder, "-o", tmp_path / "file" / "out")


def test_modules_of_the_batch_need_no_host(pymeshlab: ModuleType) -> None:
    code = "import sys, devseg.batch, devseg.cli; print('numpy' in sys.modules)"
    done = subprocess.run(
        [sys.executable, "-c", code],
        env={**os.environ, "PYTHONPATH": str(ROOT / "scripts")},
        capture_output=True,
        text=True,
        check=True,
    )
    assert done.stdout.strip() == "False" and batch.EXTENSIONS


def test_a_mesh_that_ends_its_workers_is_told(
    folder: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    class KilledWorker(Exception):
        """As Dask has it."""

    class Client:
        """Answers every task but the first."""

        loop = None

        def __init__(self, address: str, **_: object) -> None:
            assert address == "tcp://there:8786"

        def __enter__(self) -> Client:
            return self

        def __exit__(self, *_: object) -> None:
            """Nothing to close."""

        def submit(self, function: Callable, one: Task, **_: object) -> concurrent.futures.Future:
            future: concurrent.futures.Future = concurrent.futures.Future()
            if one is tasks[0]:
                future.set_exception(KilledWorker())
            else:
                future.set_result(batch_task.run_task(one))
            return future

        def cancel(self, futures: list) -> None:
            assert len(futures) == 2

    stub = SimpleNamespace(
        Client=Client, KilledWorker=KilledWorker, as_completed=lambda futures, loop: list(futures)
    )
    monkeypatch.setitem(sys.modules, "distributed", stub)
    tasks = [task(folder / "part 0" / f"{k}.obj", tmp_path / "out") for k in (0, 2)]
    records = list(run_on_dask(tasks, 1, "tcp://there:8786"))
    assert [r["ending"] for r in records] == [CRASHED, PATTERN]
    assert "ended by the system" in Store(tmp_path / "out").record("0.obj")["reason"]


def test_on_a_terminal_one_line_is_written_again(
    monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.setattr(sys.stderr, "isatty", lambda: True, raising=False)
    show = batch_cli._Progress()
    show(Step({"mesh": "a", "ending": PATTERN, "charts": 3, "reason": ""}, 1, 9, 0.5, 16))
    show(Step({"mesh": "b", "ending": REFUSED, "reason": "no faces"}, 2, 9, 0.001, 7000))
    show.end()
    lines = capsys.readouterr().err.replace(CLEAR_LINE, "|").split("|")
    assert lines == [
        "",
        "1/9, 0.5 a second, 16 s left",
        "b: refused, no faces\n2/9, 0.001 a second, 1.9 h left, 1 without a pattern\n",
    ]
