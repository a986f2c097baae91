"""All blocks of a sweep by the workers of a Dask cluster; the only file that loads `distributed`."""

import asyncio
import contextlib
import errno
import functools
import itertools
import os
import pickle
import socket
import time
import warnings
from collections.abc import Callable, Iterator
from concurrent.futures import CancelledError, ThreadPoolExecutor
from typing import Any

from nonholo.base.checks import error, needs
from nonholo.ensembles._blocks import Done, Work, do_block
from nonholo.ensembles.stores import attributes_of

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


def do_on_cluster(work: Work, blocks: Iterator[int], scheduler: Any, take: Callable[[Done], None]) -> None:
    """Do every block by the scheduler at an address, or by that of a client, which stays open.

    A loss of the scheduler, or of workers again and again, is reported as what it is.
    """
    from distributed.comm.core import CommClosedError
    from distributed.scheduler import KilledWorker

    own = is_client(scheduler)
    connect = _library().Client
    with (
        contextlib.nullcontext(scheduler)
        if own
        else connect(scheduler, timeout=_CONNECT, set_as_default=False) as client
    ):
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


def _do_blocks(work: Work, blocks: Iterator[int], client: Any, take: Callable[[Done], None]) -> None:
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
    return do_block(_work_of(work_bytes), block)


@functools.lru_cache(maxsize=4)
def _work_of(work_bytes: bytes) -> Work:
    """Return what was sent, once it is known that this worker can import the task and sees the store."""
    worker = f"{socket.gethostname()}:{os.getpid()}"
    try:
        work: Work = pickle.loads(work_bytes)  # noqa: S301
    except (ImportError, AttributeError) as failure:
        remedy = "Install its module there, or define the function in the script that calls sweep."
        raise error("sweep(task=...)", "be importable by the workers", f"{failure} ({worker})", remedy) from None
    try:
        is_seen = attributes_of(work.store.path)["made"] == work.store.made
    except (OSError, ValueError):
        is_seen = False
    if not is_seen:
        message = f"The worker {worker} does not see this store: choose a path on a file system that all workers share"
        raise FileNotFoundError(errno.ENOENT, message, str(work.store.path))
    return work


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
