"""Workers: processes under limits of time and of address space that do one job after another."""

import contextlib
import dataclasses
import importlib
import multiprocessing
import multiprocessing.connection
import os
import queue
import resource
import tempfile
import threading
from collections.abc import Callable, Iterable, Iterator
from typing import Any


@dataclasses.dataclass
class Worker:
    """A process that answers jobs by a function of a module, and is started again when it hangs or dies.

    Attributes:
        target: "module:function". The function makes what answers jobs, in the process: it takes long, once.
        seconds: How long a job may take; one that took longer is tried once more, with twice the time.
        addresses: The bytes of address space of the process.
    """

    target: str
    seconds: float = 60.0
    addresses: int = 16 * 2**30
    _process: multiprocessing.process.BaseProcess | None = None

    def __enter__(self) -> "Worker":
        self._folder = tempfile.TemporaryDirectory(prefix="fuzz-")  # what a killed process leaves is in it
        return self

    def __exit__(self, *_: object) -> None:
        self._end()
        self._folder.cleanup()

    def answer(self, job: Any) -> Any:
        """Return the answer to a job, "hang" if it takes too long, "abort" if the process dies of it."""
        answer = self._answer(job, self.seconds)
        return self._answer(job, 2 * self.seconds) if answer == "hang" else answer

    def _answer(self, job: Any, seconds: float) -> Any:
        if self._process is None:
            self._start()
        try:
            self._pipe.send(job)
            if self._pipe.poll(seconds):
                return self._pipe.recv()
        except (EOFError, BrokenPipeError, ConnectionResetError):
            self._end()
            return "abort"
        self._end()
        return "hang"

    def _start(self) -> None:
        context = multiprocessing.get_context("spawn")
        self._pipe, theirs = context.Pipe()
        arguments = (self.target, theirs, self.addresses, self._folder.name)
        self._process = context.Process(target=_work, args=arguments, daemon=True)
        self._process.start()
        theirs.close()
        if not self._pipe.poll(600.0) or self._pipe.recv() != "ready":
            raise RuntimeError(f"A worker for {self.target} did not begin.")

    def _end(self) -> None:
        if self._process is not None:
            self._process.kill()
            self._process.join()
            self._process = None


def _work(target: str, pipe: multiprocessing.connection.Connection, addresses: int, folder: str) -> None:
    module, _, name = target.partition(":")
    tempfile.tempdir = folder
    os.environ.setdefault("JAX_PLATFORMS", "cpu")
    with open(os.devnull, "w") as nowhere, contextlib.redirect_stdout(nowhere), contextlib.redirect_stderr(nowhere):
        answer: Callable[[Any], Any] = getattr(importlib.import_module(module), name)()
        resource.setrlimit(resource.RLIMIT_AS, (addresses, addresses))
        resource.setrlimit(resource.RLIMIT_CORE, (0, 0))
        pipe.send("ready")
        while True:
            pipe.send(answer(pipe.recv()))


def answers(target: str, jobs: Iterable[Any], workers: int = 1, **limits: Any) -> Iterator[tuple[Any, Any]]:
    """Give jobs to some workers; yield each with its answer, in the order in which they come."""
    waiting: queue.SimpleQueue[Any] = queue.SimpleQueue()
    done: queue.SimpleQueue[Any] = queue.SimpleQueue()
    for job in jobs:
        waiting.put(job)
    total = waiting.qsize()
    arguments = (target, limits, waiting, done)
    feeders = [threading.Thread(target=_feed, args=arguments, daemon=True) for _ in range(workers)]
    for feeder in feeders:
        feeder.start()
    for _ in range(total):
        answered = done.get()
        if isinstance(answered, BaseException):
            raise answered
        yield answered
    for feeder in feeders:
        feeder.join()


def _feed(target: str, limits: dict[str, Any], waiting: Any, done: Any) -> None:
    try:
        with Worker(target, **limits) as worker:
            while True:
                job = waiting.get_nowait()
                done.put((job, worker.answer(job)))
    except queue.Empty:
        pass
    except BaseException as failure:  # it is raised where the answers are awaited
        done.put(failure)
