"""Sweeps on a real Dask cluster, over TCP on loopback: the bits of threads, whoever is killed."""

import random
import re
import signal
import socket
import sys
import threading
import time
from collections.abc import Callable, Iterator
from concurrent.futures import Future, ThreadPoolExecutor
from os import kill
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import distributed
import pytest
import xarray
from ensembles.cluster import BLOCK, DESIGN, Cluster, begin, cluster, done, slow
from ensembles.faults import same
from waiting import wait_for

import nonholo as nh
from nonholo.ensembles import _scheduling
from nonholo.ensembles.stores import SweepStore

BLOCKS = DESIGN.members // BLOCK
PAGE = (Path(__file__).parents[2] / "docs" / "how-to" / "beyond-one-machine.md").read_text()


@pytest.fixture(scope="module")
def running(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Cluster]:
    """A cluster of a worker that nobody kills; who needs more adds them."""
    with cluster(tmp_path_factory.mktemp("running"), workers=1) as machines:
        _wait_for_a_worker(machines.address)
        yield machines


def _wait_for_a_worker(address: str) -> None:
    """Wait for the first one: on a busy machine it takes longer to start than a sweep waits without a warning."""
    with distributed.Client(address, set_as_default=False) as client:
        client.wait_for_workers(1, timeout=300)


@pytest.fixture(scope="module")
def undisturbed(tmp_path_factory: pytest.TempPathFactory) -> xarray.Dataset:
    """The sweep of `slow` in threads, without any trouble."""
    return nh.sweep(slow, DESIGN, tmp_path_factory.mktemp("threads") / "a.zarr", block=BLOCK).load()


def _in_background(address: str, store: Path) -> Future[xarray.Dataset]:
    """Start the sweep of `slow` on a cluster that has a worker, by a client in a thread."""
    _wait_for_a_worker(address)
    pool = ThreadPoolExecutor(1)
    swept = pool.submit(nh.sweep, slow, DESIGN, store, address, block=BLOCK)
    pool.shutdown(wait=False)
    return swept


def _some_blocks(store: Path, chance: random.Random) -> None:
    """Wait until a random part of the sweep is done."""
    many = chance.randrange(1, BLOCKS // 2)
    wait_for(lambda: len(done(store)) >= many)


@pytest.mark.profile("faults", instead="test_functions_without_a_module")
def test_workers_compute_the_bits_of_threads(running: Cluster, tmp_path: Path) -> None:
    """Two worker processes share the blocks of an ensemble, and write what threads write."""
    top = nh.discretize(nh.SuslovTop([[1.4, 0.2, 0.5], [0.2, 1.0, -0.3], [0.5, -0.3, 0.9]]), 0.1)
    task = nh.EnsembleTask(top, steps=100, reductions=["final_state", "energy_drift", "limit_angle"])
    design = nh.RandomDesign(200, {"mass_tensor": nh.MassTensor(3, 0.5, 2.0), "restricted_velocity": nh.Direction(2)})
    running.add_worker()
    with distributed.Client(running.address, set_as_default=False) as client:
        client.wait_for_workers(2, timeout=120)
    result = nh.sweep(task, design, tmp_path / "a.zarr", running.address, block=8)
    assert same(result, nh.sweep(task, design, tmp_path / "b.zarr", block=32))
    assert len(set(done(tmp_path / "a.zarr"))) == 2


def test_functions_without_a_module(running: Cluster, tmp_path: Path) -> None:
    """A lambda goes to the workers with what it closes over."""
    factor = 3.0
    result = nh.sweep(lambda block: factor * block["x"], DESIGN, tmp_path / "a.zarr", running.address)
    assert (result["result"].values == 3.0 * result["x"].values).all()


@pytest.mark.profile("faults", instead="test_workers_without_the_store")
def test_functions_that_workers_lack(running: Cluster, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """A function of a module that only the client has is named, and no worker is harmed."""
    (tmp_path / "only_here.py").write_text("def task(block):\n    return block['x'] ** 2\n")
    monkeypatch.syspath_prepend(tmp_path)
    from only_here import task  # pyright: ignore[reportMissingImports]

    with pytest.raises(ValueError, match=r"must be importable by the workers. Got No module named 'only_here' \(.*:\d"):
        nh.sweep(task, DESIGN, tmp_path / "a.zarr", running.address)
    assert nh.resume(tmp_path / "a.zarr", task=task).sizes == {"member": DESIGN.members}
    assert all(process.poll() is None for process in running.workers)


def test_workers_without_the_store(running: Cluster, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """Workers for which another folder is at that path say so."""
    elsewhere = (SweepStore, (tmp_path / "elsewhere.zarr", "0"))
    monkeypatch.setattr(SweepStore, "__reduce__", lambda _: elsewhere)
    with pytest.raises(OSError, match=r"worker .*:\d+ does not see this store: choose a path on a file system"):
        nh.sweep(slow, DESIGN, tmp_path / "a.zarr", running.address)


@pytest.mark.profile("faults", keep=["nobody", "another"])
@pytest.mark.parametrize("listens", ["nobody", "another", "somebody silent"])
def test_addresses_without_a_scheduler(listens: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """Where nobody listens, or another server does, a sweep ends at once and leaves nothing, no thread either."""
    monkeypatch.setattr(_scheduling, "_CONNECT", 1)
    server, begun = socket.create_server(("127.0.0.1", 0)), time.monotonic()
    address = f"tcp://127.0.0.1:{server.getsockname()[1]}"
    if listens == "another":
        threading.Thread(target=_answer, args=(server,), daemon=True).start()
    elif listens == "nobody":
        server.close()
    threads = set(threading.enumerate())
    with pytest.raises(ValueError, match=f"must be the address of a Dask scheduler. Got {address}: [A-Zn]"):
        nh.sweep(slow, DESIGN, tmp_path / "a.zarr", address)
    server.close()
    assert time.monotonic() - begun < 60
    assert set(threading.enumerate()) <= threads
    assert not (tmp_path / "a.zarr").exists()


def test_the_address_of_a_worker_is_refused(running: Cluster, tmp_path: Path) -> None:
    """Workers listen too; whoever passes the address of one is informed."""
    with distributed.Client(running.address, set_as_default=False) as client:
        worker = next(iter(client.scheduler_info()["workers"]))
    with pytest.raises(ValueError, match=rf"must be the address of a Dask scheduler\. Got {worker}, a worker\."):
        nh.sweep(slow, DESIGN, tmp_path / "a.zarr", worker)


@pytest.mark.profile("faults", instead="test_functions_without_a_module")
def test_the_page(running: Cluster, tmp_path: Path) -> None:
    """The code of the page on clusters runs, for fewer members: the script on a cluster, and its groups."""
    run, groups = re.findall(r"```python\n(.*?)```", PAGE, re.DOTALL)
    ours = {"10**9": "100", "/shared/tops.zarr": str(tmp_path / "a.zarr"), "tcp://host:8786": running.address}
    for text, own in ours.items():
        assert text in run
        run = run.replace(text, own)
    names: dict[str, Any] = {"__name__": "__main__"}
    exec(run, names)  # noqa: S102
    assert nh.load_sweep(tmp_path / "a.zarr").sizes["member"] == 100
    exec(groups.replace("10_000", "10"), names)  # noqa: S102
    result = nh.sweep(names["headings"], nh.RandomDesign(3, {"a": nh.Uniform(0.1, 1.0)}), tmp_path / "b.zarr", block=2)
    assert result["headings"].dims == ("member", "bin")
    assert (result["headings"].sum("bin") == 10).all()


def test_a_number_of_workers_is_refused(tmp_path: Path) -> None:
    """How many work is not for the client of a cluster to say."""
    with pytest.raises(ValueError, match=r"must come with threads or processes. Got 2 for tcp://127.0.0.1:1"):
        nh.sweep(slow, DESIGN, tmp_path / "a.zarr", "tcp://127.0.0.1:1", workers=2)


def _answer(server: socket.socket) -> None:
    """Answer one connection as a web server would."""
    with server, server.accept()[0] as connection:
        connection.sendall(b"HTTP/1.1 400 Bad Request\r\n\r\n")


@pytest.mark.profile("faults", instead="test_interruption_after_each_block")
@pytest.mark.parametrize("nanny", [False, True], ids=["alone", "nanny"])
def test_a_killed_worker_is_replaced(nanny: bool, tmp_path: Path, undisturbed: xarray.Dataset) -> None:
    """The sweep waits while there is no worker, and ends with the same bits on the one that comes next."""
    with cluster(tmp_path / "cluster", workers=1, nanny=nanny) as machines:
        swept = _in_background(machines.address, tmp_path / "a.zarr")
        _some_blocks(tmp_path / "a.zarr", random.Random(nanny))  # noqa: S311
        kill(int(done(tmp_path / "a.zarr")[0].rpartition(":")[2]), signal.SIGKILL)  # the writer of some block
        if not nanny:
            machines.add_worker()
        assert same(swept.result(timeout=120), undisturbed)
    assert len(set(done(tmp_path / "a.zarr"))) == 2


@pytest.mark.profile("faults", instead="test_interruption_after_each_block")
@pytest.mark.parametrize("trial", range(3))
def test_killed_clients_go_on(running: Cluster, trial: int, tmp_path: Path, undisturbed: xarray.Dataset) -> None:
    """After a client is killed at a random moment threads end its sweep with the same bits, and workers are free."""
    store = tmp_path / "a.zarr"
    client = begin(running.address, store)
    _some_blocks(store, random.Random(trial))  # noqa: S311
    client.kill()
    client.wait()
    assert len(done(store)) < BLOCKS
    assert same(nh.resume(store, trust=True), undisturbed)


@pytest.mark.profile("faults", instead="test_nobody_to_work_is_told")
@pytest.mark.parametrize("strike", [lambda made: made.scheduler.kill(), Cluster.kill], ids=["scheduler", "all"])
def test_a_killed_cluster_is_told(
    strike: Callable[[Cluster], Any], tmp_path: Path, undisturbed: xarray.Dataset, monkeypatch: pytest.MonkeyPatch
) -> None:
    """When the scheduler is gone the client says where the sweep stands, and threads end it with the same bits."""
    monkeypatch.setattr(_scheduling, "_CONNECT", 1)
    with cluster(tmp_path / "cluster", workers=1) as machines:
        swept = _in_background(machines.address, tmp_path / "a.zarr")
        _some_blocks(tmp_path / "a.zarr", random.Random(2))  # noqa: S311
        strike(machines)
        with pytest.raises(OSError, match=r"to the scheduler at tcp.* was lost. The sweep stands at \d+ of 240"):
            swept.result(timeout=120)
    assert same(nh.resume(tmp_path / "a.zarr", trust=True), undisturbed)


def test_nobody_to_work_is_told(monkeypatch: pytest.MonkeyPatch) -> None:
    """Where no block is ready, and no worker is known, a warning says what the sweep waits for."""
    monkeypatch.setattr(_scheduling, "_PATIENCE", 0.0)
    running = SimpleNamespace(count=lambda: 1, has_ready=lambda: False)
    client = SimpleNamespace(ncores=dict, scheduler=SimpleNamespace(address="tcp://here:1"))
    with pytest.raises(RuntimeWarning, match=r"at tcp://here:1 has no workers\. The .* dask worker tcp://here:1$"):
        next(_scheduling._batches(running, client))


@pytest.mark.profile("faults", instead="test_nobody_to_work_is_told")
def test_a_cluster_without_workers_is_told(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """A sweep for which there are no workers says what it waits for."""
    monkeypatch.setattr(_scheduling, "_PATIENCE", 0.1)
    with (
        cluster(tmp_path / "cluster", workers=0) as alone,
        pytest.raises(RuntimeWarning, match=f"has no workers. The sweep waits for some: dask worker {alone.address}"),
    ):
        nh.sweep(slow, DESIGN, tmp_path / "a.zarr", alone.address)


def test_a_missing_extra_is_named(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """Without distributed threads work, and the address of a cluster is refused with the name of the extra."""
    monkeypatch.setitem(sys.modules, "distributed", None)
    with pytest.raises(ValueError, match=r"Install the extra `cluster`: pip install 'nonholo\[cluster\]'\."):
        nh.sweep(slow, DESIGN, tmp_path / "a.zarr", "tcp://127.0.0.1:1")
    assert not (tmp_path / "a.zarr").exists()
    assert nh.sweep(lambda block: block["x"], DESIGN, tmp_path / "a.zarr").sizes["member"] == DESIGN.members


@pytest.mark.profile("faults", instead="test_functions_without_a_module")
def test_the_users_client(running: Cluster, undisturbed: xarray.Dataset, tmp_path: Path) -> None:
    """A client may be passed: the result is that of threads, and the client stays open; a closed one is refused."""
    with distributed.Client(running.address, set_as_default=False) as client:
        result = nh.sweep(slow, DESIGN, tmp_path / "a.zarr", client, block=BLOCK).load()
        assert result.equals(undisturbed)
        assert client.status == "running"
    with pytest.raises(ValueError, match="must be a client that is connected"):
        nh.sweep(slow, DESIGN, tmp_path / "b.zarr", client)
