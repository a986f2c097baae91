r"""The tree of all images under the multivalued map, and how fast the images of the plane sleigh become more.

The tree has images, images of images, over real and complex displacements; the values over one momentum come from
`_values`. Its growth: words of branches that map one interval into disjoint parts. On a level of the energy with
$R = \sqrt{2E}$ the momenta $\pi = \sqrt I\,R\cos\phi$, $p_1 = \sqrt m\,R\sin\phi$ with $e^{i\phi} = ie^x$, x real, stay
such momenta on all three branches. Reference: docs/theory/branches.md, Theorem 5.3.
"""

import dataclasses
import math
from collections.abc import Callable
from typing import Any, NamedTuple

import numpy as np
import scipy  # its parts load on first use

from nonholo.base.checks import error, flags, natural, needs, positive
from nonholo.base.results import result
from nonholo.base.types import Array, Bool, Float, Int
from nonholo.discrete._discretization import Discretization, as_discretization
from nonholo.discrete._scheme import legendre
from nonholo.discrete.branching._sections import AnyFrame, frame_for
from nonholo.discrete.branching._values import checked_point, roots_over

_LONGEST = 1000  # steps of a word
_BITS = 128  # of the balls
_BELOW = 1 - 2.0**-40  # of the highest energy, so that balls can tell
_WIDER = 1 + 2.0**-40  # of radii in doubles
_CLOSE = 1 - 2.0**-10  # how close to the image of the equilibrium an end is

Words = tuple[tuple[int, ...], ...]


@result
class BranchGrowth:
    r"""Words of branches of the plane sleigh and what they say of the number of images.

    Attributes:
        words: Branches in the order of the steps, by $\tau = \tan(\Delta/2)/i$: 0 is the principal one with
            $|\tau| < 1$, 1 and -1 are those with $\tau > 1$ and $\tau < -1$.
        discs: Center and radius, in x, of an interval and of its image under each word: the images are disjoint parts
            of it, and words are one to one. Rounded to doubles.
        rate: L with $\sum_w L^{-|w|} = 1$, |w| the steps of a word: general momenta have at least $cL^N$ different
            images after N steps.
        energy: The level.
        certified: Whether ball arithmetic has proved it.
    """

    words: Words
    discs: Float[np.ndarray, "d 2"]
    rate: float
    energy: float
    certified: bool

    @property
    def entropy(self) -> float:
        """The logarithm of the rate, a lower bound of the topological entropy of the map on the level."""
        return math.log(self.rate)


class Axis(NamedTuple):
    r"""The map of x, with the root $\tau$ of the cubic as its parameter; each branch of x grows with it.

    Attributes:
        turn: $\kappa = \sqrt{ma^2/I}$.
        lift: $\sqrt{2I/E}/h$.
        number: Makes the two numbers: doubles, or balls whose comparisons are true only if they are certain.
        functions: What has their functions.
    """

    turn: Any
    lift: Any
    number: Any = float
    functions: Any = math

    @classmethod
    def of(cls, body: tuple[float, ...], number: Any = float, functions: Any = math) -> "Axis":
        """Return the map for m, J, a, h and E."""
        mass, inertia, arm, step, energy = map(number, body)
        whole, sqrt = inertia + mass * arm * arm, functions.sqrt
        return cls(sqrt(mass * arm * arm / whole), sqrt(2 * whole / energy) / step, number, functions)

    def ends(self, tau: float) -> tuple[Any, Any]:
        """Return x before and after the step."""
        t, f = self.number(tau), self.functions
        k = self.turn * t
        middle, half = f.asinh(self.lift * t * f.sqrt(1 - k * k) / (1 - t * t)), f.atanh(k)
        return middle + half, middle - half

    def rises(self, tau: float) -> bool:
        """Return whether x after the step grows with x before it; of tau > 1, from there down to 1."""
        square = self.number(tau) ** 2
        k = self.turn**2 * square
        return bool((self.lift * (1 - k)) ** 2 * ((1 + square) ** 2 - 4 * k) > (self.turn * (1 - square) ** 2) ** 2)

    def around(self, x: Any, *, outer: bool = False) -> tuple[float, float]:
        """Return two tau close together, the x of one below and of the other above a given one."""
        turn = float(self.turn)
        low, high = (1 + 2.0**-50, (1 - 2.0**-50) / turn) if outer else (0.0, 1 - 2.0**-50)
        rough = Axis(turn, float(self.lift))
        tau = _root(lambda t: rough.ends(t)[0] - float(x), low, high)
        for share in 2.0 ** np.arange(-50, 0):
            below, above = tau - float(share) * (tau - low), tau + float(share) * (high - tau)
            if self.ends(below)[0] < x < self.ends(above)[0]:
                return below, above
        raise ArithmeticError

    def onwards(self, ends: tuple[Any, Any]) -> tuple[Any, Any]:
        """Return bounds of the principal image of what lies between two positive x."""
        return self.ends(self.around(ends[0])[0])[1], self.ends(self.around(ends[1])[1])[1]


def branch_growth(discrete: Discretization, certify: bool = False, *, energy: float | None = None) -> BranchGrowth:
    r"""Bound from below how fast the number of images of a plane sleigh under its three branches grows.

    A principal step $\varphi$ and the word $\varphi^j\beta$, a step on another branch and j principal ones, map an
    interval at the attracting equilibrium into disjoint parts of it; with the mirror image of the second word, where
    that gives more, they are three. So there are at least $cL^N$ images after N steps, $1/L + 1/L^{j+1} = 1$ or
    $1/L + 2/L^{j+1} = 1$. Branches that are translations of a commutative group have polynomially many.

    Of tops there is numerical evidence alone: `branch_tree` counts their images.

    Reference: docs/theory/branches.md, Theorem 5.3.

    Args:
        discrete: A discretized `ChaplyginSleigh` with $a \ne 0$, difference "matrix", constraint "skew" or
            "exponential".
        certify: Also prove it in ball arithmetic for the doubles of body, time step and energy; needs the extra
            `certify` (python-flint).
        energy: A level below $2I^2/(ma^2h^2)$, where the approach to the equilibrium does not alternate; by default
            just below it. Words are longer at lower energies.

    Raises:
        ValueError: Another system or discretization; an energy that is too high, or so low that words have more than
            1000 steps; a body with so small a J or $ma^2$ that doubles do not show it; `certify=True` without
            python-flint.

    Example:
        >>> sleigh = nh.discretize(nh.ChaplyginSleigh(mass=1.0, inertia=1.0, a=0.5), time_step=0.1)
        >>> growth = branch_growth(sleigh)
        >>> growth.words, round(growth.rate, 6)
        (((0,), (1, 0, 0), (-1, 0, 0)), 1.695621)
        >>> growth.discs.round(3)  # x of the interval and of its three images
        array([[ 0.   ,  0.241],
               [ 0.   ,  0.007],
               [-0.08 ,  0.034],
               [ 0.08 ,  0.034]])
    """
    flags("branch_growth", certify=certify)
    mass, inertia, arm, step = _sleigh("branch_growth(discrete=...)", discrete)
    moment = mass * arm * arm
    highest = 2 * (inertia + moment) ** 2 / (moment * step * step)
    where = "branch_growth(energy=...)"
    level = highest * _BELOW if energy is None else float(positive(where, energy, "Pass a level of the energy."))
    body = (mass, inertia, arm, step, level)
    try:
        words, discs = _words_in_balls(body) if certify else best_words(Axis.of(body))
    except ArithmeticError:
        got = f"{level:.6g}, with J = {inertia:.6g} and ma^2 = {moment:.6g}"
        requirement = f"be below {highest:.6g} and give words of at most {_LONGEST} steps"
        raise error(where, requirement, got, "Pass an energy between these, or a less extreme body.") from None
    return BranchGrowth(words, discs, _rate(words), level, certify)


def _rate(words: Words) -> float:
    return _root(lambda x: sum(x ** -len(word) for word in words) - 1, 1.0, 3.0)


def _sleigh(where: str, discrete: Discretization) -> tuple[float, float, float, float]:
    """Return m, J, the size of a, and h."""
    form = as_discretization(where, discrete).system.normal_form
    remedy = "Pass `discretize(ChaplyginSleigh(...), time_step)`; `branch_tree` counts the images of tops."
    if form is None or not form.is_planar or form.arm == 0:  # as of tops
        is_balanced = form is not None and form.is_planar and form.is_sleigh
        got = f"{type(discrete.system).__name__}{', a = 0' * is_balanced}"
        raise error(where, "be a discretized plane sleigh with a != 0", got, remedy)
    if not discrete.conserves_energy:
        got = f"difference={discrete.difference!r}, constraint={discrete.constraint!r}"
        raise error(where, "be the map with three branches", got, "Use the defaults of `discretize`.")
    return float(form.mass), float(form.stiffness[0, 0]), abs(float(form.arm)), float(discrete.time_step)


def _words_in_balls(body: tuple[float, ...]) -> tuple[Words, Float[np.ndarray, "d 2"]]:
    with needs("certify", "branch_growth(certify=...)"):
        from flint import arb, ctx
    with ctx.workprec(_BITS):
        return best_words(Axis.of(body, arb, arb))


def best_words(axis: Axis) -> tuple[Words, Float[np.ndarray, "d 2"]]:
    """Return two words on an interval that ends at the equilibrium, or three around it if their rate is larger."""
    if not axis.lift > axis.turn:
        raise ArithmeticError
    two = _words(axis, 0, _LONGEST)
    longest = min(2 * len(two[0][1]), _LONGEST)  # longer ones would have the smaller rate
    try:
        three = _words(axis, 1, longest)
    except ArithmeticError:
        return two
    return max(two, three, key=lambda pair: _rate(pair[0]))


def _words(axis: Axis, mirror: int, longest: int) -> tuple[Words, Float[np.ndarray, "d 2"]]:
    r"""Return words and discs for $K = [-\rho, 0]$, or mirrored $[-\rho, \rho]$, with $\rho = \varphi^j(\rho_0)$.

    $\beta(K)$ lies in $(-\rho_0, -\varphi(\rho_0))$, whose second end is close to $\beta(0)$; mirrored, both ends are
    as far from it.
    """
    rough = Axis(float(axis.turn), float(axis.lift))
    jump = -rough.ends(rough.around(0.0, outer=True)[0])[1]

    def gap(tau: float) -> float:
        before, after = rough.ends(tau)
        return before + after - 2 * jump if mirror else after - _CLOSE * jump

    outside, inside = axis.ends(_root(gap, 0.0, 1 - 2.0**-50))
    rho = (outside, outside)
    for count in range(1, longest + 1):
        rho = axis.onwards(rho)
        first, last = axis.around(-rho[1], outer=True)[0], axis.around(mirror * rho[1], outer=True)[1]
        image = -axis.ends(last)[1], -axis.ends(first)[1]
        if inside < image[0] and image[1] < outside and axis.rises(last):
            words = ((0,), *((letter, *[0] * count) for letter in (1, -1)[: 1 + mirror]))
            break
    else:
        raise ArithmeticError
    inner = axis.onwards(rho)[1]
    for _ in range(count):
        image = axis.onwards(image)
    ends = [(-rho[0], mirror * rho[0]), (-inner, mirror * inner), (-image[1], -image[0]), image][: 3 + mirror]
    discs = np.array([(float(x + y) / 2, float(y - x) / 2) for x, y in ends])
    discs[1:, 1] *= _WIDER
    return words, discs


def _root(of: Callable[[float], float], low: float, high: float) -> float:
    """Return the zero of an increasing or decreasing function between two numbers."""
    find: Any = scipy.optimize.brentq
    try:
        return float(find(of, low, high, xtol=1e-300, rtol=1e-15))
    except ValueError:
        raise ArithmeticError from None


_MOST = 10_000  # nodes of a tree
_ROUNDING = 1e-12  # relative imaginary part that counts as zero
_SAME = 1e-10  # relative distance of two images that rounding may have parted


@dataclasses.dataclass(frozen=True, eq=False, repr=False)
class BranchTree:
    """All images of a displacement under the multivalued map, generation by generation.

    Nodes are numbered from the root, generation by generation. Images of one generation that agree to a relative
    distance of 1e-10 are one node, whose parent is the first of its parents.

    Attributes:
        displacement: W, complex matrices.
        momentum: P(W), physical.
        level: Generation, 0 at the root.
        parent: Number of the parent, -1 at the root.
        is_real: Which displacements are real.
        counts: Number of distinct images in each generation, 1 for generation 0.
    """

    displacement: Array
    momentum: Array
    level: Int[np.ndarray, "T"]
    parent: Int[np.ndarray, "T"]
    is_real: Bool[np.ndarray, "T"]
    counts: Int[np.ndarray, "levels"]

    def __len__(self) -> int:
        return len(self.level)

    def __repr__(self) -> str:
        return f"<BranchTree: {', '.join(map(str, self.counts))} images, {np.count_nonzero(self.is_real)} of all real>"


def branch_tree(discrete: Discretization, displacement: Any, depth: int) -> BranchTree:
    r"""Find all images of a displacement under the discrete map, all images of these, and so on.

    $$ P(W')|_{\mathfrak{d}} = (\mathrm{Ad}^*_W P(W))|_{\mathfrak{d}}, \qquad W, W' \in S \ \text{complex}. $$

    The images of a Chaplygin sleigh are 3, 9, 27, ..., as far as counted. Images at infinity, and those that are not
    isolated, are left out.

    Reference: docs/theory/branches.md, "The tree of images".

    Args:
        discrete: As in `displacements_over`.
        displacement: The root W, real and on the displacement variety.
        depth: Number of generations, 0 for the root alone.

    Raises:
        ValueError: A displacement off the variety; a negative depth, or one with more than 10,000 images; as
            `displacements_over`.

    Example:
        >>> sleigh = nh.discretize(nh.ChaplyginSleigh(mass=1.0, inertia=1.0, a=0.5), time_step=0.1)
        >>> tree = branch_tree(sleigh, nh.SE(2).exp(np.array([0.3, 0.1, 0.0])), 3)
        >>> tree.counts
        array([ 1,  3,  9, 27])
    """
    frame = frame_for("branch_tree", discrete)
    group = discrete.system.group
    W, _ = checked_point("branch_tree(displacement=...)", frame, displacement)
    generations = [np.array([W - group.identity], dtype=complex)]
    reality, parents = [np.array([True])], [np.array([-1])]
    first = 0
    where = "branch_tree(depth=...)"
    depth = natural(where, depth, "Pass the number of generations, 0 for the root alone.")
    images = frame.equations(np.zeros(discrete.system.rank)).count
    if depth > _MOST or images**depth > _MOST:
        deepest = int(np.log(_MOST) / np.log(images))
        got = f"{depth}, with {images}^{depth} images"
        raise error(where, f"keep the tree below {_MOST} images", got, f"Pass depth={deepest} or less.")
    for _ in range(depth):
        X, is_real, index = _next_generation(frame, generations[-1], reality[-1])
        parents.append(first + index)
        first += len(generations[-1])
        generations.append(X)
        reality.append(is_real)
    counts = np.array([len(X) for X in generations])
    X = np.concatenate(generations)
    return BranchTree(
        displacement=X + group.identity,
        momentum=legendre(discrete, X, "left"),
        level=np.repeat(np.arange(len(counts)), counts),
        parent=np.concatenate(parents),
        is_real=np.concatenate(reality),
        counts=counts,
    )


def _next_generation(frame: AnyFrame, X: Array, is_real: Array) -> tuple[Array, Array, Int[np.ndarray, "G"]]:
    """Return the distinct images of displacements minus the identity, which are real, and the index of the parent."""
    if len(X) == 0:
        return X, is_real, np.zeros(0, dtype=np.int64)
    images = [_images(frame, *node) for node in zip(X, is_real, strict=True)]
    matrices, reality = (np.concatenate(column) for column in zip(*images, strict=True))
    parents = np.repeat(np.arange(len(X)), [len(each) for each, _ in images])
    first = _first_of_equals(matrices * frame.stretch)
    return matrices[first], reality[first], parents[first]


def _images(frame: AnyFrame, X: Array, is_real: Array) -> tuple[Array, Array]:
    system = frame.discrete.system
    r = system.restrict(legendre(frame.discrete, X, "right"))
    if is_real or np.abs(r.imag).max() <= _ROUNDING * np.abs(r).max():
        r = r.real
    _, zeros, increments = roots_over(frame, frame.equations(frame.discrete.time_step * system.to_canonical(r)))
    return increments, np.array([root.is_real for root in zeros], dtype=bool)


def _first_of_equals(X: Array) -> Int[np.ndarray, "G"]:
    """Return the indices of matrices minus the identity, in a unit of length, that repeat none before them."""
    distinct = np.empty_like(X)
    indices: list[int] = []
    for i, candidate in enumerate(X):
        distances = np.abs(distinct[: len(indices)] - candidate).max(axis=(1, 2))
        if not np.any(distances <= _SAME * max(1.0, np.abs(candidate).max())):
            distinct[len(indices)] = candidate
            indices.append(i)
    return np.array(indices, dtype=np.int64)
