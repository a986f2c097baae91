"""All blocks of a sweep by a scheduler of Dask, on this machine or on a cluster, and what a worker does with one."""

import asyncio
import contextlib
import errno
import functools
import itertools
import multiprocessing
import os
import pickle
import signal
import socket
import threading
import time
import warnings
from collections.abc import Callable, Iterator
from concurrent.futures import CancelledError, Executor, ProcessPoolExecutor, ThreadPoolExecutor
from concurrent.futures.process import BrokenProcessPool
from typing import Any, NamedTuple, TypeAlias

import numpy as np

from nonholo import io
from nonholo.base.checks import count, error, needs, shown
from nonholo.ensembles._names import OUTCOME
from nonholo.ensembles.designs import block_of
from nonholo.ensembles.stores import OUTCOMES, Mark, SweepStore, Task, attempt, attributes_of, store_of
from nonholo.simulation import in_one_thread


class Done(NamedTuple):
    """The report of a worker on a block: its mark, what was wrong with an older one, the versions it works with."""

    block: int
    mark: Mark
    damage: str | None
    versions: str


def do_block(sweep: SweepStore, task: Task, block: int) -> Done:
    """Make sure that a block is in the store, from which everything but the task is read."""
    store = store_of(sweep)
    mark = damage = None
    try:
        mark = None if store.blocks.mark(block) is None else store.blocks.sound(block).about
    except io.blocks.DamagedError as flaw:
        damage = str(flaw)
    piece, begin = store.layout.piece(block), time.perf_counter()
    if mark is not None and mark.members == piece.count:  # or the sweep has grown
        return Done(block, mark, None, io.provenance.versions_text())
    members, draws = block_of(store.design, piece.first, piece.count), store.design.drawn
    outputs = {name: output for name, output in store.outputs.items() if name not in draws}
    with in_one_thread():
        arrays, messages = attempt(task, members, outputs)
    seconds = time.perf_counter() - begin
    codes, counts = np.unique(arrays[OUTCOME], return_counts=True)
    names = (OUTCOMES.get(int(code), str(code)) for code in codes)  # a task may have outcomes of its own
    outcomes = dict(zip(names, counts.tolist(), strict=True))
    mark = Mark(piece.count, outcomes, seconds, time.time(), _writer(), messages)
    store.blocks.write(block, {name: members[name] for name in draws} | arrays, mark._asdict())
    return Done(block, mark, damage, io.provenance.versions_text())


def _writer() -> str:
    """Name this process."""
    return f"{socket.gethostname()}:{os.getpid()}"


Take: TypeAlias = Callable[[Done], None]
_AHEAD = 1024  # blocks of which the scheduler knows at once
_CONNECT = 10  # seconds
_PAUSE = 0.02  # seconds between looks for finished blocks
_PATIENCE = 5.0  # seconds without any, until workers are counted
_WHERE = "sweep(scheduler=...)"


def check_cluster(address: str) -> None:
    """Refuse an address at which no scheduler answers, before any work.

    Not by a client: one that cannot start is closed by the garbage collector, in any thread, and may block the next.
    """
    library = _library()

    async def answer() -> dict[str, Any]:
        async with library.rpc(address, timeout=_CONNECT) as remote:
            return await asyncio.wait_for(remote.identity(), _CONNECT)

    try:
        with ThreadPoolExecutor(1) as pool:  # the loop of a notebook runs in this thread
            kind = pool.submit(asyncio.run, answer()).result()["type"]
    except Exception as failure:  # whatever else listens there may answer anything
        raise _no_scheduler(f"{address}: {str(failure) or f'no answer in {_CONNECT} s'}") from None
    if kind != "Scheduler":
        raise _no_scheduler(f"{address}, a {kind.lower()}")


def is_client(scheduler: Any) -> bool:
    """Return whether a scheduler is the client of one, of the user's own."""
    return hasattr(scheduler, "scheduler_info") and hasattr(scheduler, "map")


def check_client(client: Any) -> None:
    """Refuse a client that is closed, or one of `async` code."""
    if client.status != "running" or client.asynchronous:
        got, remedy = f"one that is {client.status}", "Pass distributed.Client(...), or the address tcp://host:port."
        raise error(_WHERE, "be a client that is connected, and not asynchronous", got, remedy)


def do_on_cluster(work: tuple[SweepStore, Task], blocks: Iterator[int], scheduler: Any, take: Take) -> None:
    """Do every block by the scheduler at an address, or by that of a client, which stays open.

    A loss of the scheduler, or of workers again and again, is reported as what it is.
    """
    from distributed.comm.core import CommClosedError
    from distributed.scheduler import KilledWorker

    own, how = is_client(scheduler), {"timeout": _CONNECT, "set_as_default": False}
    with contextlib.nullcontext(scheduler) if own else _library().Client(scheduler, **how) as client:
        try:
            _do_blocks(work, blocks, client, take)
        except KilledWorker as failure:
            message = "Workers were killed, or ran out of memory, again and again at the same block"
            raise ChildProcessError(message) from failure
        except Exception as failure:
            if client.status == "running" and not isinstance(failure, CommClosedError | CancelledError):
                raise
            address = client.scheduler.address if own else scheduler
            raise ConnectionError(f"The connection to the scheduler at {address} was lost") from None


def _do_blocks(work: tuple[SweepStore, Task], blocks: Iterator[int], client: Any, take: Take) -> None:
    """Send a new block for each that is done, so that the scheduler never knows of all."""
    import cloudpickle

    # as bytes: a worker of Dask that cannot make a function of what it receives ends itself
    function = functools.partial(do_sent, cloudpickle.dumps(work))

    def send(count: int) -> list[Any]:
        return client.map(function, list(itertools.islice(blocks, count)), pure=False, key="block")

    running = _library().as_completed(send(_AHEAD), loop=client.loop)
    for batch in _batches(running, client):
        for future in batch:
            take(future.result())
        running.update(send(len(batch)))


def do_sent(work_bytes: bytes, block: int) -> Done:
    """Make sure that a block is in the store: the task of a worker."""
    return do_block(*_work_of(work_bytes), block)


@functools.lru_cache(maxsize=4)
def _work_of(work_bytes: bytes) -> tuple[SweepStore, Task]:
    """Return what was sent, once it is known that this worker can import the task and sees the store."""
    worker = _writer()
    try:
        store, task = pickle.loads(work_bytes)  # noqa: S301
    except (ImportError, AttributeError) as failure:
        remedy = "Install its module there, or define the function in the script that calls sweep."
        raise error("sweep(task=...)", "be importable by the workers", f"{failure} ({worker})", remedy) from None
    try:
        is_seen = attributes_of(store.path)["made"] == store.made
    except (OSError, ValueError):
        is_seen = False
    if not is_seen:
        message = f"The worker {worker} does not see this store: choose a path on a file system that all workers share"
        raise FileNotFoundError(errno.ENOENT, message, str(store.path))
    return store, task


def _batches(running: Any, client: Any) -> Iterator[list[Any]]:
    """Yield what is finished, as soon as it is; warn when there is nobody to do the rest."""
    last_time, has_warned = time.monotonic(), False
    while running.count():
        if running.has_ready():
            yield running.next_batch(block=False)
            last_time, has_warned = time.monotonic(), False
        elif not has_warned and time.monotonic() - last_time > _PATIENCE:
            last_time, has_warned = time.monotonic(), not client.ncores()
            if has_warned:
                address = client.scheduler.address
                text = f"The scheduler at {address} has no workers. The sweep waits for some: dask worker {address}"
                warnings.warn(text, RuntimeWarning, stacklevel=2)
        else:
            time.sleep(_PAUSE)


def _no_scheduler(got: str) -> ValueError:
    remedy = "Start `dask scheduler`, and workers by `dask worker ADDRESS`."
    return error(_WHERE, "be the address of a Dask scheduler", got, remedy)


def _library() -> Any:
    with needs("cluster", _WHERE):
        import distributed
    return distributed


_LOCAL = ("threads", "processes", "synchronous")


def checked_scheduler(scheduler: Any, workers: Any) -> tuple[Any, int | None]:
    """Return the scheduler by name, address or client; one that does not answer is refused, as is a missing extra."""
    name = "threads" if scheduler is None else scheduler
    is_text = isinstance(name, str)
    if is_text and name in _LOCAL:
        return name, None if workers is None else count("sweep(workers=...)", workers, "Pass how many work at a time.")
    if not is_client(name) and not (is_text and "://" in name):
        remedy = "Choose one of them, or leave it out for threads."
        requirement = f"be one of {', '.join(_LOCAL)} or an address tcp://host:port, or a distributed.Client"
        raise error(_WHERE, requirement, shown(scheduler), remedy)
    if workers is not None:
        remedy = "Leave it out: a cluster has the workers that were started for it."
        raise error("sweep(workers=...)", "come with threads or processes", f"{shown(workers)} for {name}", remedy)
    (check_client if is_client(name) else check_cluster)(name)
    return name, None


def do_all(store: SweepStore, task: Task, scheduler: Any, workers: int | None, take: Take) -> None:
    """Do every block; what becomes of each is taken as soon as it is known, in the thread of the caller."""
    blocks = iter(range(store.layout.blocks))
    if scheduler not in _LOCAL:
        do_on_cluster((store, task), blocks, scheduler, take)
        return
    import dask
    from dask.system import CPU_COUNT

    def report(_key: Any, result: Any, *_: Any) -> None:
        take(result)

    one = dask.delayed(functools.partial(do_block, store, task), name="block", pure=False, traverse=False)  # pyright: ignore
    pool: Executor | None = ThreadPoolExecutor(workers or CPU_COUNT) if scheduler == "threads" else None
    if scheduler == "processes":
        pool = ProcessPoolExecutor(workers or CPU_COUNT, multiprocessing.get_context("spawn"), _begin_worker)
    options = {} if pool is None else {"pool": pool}
    options |= {"chunksize": 1, "callbacks": [(None, None, None, report, None)]}  # of this call, not of all of Dask
    names = [f"block-{later:04}" for later in reversed(range(_AHEAD))]  # Dask begins with the last name
    try:
        while wave := [one(block, dask_key_name=name) for name, block in zip(names, blocks, strict=False)]:
            dask.compute(*wave, scheduler=scheduler, optimize_graph=False, traverse=False, **options)  # pyright: ignore
    except BrokenProcessPool as failure:
        reason = "A worker process was killed, ran out of memory, or could not start (scripts need a __main__ guard)"
        raise ChildProcessError(reason) from failure
    finally:
        if pool is not None:
            pool.shutdown(wait=True, cancel_futures=True)


def _begin_worker() -> None:
    """Let a worker process end with its client, which may be killed, and leave Ctrl-C to it."""
    signal.signal(signal.SIGINT, signal.SIG_IGN)
    threading.Thread(target=_end_with, args=(multiprocessing.parent_process(),), daemon=True).start()


def _end_with(client: Any) -> None:
    client.join()
    os._exit(1)
