// What the views show, in words and formulas. The formulas are MathML, which browsers set by themselves.

const i = (name) => `<mi>${name}</mi>`;
const o = (sign) => `<mo>${sign}</mo>`;
const n = (value) => `<mn>${value}</mn>`;
const sub = (base, index) => `<msub>${i(base)}<mrow>${index}</mrow></msub>`;
const sup = (base, power) => `<msup>${base}<mrow>${power}</mrow></msup>`;
const frac = (above, below) => `<mfrac><mrow>${above}</mrow><mrow>${below}</mrow></mfrac>`;
const math = (...parts) => `<math display="block"><mrow>${parts.join("")}</mrow></math>`;
const next = i("k") + o("+") + n(1);
const perp = sup(i("y"), o("⊥"));
const square = sup(`<mrow>${o("|")}${i("y")}${o("|")}</mrow>`, n(2));
const transposed = (matrix) => sup(matrix, i("T"));

const ENERGY = (formula) => `<p>The relative error of the energy at each step, on a logarithmic axis; zeros stand on its floor.
  The discrete map conserves the energy exactly, so what is seen is rounding. The dashed line is the spacing of double
  precision, 2.2·10<sup>−16</sup>.</p>${formula}`;

const SETTLES = " The dark rod is the axis of permanent rotation, to which the motion settles.";

export const WORDS = {
  top: {
    body: `<p>A rigid body about a fixed point that may not spin about the <em class="accent">axis with the ball</em>, which is fixed in the body. It is drawn as
      the ellipsoid of its mass tensor. The tip of the axis leaves its trace on the unit sphere, from violet to yellow.${SETTLES} Each pose is the one before, times a displacement W whose Cayley coordinates y solve two quadratics:</p>
      ${math(i("B"), i("y"), o("+"), o("("), i("c"), o("·"), perp, o(")"), perp, o("="), o("("), n(1), o("+"), square, o(")"), frac(i("h"), n(2)), i("r"), o(","), sub("g", next), o("="), sub("g", i("k")), sub("W", i("k")))}`,
    phase: `<p>The two momenta r along the constraint. Dots are the states of the discrete map; the ring moves with the continuous motion, which
      runs on the <em class="flow">orange ellipse</em> of its energy in closed form. Gray ellipses are other energies. The full line is made of attracting
      permanent rotations, the dashed one of repelling ones. Drag anywhere to start there. “10,000” runs as many motions at once, with the same kernel.</p>
      ${math(i("r"), o("′"), o("="), i("r"), o("−"), frac(n(4) + o("(") + i("c") + o("·") + perp + o(")"), i("h") + o("(") + n(1) + o("+") + square + o(")")), perp)}`,
    surface: `<p>The momenta of all displacements form a Steiner surface of degree four, the image of a projective plane. The orbit jumps on it from
      point to point. Several sheets over one point are the several values of the discrete map; where the surface folds, a value ends. Only the part near
      the orbit is shown, each axis in its own scale; “whole” unfolds all of it. “values” draws the line of all momenta over the present
      one along the constraint: where it meets the surface are the real values, of four in all; the map takes the one with the orange ball.
      The phase portrait then is the darker, the more values are real.</p>
      ${math(i("h"), i("M"), o("="), i("W"), i("J"), o("−"), i("J"), transposed(i("W")))}`,
    energy: ENERGY(math(i("E"), o("="), frac(n(1), n(2)), transposed(i("r")), sup(i("B"), o("−") + n(1)), i("r"))),
  },
  sleigh: {
    body: `<p>A rigid body in the plane on a blade that cannot slip sideways. The dark edge is the blade, the light dot its contact point, the
      <em class="accent">ball</em> the center of mass; the ribbon is the track, from violet to yellow. Where the blade reverses the track has a cusp.
      With t the tangent of half the step angle, each step solves a cubic:</p>
      ${math(i("p̂"), sup(i("t"), n(3)), o("−"), i("π"), sup(i("t"), n(2)), o("+"), o("("), n(2), i("J"), o("+"), i("p̂"), o(")"), i("t"), o("−"), i("π"), o("="), n(0), o(","), i("p̂"), o("="), i("a"), sub("p", n(1)), o("+"), n(2), i("m"), sup(i("a"), n(2)))}`,
    phase: `<p>The angular momentum π about the contact point and the momentum p₁ along the blade. Dots are the states of the discrete map; the ring
      moves with the continuous motion, which runs on the <em class="flow">orange ellipse</em> of its energy in closed form. The full line is straight motion
      with the mass in front, which attracts; the dashed one is the mass behind. Drag anywhere to start there. “10,000” runs as many motions at once, with the same kernel.</p>
      ${math(sup(i("π"), o("·")), o("="), o("−"), i("a"), i("ω"), sub("p", n(1)), o(","), sub(`ṗ`, n(1)), o("="), i("m"), i("a"), sup(i("ω"), n(2)))}`,
    surface: `<p>The momenta of all displacements form Plücker's conoid, a cubic surface ruled by lines that meet one axis. The orbit jumps on it
      from point to point. Several sheets over one point are the several values of the discrete map. Only the part near the orbit is shown, each axis in its own
      scale; “whole” shows all step angles. “values” draws the line of all momenta over the present one along the constraint: where it
      meets the surface are the real values, three inside the deltoid of the phase portrait, one outside; the map takes the one with the orange ball.</p>
      ${math(i("X"), o(":"), i("Y"), o("="), i("cos"), frac(i("Δ"), n(2)), o(":"), i("sin"), frac(i("Δ"), n(2)), o(","), i("Z"), o("="), i("J"), i("sin"), i("Δ"))}`,
    energy: ENERGY(math(i("E"), o("="), frac(sup(i("π"), n(2)), n(2) + o("(") + i("J") + o("+") + i("m") + sup(i("a"), n(2)) + o(")")), o("+"), frac(`<msubsup>${i("p")}${n(1)}${n(2)}</msubsup>`, n(2) + i("m")))),
  },
  replay: {
    body: `<p>The motion was computed by nonholo and is replayed from numbers in this file, as the line below says why. The ribbon is the path, from violet to
      yellow. On a plane the body is its outline as in pictures, with wheels and blades in black; in space it is the box with its mass tensor, or a ball, with
      its three axes. A system without a body is a ball at its place. Elsewhere the body axes are drawn; in more than three dimensions their first three coordinates.</p>`,
    phase: "<p>The first two momenta along the constraint. Dots are the saved states, from violet to yellow.</p>",
    energy: "<p>The relative change of the energy since the first state, on a logarithmic axis; zeros stand on its floor. The dashed line is the spacing of double precision, 2.2·10<sup>−16</sup>.</p>",
  },
};

const dot = o("(") + i("c") + o("·") + i("y") + o(")");
WORDS.top4 = {
  body: `<p>A rigid body about a fixed point of four-dimensional space that may turn only in planes through one of its own axes, the
    <em class="accent">orange one</em>. Its four axes are seen along the fourth direction of space, so they lie in a ball of radius one. The ball at a tip is
    the larger, the more its axis points along that direction. The tip of the orange axis leaves its trace, from violet to yellow. Each pose is the one before,
    times a turn W in one plane with Cayley coordinates y:</p>
    ${math(i("B"), i("y"), o("−"), dot, i("y"), o("+"), square, i("c"), o("="), o("("), n(1), o("+"), square, o(")"), frac(i("h"), n(2)), i("r"), o(","), sub("g", next), o("="), sub("g", i("k")), sub("W", i("k")))}
    <p>Body axes are those in which B is diagonal, with the entries J₁₁ + J₄₄, J₂₂ + J₄₄ and J₃₃ + J₄₄; c = (J₁₄, J₂₄, J₃₄).</p>`,
  phase: `<p>The first two of the three momenta r along the constraint. Dots are the states of the discrete map; the ring moves with the continuous motion, the <em class="flow">orange
    curve</em>, which has no closed form here: the page computes its Taylor series. Ellipses are the outlines of the ellipsoids of equal energy. The full line is made of attracting permanent rotations, the dashed one of repelling ones. Drag anywhere to start there, with the same r₃.</p>
    ${math(i("r"), o("′"), o("="), i("r"), o("+"), frac(n(4), i("h") + o("(") + n(1) + o("+") + square + o(")")), o("("), dot, i("y"), o("−"), square, i("c"), o(")"))}`,
  surface: `<p>The three momenta run on the ellipsoid of their energy; each axis is in its own scale, so it is drawn as a ball. On it stand the two permanent rotations of this
    energy, with the velocity along c: from the gray one motions come, to the dark one they go.</p>
    ${math(transposed(i("r")), sup(i("B"), o("−") + n(1)), i("r"), o("="), n(2), i("E"))}`,
  energy: WORDS.top.energy,
};

const KICK = math(sub("p", next), o("="), sub("K", next), o("("), `<msubsup>${i("Ad")}<mrow>${sub("W", i("k"))}</mrow>${o("∗")}</msubsup>`, sub("K", i("k")), o("("), sub("p", i("k")), o(")"), o(")"));
const BALANCE = math(i("T"), o("+"), i("U"), o("−"), i("W"), o("="), i("const"), o(","), i("U"), o("="), o("−"), i("F"), o("·"), o("("), i("g"), i("x"), o(")"), o(","),
  i("Ẇ"), o("="), o("−"), i("ω"), o("·"), i("C"), i("ω"), o("≤"), n(0));
const PUSHED = `<p>Forces act as half an impulse of each step before it and after it, K, with the free step between them. The <b>arrow</b> is the force F, which is
  constant in space and acts at the body point x, like a weight. Friction is −C times each velocity; its part of the step is solved exactly. Where the page has a table of forces, its row k acts over step k, times s.</p>${KICK}`;
const forced = (words, ends) => ({
  ...words,
  body: `${PUSHED}${words.body.replace(SETTLES, "")}`,
  phase: `<p>The two momenta ${ends} along the constraint, at the nodes: between the half impulses of two steps. Dots are the states. Gray ellipses are levels of the
    kinetic energy, the largest one among them; no energy is conserved here, and no continuous motion in closed form is drawn. Drag anywhere to start
    there. “10,000” starts as many motions at once in the same pose, with the same kernel: under friction without a force they come to rest.</p>`,
  surface: `${words.surface.split(" “values”")[0]}</p>${words.surface.slice(words.surface.indexOf("<math"))}<p>The points are those of the displacements; half an impulse stands between them and the momenta at the nodes.</p>`,
  energy: `<p>Energy is <em>not</em> conserved under forces. Dots are the whole energy T + U, the gray line is the kinetic energy T. The
    <em class="flow">dashed line</em> is the first energy with the work W of friction, which only takes, and of a table: a weight alone moves energy between T and U. Dots and dashes agree up
    to an error that falls with the square of the time step; the status line has the largest one, as a part of the largest kinetic energy.</p>${BALANCE}`,
});
WORDS.forced_top = forced(WORDS.top, "r");
WORDS.forced_sleigh = forced(WORDS.sleigh, "π and p₁");

export const PRESETS = [
  { name: "Top: from one permanent rotation to the other", kind: "top", parameters: { J11: 1.4, J12: 0.2, J13: 0.5, J22: 1, J23: -0.3, J33: 0.9 }, momentum: [1.632, -0.7335], time_step: 0.1, steps: 800 },
  { name: "Top: large steps, the surface unfolds", kind: "top", parameters: { J11: 1.4, J12: 0.2, J13: 0.5, J22: 1, J23: -0.3, J33: 0.9 }, momentum: [1.2, -0.5], time_step: 0.9, steps: 120 },
  { name: "Top: all values over a momentum", kind: "top", parameters: { J11: 1.4, J12: 0.2, J13: 0.5, J22: 1, J23: -0.3, J33: 0.9 }, momentum: [0.7, -0.45], time_step: 1.2, steps: 40, values: true },
  { name: "Top: balanced, steady rotation", kind: "top", parameters: { J11: 1.4, J12: 0, J13: 0, J22: 1, J23: 0, J33: 0.6 }, momentum: [1, 0.6], time_step: 0.1, steps: 300 },
  { name: "Top: no real branch", kind: "top", parameters: { J11: 1.4, J12: 0.2, J13: 0.5, J22: 1, J23: -0.3, J33: 0.9 }, momentum: [2.4, -1.1], time_step: 1.6, steps: 100 },
  { name: "Sleigh: turns round through a cusp", kind: "sleigh", parameters: { mass: 1, inertia: 1, a: 0.5 }, momentum: [0.0625, -1], time_step: 0.1, steps: 300 },
  { name: "Sleigh: a loop and away", kind: "sleigh", parameters: { mass: 1, inertia: 1, a: 0.2 }, momentum: [1.2, -0.7], time_step: 0.1, steps: 500 },
  { name: "Sleigh: three values inside a deltoid", kind: "sleigh", parameters: { mass: 1, inertia: 1, a: 0.4 }, momentum: [0.2, -1.2], time_step: 1, steps: 30, values: true },
  { name: "Sleigh: balanced, circles", kind: "sleigh", parameters: { mass: 1, inertia: 1, a: 0 }, momentum: [0.5, 1], time_step: 0.2, steps: 100 },
  { name: "Top under its weight", kind: "forced_top", parameters: { J11: 1, J12: 0, J13: 0.1, J22: 1.2, J23: 0, J33: 0.7, F1: 0, F2: 0, F3: -1, x1: 0, x2: 0.1, x3: 0.4, c1: 0, c2: 0 }, momentum: [0.3, 0.4], time_step: 0.05, steps: 600 },
  { name: "Top: a weight that comes to rest", kind: "forced_top", parameters: { J11: 1, J12: 0, J13: 0, J22: 1.2, J23: 0, J33: 0.7, F1: 0, F2: 0, F3: -1, x1: 0, x2: 0, x3: 0.6, c1: 0.15, c2: 0.3 }, momentum: [0.4, 0.3], time_step: 0.05, steps: 800 },
  { name: "Sleigh: friction brings it to rest", kind: "forced_sleigh", parameters: { mass: 1, inertia: 1, a: 0.5, F1: 0, F2: 0, x1: 0.5, x2: 0, c1: 0.05, c2: 0.1 }, momentum: [0.0625, -1.5], time_step: 0.1, steps: 400 },
  { name: "Sleigh: a knife edge on a slope", kind: "forced_sleigh", parameters: { mass: 1, inertia: 1, a: 0, F1: 0, F2: -0.5, x1: 0, x2: 0, c1: 0, c2: 0 }, momentum: [0.5, 0], time_step: 0.1, steps: 400 },
  { name: "Sleigh: no real branch", kind: "sleigh", parameters: { mass: 1, inertia: 1, a: 0.5 }, momentum: [1.9, -1.5], time_step: 1.2, steps: 60 },
];
