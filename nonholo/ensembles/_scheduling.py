"""All blocks of a sweep by a scheduler of Dask, on this machine or on a cluster."""

import functools
import itertools
import multiprocessing
import os
import signal
import threading
from collections.abc import Callable, Iterator
from concurrent.futures import Executor, ProcessPoolExecutor, ThreadPoolExecutor
from concurrent.futures.process import BrokenProcessPool
from typing import Any

from nonholo.base.checks import count, error, shown
from nonholo.ensembles._blocks import Done, Work, do_block
from nonholo.ensembles._cluster import check_client, check_cluster, do_on_cluster, is_client

_WAVE = 1024  # blocks of which a scheduler knows at once
_LOCAL = ("threads", "processes", "synchronous")

Take = Callable[[Done], None]


def checked_scheduler(scheduler: Any, workers: Any) -> tuple[Any, int | None]:
    """Return the scheduler by name, address or client; one that does not answer is refused, as is a missing extra."""
    where = "sweep(scheduler=...)"
    name = "threads" if scheduler is None else scheduler
    if not (is_client(name) or (isinstance(name, str) and (name in _LOCAL or "://" in name))):
        remedy = "Choose one of them, or leave it out for threads."
        requirement = f"be one of {', '.join(_LOCAL)} or an address tcp://host:port, or a distributed.Client"
        raise error(where, requirement, shown(scheduler), remedy)
    if _is_remote(name):
        if workers is not None:
            remedy = "Leave it out: a cluster has the workers that were started for it."
            got = f"{shown(workers)} for {name}"
            raise error("sweep(workers=...)", "come with threads or processes", got, remedy)
        (check_client if is_client(name) else check_cluster)(name)
    return name, None if workers is None else count("sweep(workers=...)", workers, "Pass how many work at a time.")


def _is_remote(scheduler: Any) -> bool:
    return is_client(scheduler) or "://" in scheduler


def do_all(work: Work, scheduler: Any, workers: int | None, take: Take) -> None:
    """Do every block; what becomes of each is taken as soon as it is known, in the thread of the caller."""
    blocks = iter(range(work.store.layout.blocks))
    if _is_remote(scheduler):
        return do_on_cluster(work, blocks, scheduler, take)
    return _here(work, blocks, scheduler, workers, take)


def _here(work: Work, blocks: Iterator[int], scheduler: str, workers: int | None, take: Take) -> None:
    import dask
    from dask.system import CPU_COUNT

    def report(_key: Any, result: Any, *_: Any) -> None:
        take(result)

    one = dask.delayed(functools.partial(do_block, work), name="block", pure=False, traverse=False)  # pyright: ignore
    pool = _pool(scheduler, workers or CPU_COUNT)
    options = {} if pool is None else {"pool": pool}
    options |= {"chunksize": 1, "callbacks": [(None, None, None, report, None)]}  # of this call, not of all of Dask
    try:
        while wave := [one(block) for block in itertools.islice(blocks, _WAVE)]:
            dask.compute(*wave, scheduler=scheduler, optimize_graph=False, traverse=False, **options)  # pyright: ignore
    except BrokenProcessPool as failure:
        reason = "A worker process was killed, ran out of memory, or could not start (scripts need a __main__ guard)"
        raise ChildProcessError(reason) from failure
    finally:
        if pool is not None:
            pool.shutdown(wait=True, cancel_futures=True)


def _pool(scheduler: str, workers: int) -> Executor | None:
    if scheduler == "processes":
        return ProcessPoolExecutor(workers, multiprocessing.get_context("spawn"), _begin_worker)
    return ThreadPoolExecutor(workers) if scheduler == "threads" else None


def _begin_worker() -> None:
    """Let a worker process end with its client, which may be killed, and leave Ctrl-C to it."""
    signal.signal(signal.SIGINT, signal.SIG_IGN)
    threading.Thread(target=_end_with, args=(multiprocessing.parent_process(),), daemon=True).start()


def _end_with(client: Any) -> None:
    client.join()
    os._exit(1)
