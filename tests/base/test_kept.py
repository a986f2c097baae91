"""What a system computes once: copies of small arrays, large ones each time, nothing that is traced."""

import copy
import pickle

import numpy as np

import nonholo as nh


def test_arrays_are_handed_out_as_copies() -> None:
    """Who changes one changes nothing else, nor does a pickled or copied system."""
    system = nh.ChaplyginSleigh(1.0, 2.0, 0.5, 0.1)
    first = system.inertia_operator
    wanted = first.copy()
    first[:] = 7.0
    for same in (system, copy.deepcopy(system), pickle.loads(pickle.dumps(system))):  # noqa: S301
        assert np.array_equal(same.inertia_operator, wanted)
    assert not np.array_equal(nh.ChaplyginSleigh(1.5, 2.0, 0.5, 0.1).inertia_operator, wanted)


def test_large_arrays_are_not_kept() -> None:
    """An inertia operator on SO(14) takes 66 kB: it is computed each time; its group is kept."""
    system = nh.RigidBody(np.diag(np.arange(1.0, 15.0)))
    assert system.inertia_operator.nbytes > 1 << 15
    assert not any(isinstance(value, np.ndarray) and value.nbytes > 1 << 15 for value in vars(system).values())
    top = nh.SuslovTop(np.diag([1.0, 2.0, 3.0]))
    assert top.group is top.group


def test_what_is_traced_is_not_kept() -> None:
    """A value of one trace must not reach another."""
    import jax

    seen = []

    def energy(a: jax.Array) -> jax.Array:
        system = nh.ChaplyginSleigh(1.0, 2.0, a)
        value = system.inertia_operator.sum()
        seen.append(vars(system))
        return value

    assert jax.grad(energy)(0.5) == 3.0
    assert all(set(kept) == {"mass", "inertia", "a", "b"} for kept in seen)
