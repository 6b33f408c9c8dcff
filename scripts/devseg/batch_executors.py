"""Where the tasks of a batch run: in workers of this machine, or on a Dask cluster."""

from __future__ import annotations

import contextlib
import functools
import queue
import threading
from collections.abc import Iterator, Sequence
from concurrent.futures import ThreadPoolExecutor, as_completed
from typing import Any

from devseg.batch_store import Record
from devseg.batch_task import Task, lost
from devseg.batch_worker import Worker
from devseg.errors import DevsegError


def run_here(tasks: Sequence[Task], jobs: int) -> Iterator[Record]:
    """Does the tasks in so many workers; the records, in the order in which they are ready."""
    workers = [Worker() for _ in range(jobs)]
    free: queue.SimpleQueue[Worker] = queue.SimpleQueue()
    for worker in workers:
        free.put(worker)

    def run(task: Task) -> Record:
        worker = free.get()
        try:
            return worker.run(task)
        finally:
            free.put(worker)

    pool = ThreadPoolExecutor(jobs)
    try:
        for future in as_completed([pool.submit(run, task) for task in tasks]):
            yield future.result()
    finally:
        # After a failure nothing new begins, and nobody waits for what is at work.
        pool.shutdown(wait=False, cancel_futures=True)
        for worker in workers:
            worker.close()
        pool.shutdown()


def run_on_dask(tasks: Sequence[Task], jobs: int, address: str) -> Iterator[Record]:
    """Does the tasks on a cluster, whose machines share the folders of inputs and results.

    Args:
        tasks: the tasks.
        jobs: workers of the cluster that is started where there is no address.
        address: of a scheduler, such as tcp://host:8786; empty: a cluster on this machine.

    Raises:
        DevsegError: without Dask, and without an answer from the address.
    """
    try:
        import distributed
    except ImportError as error:
        raise DevsegError(
            "--executor dask needs Dask, which is not installed; pip install 'devseg[cluster]'"
        ) from error
    with contextlib.ExitStack() as stack:
        cluster: Any = address
        if not address:
            # Our own limits are kept by the processes of the meshes.
            cluster = stack.enter_context(
                distributed.LocalCluster(
                    n_workers=jobs,
                    threads_per_worker=1,
                    dashboard_address=None,
                    memory_limit=0,
                    silence_logs=50,
                )
            )
        try:
            client = stack.enter_context(distributed.Client(cluster, set_as_default=False))
        except (OSError, ValueError) as error:
            raise DevsegError(
                f"--executor dask: no scheduler answers at {address} ({error}); start one with "
                "dask scheduler, or leave the address out"
            ) from error
        futures = {
            client.submit(_run_there, task, key=f"{task.name}-{task.key}", pure=False): task
            for task in tasks
        }
        try:
            for future in distributed.as_completed(futures, loop=client.loop):
                try:
                    yield future.result()
                except distributed.KilledWorker:
                    yield lost(futures[future])
        finally:
            client.cancel(list(futures))


_of_thread = threading.local()


def _run_there(task: Task) -> Record:
    """In a worker of the cluster, each of whose threads keeps a worker of ours."""
    if not hasattr(_of_thread, "worker"):
        _of_thread.worker = Worker()
    worker: Worker = _of_thread.worker
    return worker.run(task)


def executor(name: str, jobs: int) -> functools.partial[Iterator[Record]]:
    """A function of the tasks, for the words of --executor: local, dask, dask:ADDRESS."""
    kind, _, address = name.partition(":")
    if kind == "dask":
        return functools.partial(run_on_dask, jobs=jobs, address=address)
    return functools.partial(run_here, jobs=jobs)
