"""Orbits that take a random real value at every step tend to the attracting momentum, or end; batches of many bodies.

The batches solve the equations of docs/theory/branches.md in principal axes, without code of the library.
"""

import dataclasses

import mpmath
import numpy as np
import pytest
from bodies import mass_tensor
from refusals import refusals

import nonholo as nh

FAR = 1e6  # tangents of half angles that are followed
RESIDUAL = 1e-10  # of equations whose coefficients are of order one


@dataclasses.dataclass
class Batch:
    """Bodies with B = diag(b), coupling c, arm a (0 for tops), and their scaled momenta r, p; leading axis: bodies."""

    b: np.ndarray
    c: np.ndarray
    a: np.ndarray
    r: np.ndarray
    p: np.ndarray

    @property
    def inertia(self) -> np.ndarray:
        """The inertia about the blade."""
        return self.b + self.a[:, None] ** 2

    @property
    def energy(self) -> np.ndarray:
        """Twice the energy times the square of the time step."""
        return 4 * (self.r**2 / self.inertia).sum(axis=1) + self.p**2

    @property
    def lyapunov(self) -> np.ndarray:
        """The quantity that never rises."""
        return np.where(self.a == 0, (self.c * self.r).sum(axis=1), -np.sign(self.a) * self.p)

    def rows(self, chosen: np.ndarray) -> "Batch":
        """Return some of the bodies."""
        return Batch(*(getattr(self, field.name)[chosen] for field in dataclasses.fields(self)))

    def residual(self, y: np.ndarray) -> np.ndarray:
        """Return what the equations for y = z / z0 want to be zero."""
        square, s = (y * y).sum(axis=-1), 1 + (y * y).sum(axis=-1)
        along = np.einsum("mi,mbi->mb", self.c, y)
        forward = self.a[:, None] / 2 * (self.p[:, None] * s + 2 * self.a[:, None] * square) - along
        return (
            self.inertia[:, None] * y
            + square[..., None] * self.c[:, None]
            + forward[..., None] * y
            - s[..., None] * self.r[:, None]
        )

    def slope(self, y: np.ndarray) -> np.ndarray:
        """Return the derivative of the residual."""
        square, a = (y * y).sum(axis=-1), self.a[:, None]
        along = np.einsum("mi,mbi->mb", self.c, y)
        forward = a / 2 * (self.p[:, None] * (1 + square) + 2 * a * square) - along
        diagonal = (self.inertia[:, None] + forward[..., None])[..., None] * np.eye(y.shape[-1])
        change = (a * self.p[:, None] + 2 * a * a)[..., None] * y - self.c[:, None]
        pull = 2 * (self.c - self.r)[:, None, :, None] * y[..., None, :]
        return diagonal + y[..., :, None] * change[..., None, :] + pull

    def values(self) -> tuple[np.ndarray, np.ndarray]:
        """Return candidates y of all values, and which of them are real displacements."""
        with np.errstate(all="ignore"):
            y = self._from_secular()
            for _ in range(4):
                y = np.clip(np.nan_to_num(y, nan=FAR), -FAR, FAR)
                y = y - (np.linalg.pinv(self.slope(y)) @ self.residual(y)[..., None])[..., 0]
            size = np.abs(self.residual(y)).max(axis=-1) / (1 + (y * y).sum(axis=-1))
        return y, size <= RESIDUAL

    def _from_secular(self) -> np.ndarray:
        """Return real parts of y at the roots of the secular polynomial, interpolated at points of a circle."""
        k = self.b.shape[1]
        degree = 2 * k + int(np.any(self.a))
        circle = 1.5 * np.exp(2j * np.pi * np.arange(degree + 1) / (degree + 1))
        coefficients = np.fft.fft(self._secular(circle), axis=1) / 1.5 ** np.arange(degree + 1)
        monic = (coefficients[:, :-1] / coefficients[:, -1:]).real
        companion = np.zeros((len(monic), degree, degree))
        companion[:, 1:, :-1] = np.eye(degree - 1)
        companion[:, :, -1] = -monic
        mu = np.linalg.eigvals(companion)[..., None]
        half, d, c = (self.a * self.p + 2 * self.a**2)[:, None, None] / 2, (self.r - self.c)[:, None], self.c[:, None]
        G = 1 / (self.b[:, None] + mu)
        s = (mu + (c * c * G).sum(-1, keepdims=True)) / (half - (c * d * G).sum(-1, keepdims=True))
        return np.asarray((G * (s * d + c)).real)

    def _secular(self, mu: np.ndarray) -> np.ndarray:
        factors = self.b[:, None] + mu[None, :, None]
        product, half = factors.prod(axis=-1), (self.a * self.p + 2 * self.a**2)[:, None] / 2
        c, d = self.c[:, None], (self.r - self.c)[:, None]
        cc, cd = ((c * c / factors).sum(axis=-1), (c * d / factors).sum(axis=-1))
        first, second = product * (mu + cc), product * (half - cd)
        Y = (first[..., None] * d + second[..., None] * c) / factors
        return second * (first - second) - (Y * Y).sum(axis=-1)

    def moved(self, y: np.ndarray) -> tuple["Batch", np.ndarray]:
        """Return the batch after a step with one value each, and the fall that theory wants."""
        square = (y * y).sum(axis=1)
        z0 = 1 / np.sqrt(1 + square)
        z, u = z0[:, None] * y, z0 * (self.p * (1 + square) + 2 * self.a * square)
        zz, cz = (z * z).sum(axis=1), (self.c * z).sum(axis=1)
        force = zz[:, None] * self.c - cz[:, None] * z + (self.a * u)[:, None] / 2 * z
        after = Batch(self.b, self.c, self.a, self.r - 2 * force, self.p + 4 * self.a * zz)
        across = zz * (self.c**2).sum(axis=1) - cz**2
        return after, np.where(self.a == 0, 2 * across, 4 * np.abs(self.a) * zz)


def _random_rule(batch: Batch, rng: np.random.Generator) -> tuple[np.ndarray, np.ndarray]:
    """Return a random real value of each body, and which have one."""
    y, real = batch.values()
    return y[np.arange(len(y)), np.argmax(real * rng.random(real.shape), axis=1)], real.any(axis=1)


def _line(batch: Batch) -> np.ndarray:
    """Return the energy of the equilibria that turn by 90 degrees, of tops."""
    return (batch.b * batch.c**2).sum(axis=1) / (batch.c**2).sum(axis=1)


def _drawn(kind: str, k: int, count: int, rng: np.random.Generator, share: tuple[float, float]) -> Batch:
    """Draw bodies; energies are a share of the line's for tops, and as large as they like for sleighs."""
    b, c = rng.uniform(0.3, 1.0, (count, k)), rng.normal(size=(count, k))
    c *= rng.uniform(0.2, 0.8, (count, 1)) / np.linalg.norm(c, axis=1)[:, None]
    sleigh = kind == "sleigh"
    a = rng.choice([-1, 1], count) * rng.uniform(0.4, 1.0, count) if sleigh else np.zeros(count)
    batch = Batch(b, 0 * c if sleigh and k == 1 else c, a, rng.normal(size=(count, k)), sleigh * rng.normal(size=count))
    level = 10 ** rng.uniform(-1.0, 2.0, count) if sleigh else rng.uniform(*share, count) * _line(batch)
    size = np.sqrt(level / batch.energy)
    return dataclasses.replace(batch, r=batch.r * size[:, None], p=batch.p * size)


def _missed(batch: Batch) -> np.ndarray:
    """Return the distance from the attracting momentum of the energy, as a share of its size."""
    q = (batch.b * batch.c**2).sum(axis=1)
    turning = batch.r + np.sqrt(batch.energy / 4 / np.where(q > 0, q, 1))[:, None] * batch.b * batch.c
    straight = np.hypot(np.linalg.norm(batch.r, axis=1), batch.p - np.sign(batch.a) * np.sqrt(batch.energy))
    return np.where(batch.a == 0, np.linalg.norm(turning, axis=1), straight) / np.sqrt(batch.energy)


def _followed(batch: Batch, rng: np.random.Generator, steps: int) -> tuple[int, int, int]:
    """Return how many orbits reached the attracting momentum, ended, and did neither."""
    level, reached, ended = batch.energy, 0, 0
    for _ in range(steps):
        y, real = _random_rule(batch, rng)
        ended += int(np.sum(~real))
        before, level = batch.rows(real), level[real]
        batch, fall = before.moved(y[real])
        assert np.abs(before.lyapunov - batch.lyapunov - fall).max(initial=0) <= 1e-12 * np.sqrt(level.max(initial=1))
        assert np.abs(batch.energy / level - 1).max(initial=0) <= 1e-6
        there = _missed(batch) <= 1e-6
        reached += int(there.sum())
        batch, level = batch.rows(~there), level[~there]
        if len(level) == 0:
            break
    return reached, ended, len(level)


FAMILIES = [("top", 2), ("top", 3), ("top", 4), ("top", 5), ("sleigh", 1), ("sleigh", 2), ("sleigh", 4)]
NAMES = [f"{kind} {'SE' if kind == 'sleigh' else 'SO'}({k + 1})" for kind, k in FAMILIES]


@pytest.mark.profile("long", keep=["30-top SO(4)", "30-sleigh SE(3)", "30-sleigh SE(2)"])
@pytest.mark.parametrize(("kind", "k"), FAMILIES, ids=NAMES)
@pytest.mark.parametrize("count", [30, 1500])
def test_random_branches_tend_to_the_attracting_momentum(kind: str, k: int, count: int) -> None:
    """Every orbit with a random real value at each step ends or reaches the limit; of sleighs none ends."""
    rng = np.random.default_rng(k + count)
    reached, ended, neither = _followed(_drawn(kind, k, count, rng, (0.05, 1.0)), rng, 3000)
    assert neither == 0
    assert reached >= 0.2 * count
    assert kind == "top" or ended == 0


@pytest.mark.parametrize("k", [2, 3, 5])
def test_above_the_line_every_orbit_ends(k: int) -> None:
    """Above the line of equilibria tops take no more steps than the bound, whatever values they take."""
    rng = np.random.default_rng(k)
    batch = _drawn("top", k, 400, rng, (1.05, 6.0))
    ratio = np.sqrt(batch.energy / _line(batch))
    sharp = np.linalg.norm(batch.c, axis=1)
    bound = 2 * ratio / (ratio - 1) ** 2 * (batch.b.max(axis=1) / sharp + sharp / batch.b.min(axis=1))
    taken, longest = 0, 0.0
    while len(batch.p):
        y, real = _random_rule(batch, rng)
        batch, bound = batch.rows(real).moved(y[real])[0], bound[real]
        taken += 1
        longest = max(longest, (taken / bound).max(initial=0))
        assert np.all(taken <= bound)
    assert taken >= 2
    assert longest > 0.01


BODIES = {
    "top": nh.SuslovTop(np.diag([1.0, 0.7, 0.9, 0.6]) + 0.2),
    "sleigh": nh.MultidimensionalSleigh(1.3, [0.6, 0.2, -0.1], np.diag([0.5, 0.7, 0.4]) + 0.1),
}


@pytest.mark.profile("problems", keep=["sleigh"])
@pytest.mark.parametrize("name", BODIES)
def test_random_walks_of_the_library_have_the_limits_of_asymptotics(name: str) -> None:
    """Two random walks end on the velocity that `asymptotics` says, to the rate of the last steps."""
    body, rng = BODIES[name], np.random.default_rng(4)
    for speed in (0.3, -0.4):
        orbit = nh.simulate(
            nh.discretize(body, 1.0),
            restricted_velocity=speed * np.array([1.0, -0.7, 0.5]),
            steps=120,
            branch=lambda found, _: rng.choice(np.flatnonzero(found.is_real)),
        )
        limits = nh.asymptotics(orbit)
        assert not limits.persists
        assert np.abs(orbit.body_velocity[-1] - limits.velocity_after).max() <= 1e-4


def test_no_limits_above_the_line() -> None:
    """Above the highest energy of equilibria an orbit has no limits, since it ends; just below it has."""
    top = nh.discretize(nh.SuslovTop([[1.4, 0.2, 0.5], [0.2, 1.0, -0.3], [0.5, -0.3, 0.9]]), 0.5)
    line = nh.critical_energies(top).line
    displacement = nh.SO(3).exp(np.array([0.5, 1.3, 0.0]))
    orbit = nh.simulate(top, displacement=displacement, steps=9, branch="smallest", throw=False)
    assert orbit.energy[0] > line
    assert orbit.outcome == nh.Outcome.no_real_branch
    limits = nh.asymptotics(orbit)
    assert limits.velocity_after is None
    assert limits.axis_before is None
    assert not limits.persists


def test_highest_energy_of_equilibria() -> None:
    """It is q_c / (2 h^2 |c|^2) for a top with n = 4 and a sleigh that turns at rest; a sleigh that glides has none."""
    top, gliding = BODIES["top"], BODIES["sleigh"]
    c, h = top.coupling, 0.5
    expected = c @ top.constrained_inertia @ c / (c @ c) / (2 * h * h)
    assert nh.equilibria(nh.discretize(top, h), 0.1).highest_energy == pytest.approx(expected, rel=1e-13)
    J = np.diag([0.5, 0.7, 0.4]) + 0.1
    turning = nh.MultidimensionalSleigh(1.3, [0.0, 0.2, -0.1], J)
    B, c = J[1:, 1:] + J[0, 0] * np.eye(2), J[0, 1:]
    expected = c @ B @ c / (c @ c) / (2 * h * h)
    assert nh.equilibria(nh.discretize(turning, h), 0.1).highest_energy == pytest.approx(expected, rel=1e-13)
    assert nh.equilibria(nh.discretize(gliding, h), 0.1).highest_energy is None


def test_a_map_that_does_not_keep_energy_is_refused_at_any_energy() -> None:
    """Nothing is known of the limits of the logarithmic difference, above the line either."""
    top = nh.SuslovTop(np.diag([1.0, 0.7, 0.9]) + 0.2)
    logarithmic = nh.discretize(top, 2.0, difference="logarithmic")
    orbit = nh.simulate(nh.discretize(top, 0.2), restricted_velocity=(1.0, -0.5), steps=1)
    with pytest.raises(ValueError, match="conserve the energy"):
        nh.asymptotics(dataclasses.replace(orbit, motion=logarithmic))


TOP = nh.SuslovTop([[1.4, 0.2, 0.5], [0.2, 1.0, -0.3], [0.5, -0.3, 0.9]])
TILTED = nh.SuslovTop.from_inertia([[3.0, 0.1, 0.2], [0.1, 2.0, 0.3], [0.2, 0.3, 2.5]], (2 / 3, -1 / 3, 2 / 3))
SLEIGH = nh.ChaplyginSleigh(0.9, 0.4, 0.7, 0.35)


@pytest.mark.parametrize("parameters", [(0.9, 0.4, 0.7, 0.35), (1.5, 0.6, -0.5, 0.2), (1.0, 0.75, 0.5, 0.1)])
def test_heading_turn_to_twelve_digits(parameters: tuple) -> None:
    """The turn is the integral of dtheta = du/(a omega(u)) over the level, taken to 30 digits."""
    with mpmath.workdps(30):
        m, J, a, _ = (mpmath.mpf(x) for x in parameters)
        E, inertia = mpmath.mpf(2), J + m * a * a
        edge = mpmath.sqrt(2 * E / m)

        def turned(x: mpmath.mpf) -> mpmath.mpf:
            return edge * mpmath.cos(x) / (abs(a) * mpmath.sqrt((2 * E - m * (edge * mpmath.sin(x)) ** 2) / inertia))

        expected = mpmath.quad(
            turned, [-mpmath.pi / 2 + mpmath.mpf(10) ** -13, 0, mpmath.pi / 2 - mpmath.mpf(10) ** -13]
        )
    assert abs(nh.asymptotics(nh.ChaplyginSleigh(*parameters)).heading_turn / float(expected) - 1) <= 1e-12


@pytest.mark.parametrize("omega", [0.8, -0.8])
def test_turns_of_a_flow(omega: float) -> None:
    """The heading of a long flow turns as said, and its direction of motion by half a turn less, modulo full ones."""
    orbit = nh.flow(SLEIGH, restricted_velocity=(omega, 0.3), times=[0.0, 1.0], method="closed_form")
    found = nh.asymptotics(orbit)
    start = {"restricted_velocity": (omega, 0.3), "method": "closed_form"}
    ends = [nh.flow(SLEIGH, times=[0.0, t, 1.01 * t], **start) for t in (-1e3, 1e3)]
    assert ends[1].heading[-1] - ends[0].heading[-1] == pytest.approx(found.heading_turn, rel=1e-13)
    directions = [np.array([1, 1j]) @ np.diff(end.position[1:], axis=0)[0] for end in ends]
    turned = np.angle(-directions[1] / directions[0])  # the early one is taken against time
    assert np.angle(np.exp(1j * (found.motion_turn - turned))) == pytest.approx(0.0, abs=1e-12)
    for end, limit in zip(ends, (found.velocity_before, found.velocity_after), strict=True):
        assert np.abs(end.body_velocity[-1] - limit).max() <= 1e-14


def test_turn_of_the_map_is_second_order() -> None:
    """The turn of discrete orbits tends to that of the flow with h^2; the limits of the velocity are the same."""
    exact, errors = nh.asymptotics(SLEIGH).heading_turn, []
    for h in (0.2, 0.1, 0.05):
        orbit = nh.simulate(nh.discretize(SLEIGH, h), restricted_velocity=(0.8, 0.1), steps=5)
        found = nh.asymptotics(orbit)
        assert found.persists
        errors.append(found.heading_turn - exact)
        speed = np.sqrt(2 * orbit.energy[0] / SLEIGH.mass)
        assert np.abs(found.velocity_after - [0.0, speed, 0.0]).max() <= 1e-14
    assert np.abs(np.log2(np.divide(errors[:-1], errors[1:])) - 2).max() <= 0.1


@pytest.mark.parametrize("top", [TOP, TILTED], ids=["e3", "tilted"])
@pytest.mark.parametrize("kind", ["flow", "map"])
def test_axes_of_a_top(top: nh.SuslovTop, kind: str) -> None:
    """Axes in body and space are those that long runs end on, and do not depend on the state one starts from."""
    start, discrete = {"restricted_velocity": (0.6, 0.7)}, nh.discretize(top, 0.2)
    if kind == "flow":
        orbit = nh.flow(top, times=[0.0, 2.0], rtol=1e-12, atol=1e-13, **start)
        later = nh.flow(top, times=[0.0, 100.0], rtol=1e-12, atol=1e-13, **start)
        tail = nh.flow(top, momentum=orbit.restricted_momentum[1], configuration=orbit.configuration[1], times=[0, 1])
    else:
        orbit = nh.simulate(discrete, steps=10, **start)
        later = nh.simulate(discrete, steps=1000, **start)
        tail = orbit[3:]
    found, same = nh.asymptotics(orbit), nh.asymptotics(tail)
    assert np.abs(found.axis_after + found.axis_before).max() <= 1e-15
    assert np.abs(found.axis_after - nh.asymptotics(top).axis_after).max() <= 1e-14
    assert np.abs(later.body_velocity[-1] - found.velocity_after).max() <= 1e-8
    spatial = later.configuration[-1] @ later.body_velocity[-1]
    assert np.abs(spatial / np.linalg.norm(spatial) - found.spatial_axis_after).max() <= 1e-7
    for name in ("spatial_axis_before", "spatial_axis_after"):
        assert np.abs(getattr(found, name) - getattr(same, name)).max() <= 1e-8


def test_turn_of_an_orbit_without_poses() -> None:
    """The turn does not depend on where one starts, and needs no poses; its sign is that of omega."""
    discrete = nh.discretize(SLEIGH, 0.1)
    for omega in (0.8, -0.8):
        posed, bare = (
            nh.simulate(discrete, restricted_velocity=(omega, 0.1), steps=7, reconstruct=kept) for kept in (True, False)
        )
        turn = nh.asymptotics(posed).heading_turn
        assert nh.asymptotics(bare).heading_turn == turn
        assert nh.asymptotics(posed[4:]).heading_turn == pytest.approx(turn, rel=1e-12)
        assert np.sign(turn) == np.sign(omega)


@pytest.mark.profile("routes", keep=["turning sleigh 3"])
@pytest.mark.parametrize("name", ["top 5", "sleigh 3", "turning sleigh 3"])
def test_limits_in_higher_dimensions(name: str) -> None:
    """The velocity limits are reached by long discrete orbits; for a_1 = 0 the advance u is kept."""
    center = [0.0 if name.startswith("turning") else 0.3, 0.2, -0.1]
    sleigh = nh.MultidimensionalSleigh(1.3, center, np.diag([0.5, 0.7, 0.4]) + 0.1)
    system = nh.SuslovTop(mass_tensor(nh.SO(5), np.random.default_rng(0))) if name == "top 5" else sleigh
    start = 0.4 * np.array([1.0, -0.7, 0.5, 0.8])[: len(system.constraint_subspace)]
    orbit = nh.simulate(nh.discretize(system, 0.2), restricted_velocity=start, steps=20_000, save_every=20_000)
    found = nh.asymptotics(orbit)
    assert found.persists == (name == "top 5")  # Theorem 9.5: below the first fold
    assert np.abs(orbit.body_velocity[-1] - found.velocity_after).max() <= 1e-8
    assert system.constrained_energy(found.velocity_before @ system.inertia_operator) == pytest.approx(orbit.energy[0])


def test_motions_that_stay() -> None:
    """From an equilibrium nothing changes; a balanced sleigh turns forever, and a balanced top keeps its axis."""
    straight = nh.asymptotics(nh.simulate(nh.discretize(SLEIGH, 0.1), restricted_velocity=(0.0, -1.0), steps=3))
    assert straight.heading_turn == 0
    assert np.array_equal(straight.velocity_before, straight.velocity_after)
    circling = nh.asymptotics(nh.flow(nh.ChaplyginSleigh(1.0, 1.0, 0.0), restricted_velocity=(1.0, 1.0), times=[0, 1]))
    assert circling.heading_turn is None
    assert nh.asymptotics(nh.ChaplyginSleigh(1.0, 1.0, 0.0)).heading_turn is None
    top = nh.SuslovTop(np.diag([1.0, 2.0, 3.0]))
    kept = nh.asymptotics(nh.simulate(nh.discretize(top, 0.1), restricted_velocity=(0.3, 0.4), steps=3))
    assert np.array_equal(kept.spatial_axis_before, kept.spatial_axis_after)


# Other systems, and orbits that settle too slowly.
test_refusals = refusals(
    (lambda: nh.VeselovaTop(np.diag([1.0, 2.0, 3.0])), "top or a sleigh"),
    (lambda: nh.simulate(nh.discretize(SLEIGH, 1e-6), restricted_velocity=(0.5, 0.5), steps=2), "within 1000000 steps"),
    ask=lambda make: nh.asymptotics(make()),
)
