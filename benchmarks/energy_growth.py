"""How the relative energy error of a compiled run grows with the number of steps while the motion stays alive.

An orbit of a top or a sleigh settles on an attracting steady motion, where nothing changes and no error grows. So each
time it has come near that motion it is restarted near the repelling one, at a random point of the same level curve, and
the energy changes of the crossings are added up: what one run would lose if its orbit never settled. The error is the
root mean square over eight such runs. The energy is that of the momenta with their compensations, evaluated in extended
precision.

With --reverse the momenta are replaced by the opposite ones instead, r by -r, which is exact in floating point. That is
the reversal W to W^-1: the run retraces its path, the errors of the way back cancel those of the way there, and nothing
grows. So it says little about the law of growth.

    python benchmarks/energy_growth.py            # up to 1e7 steps, about a minute; 1e8 takes ten
    python benchmarks/energy_growth.py --steps 1e8 --time-step 0.05
    python benchmarks/energy_growth.py --smoke
"""

import numpy as np
from _command import options, small
from _inside import kernels

import nonholo as nh

STARTS = small(8, 1)
BLOCK = 50  # steps between two looks at where the orbit is
NEAR = 1 - 1e-6  # cosine of the angle to the attracting motion, in the metric of the energy, at which a crossing ends
BODIES = {
    "top": nh.SuslovTop([[1.4, 0.2, 0.5], [0.2, 1.0, -0.3], [0.5, -0.3, 0.9]]),
    "sleigh": nh.ChaplyginSleigh(mass=1.0, inertia=1.0, a=0.5),
}


class Live:
    """A run that is kept alive."""

    def __init__(self, discrete: nh.Discretization, number: int, *, reverse: bool) -> None:
        self.step, self.reverse, self.rng = discrete.route, reverse, np.random.default_rng(number)
        place = 0 if discrete.order == 2 else 6  # of the momenta that were computed last in the array of a run
        self.momenta, self.lost = slice(place, place + 2), slice(place + 2, place + 4)
        system = discrete.system.canonical
        scale = float(self.step.scale)
        (b11, b12), (_, b22) = system.constrained_inertia.astype(np.longdouble)  # its inverse in doubles is a bias
        self.metric = np.array([[b22, -b12], [-b12, b11]]) / ((b11 * b22 - b12 * b12) * scale**2)
        self.half = scale * np.linalg.cholesky(system.constrained_inertia)
        steady = np.linalg.solve(
            self.half, scale * system.restrict(system.inertia_operator @ nh.equilibria(system).attracting)
        )
        self.end = steady / np.linalg.norm(steady)
        self.across = np.array([-self.end[1], self.end[0]])
        self.rows = tuple(np.empty((1, size)) for size in kernels.sizes(self.step.body))
        self.total, self.crossings = np.longdouble(0), 0
        self.begin(2 * np.pi * (number + 0.4) / STARTS)

    def begin(self, angle: float) -> None:
        """Start at an angle from the repelling motion, on the level of unit energy."""
        m = self.half @ (np.sin(angle) * self.across - np.cos(angle) * self.end)
        self.put(m)
        self.first = self.energy()

    def put(self, m: np.ndarray) -> None:
        """Set the momenta."""
        _, self.state = kernels.runs_of(self.step.body).start(self.step.body, m, np.array([1.0, 0.0, 0.0, 0.0]))

    def energy(self) -> np.longdouble:
        """Return twice the energy."""
        m = self.state[self.momenta].astype(np.longdouble) - self.state[self.lost]
        return m @ self.metric @ m

    def error(self) -> float:
        """Return the relative change of the energy over all crossings."""
        return float(self.total + self.energy() / self.first - 1)

    def run(self, steps: int) -> None:
        """Take steps, and continue from elsewhere at the end of each crossing."""
        for _ in range(steps // BLOCK):
            _, code = kernels.runs_of(self.step.body).advance(self.step.body, self.state, BLOCK, BLOCK, self.rows)
            if code != 0:
                raise SystemExit(f"the run ended: {nh.Outcome(code)}")
            if self.end @ np.linalg.solve(self.half, self.state[self.momenta]) > NEAR:
                self.turn()

    def turn(self) -> None:
        """Reverse the motion, or start the next crossing."""
        self.crossings += 1
        if self.reverse:  # of order 2: the state of a composition has no place for compensations of its first momenta
            compensations = self.state[self.lost].copy()
            self.put(-self.state[self.momenta])
            self.state[self.lost] = -compensations
            return
        self.total += self.energy() / self.first - 1
        self.begin(self.rng.choice([-1, 1]) * 10 ** self.rng.uniform(-3, -1))


def measure(name: str, counts: list[int], time_step: float, order: int, *, reverse: bool) -> None:
    """Print the error at each count, the exponent between counts, and the law that fits."""
    discrete = nh.discretize(BODIES[name], time_step, order=order)
    runs = [Live(discrete, number, reverse=reverse) for number in range(STARTS)]
    result, before = [], 0
    print(f"{name}, time step {time_step}, order {order}")
    for count in counts:
        for run in runs:
            run.run(count - before)
        errors = np.array([run.error() for run in runs])
        result.append(np.sqrt(np.mean(errors**2)))
        slope = f"exponent {np.log10(result[-1] / result[-2]):5.2f}, " if before else 16 * " "
        print(
            f"  {count:8.0e} steps: rms {result[-1]:.2e}, {slope}mean {errors.mean():+.1e}, "
            f"largest {np.abs(errors).max():.1e}, {sum(run.crossings for run in runs) // STARTS} crossings each"
        )
        before = count
    exponent, constant = np.polyfit(np.log(counts), np.log(result), 1)
    print(f"  fit: {np.exp(constant):.1e} N^{exponent:.2f}; 0.5 is a random walk of roundings, 1 a constant loss")


if __name__ == "__main__":
    parser = options(__doc__)
    parser.add_argument(
        "--steps", type=float, default=small(1e7, 1e5), help="largest number of steps, a power of ten from 1e5 on"
    )
    parser.add_argument("--time-step", type=float, default=0.1)
    parser.add_argument("--body", choices=[*BODIES], action="append")
    parser.add_argument("--order", type=int, choices=(2, 4, 6, 8), default=2)
    parser.add_argument("--reverse", action="store_true", help="reverse at the end of a crossing, do not restart")
    chosen = parser.parse_args()
    if chosen.reverse and chosen.order > 2:
        parser.error("--reverse needs order 2")
    wanted = [10**k for k in range(small(5, 4), round(np.log10(chosen.steps)) + 1)]
    for body in chosen.body or BODIES:
        measure(body, wanted, chosen.time_step, chosen.order, reverse=chosen.reverse)
