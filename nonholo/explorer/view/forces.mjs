// Bodies under a weight and friction: their sliders, the numbers that `flat_forced_run` of nonholo.kernels takes, and
// their balance of energy. F is constant in space and acts at the point x of the body, U = -F . (g x); friction is -C w.

import { literal } from "./literal.mjs";

const BODY = 8; // places before the forces
const list = (values) => `[${values.map(literal).join(", ")}]`;
const indexed = (name, n) => Array.from({ length: n }, (_, i) => `${name}${i + 1}`);
const OWN = {
  top: {
    n: 3,
    frictions: ["friction against turning about body axis 1", "friction against turning about body axis 2"],
    coefficients: ({ c1, c2 }) => [c2, c1],
    lever: ([x1, x2, x3]) => [x3, 0, -x1, 0, x3, -x2],
    inertia: (p) => [p.J11 + p.J33, p.J12, p.J22 + p.J33],
    point: ([x1, x2, x3]) => [x1, x2, x3],
  },
  sleigh: {
    n: 2,
    frictions: ["friction against turning", "friction against sliding along the blade"],
    coefficients: ({ c1, c2 }) => [c1, c2],
    lever: ([x1, x2]) => [-x2, x1, 0, 1, 0, 0],
    inertia: (p) => [p.inertia + p.mass * p.a * p.a, 0, p.mass],
    point: ([x1, x2]) => [x1, x2, 1],
    /** The momentum along the blade of a displacement: half an impulse stands between it and that of the node. */
    onLocus: (body) => (p, h, r1, r2, y1, y2) =>
      body.onLocus(p, h, 0, (2 * p.mass * (y2 - p.a * y1 * y1)) / (1 + y1 * y1) / h, y1),
  },
};

/** A body that has sliders for forces as well; without any it moves as the body does. */
export function underForces(body) {
  const own = OWN[body.kind], keys = { F: indexed("F", own.n), x: indexed("x", own.n) };
  const of = (p, name) => keys[name].map((key) => p[key]);
  const slider = (key, name, least, most) => ({ key, label: `${key[0].replace("c", "C")}${"₁₂₃"[key[1] - 1]}`, name, min: least, max: most, step: 0.01, isForce: true });
  const placed = (p) => {
    const x = own.point(of(p, "x"));
    return (pose) => body.configuration(pose).slice(0, own.n).map((row) => row.reduce((sum, entry, i) => sum + entry * x[i], 0));
  };
  const potentialOf = (p) => {
    const place = placed(p), force = of(p, "F");
    return (pose) => place(pose).reduce((sum, x, i) => sum - force[i] * x, 0);
  };
  const power = (p, r1, r2) => {
    const [b11, b12, b22] = own.inertia(p), [c1, c2] = own.coefficients(p), det = b11 * b22 - b12 * b12;
    return -c1 * ((b22 * r1 - b12 * r2) / det) ** 2 - c2 * ((b11 * r2 - b12 * r1) / det) ** 2;
  };
  return {
    ...body,
    isForced: true,
    name: `${body.name}, under forces`,
    parameters: [
      ...body.parameters,
      ...keys.F.map((key, i) => slider(key, `force in space along axis ${i + 1}`, -5, 5)),
      ...keys.x.map((key, i) => slider(key, `coordinate ${i + 1} of the body point where the force acts`, -1, 1)),
      ...own.frictions.map((name, i) => slider(`c${i + 1}`, name, 0, 2)),
    ],
    refusal: (p) => body.refusal(p) || (p.c1 >= 0 && p.c2 >= 0 ? "" : "Friction must not be negative: it would add energy."),
    table(p, h) {
      const [c1, c2] = own.coefficients(p), force = of(p, "F"), heavy = force.some(Boolean);
      const numbers = body.table(p), weight = heavy ? [...force, 0].slice(0, 3).concat(own.lever(of(p, "x"))) : new Array(9).fill(0);
      const first = [...numbers, ...new Array(BODY - numbers.length).fill(0), heavy ? own.n : 0, Number(Boolean(c1 || c2))];
      return [...first, h / 2, h * body.share, c1, 0, 0, c2, ...weight, 1, 0, 0];
    },
    onLocus: own.onLocus?.(body) ?? body.onLocus.bind(body),
    /** Where the force acts, and the force, both in space. */
    weight: (p, pose) => [placed(p)(pose), of(p, "F")].map((vector) => [...vector, 0].slice(0, 3)),
    /** Kinetic and whole energy of the states, the work of friction up to them, and what is missing in the sum. */
    balance({ parameters: p, time_step: h }, { count, r, g }) {
      const potential = potentialOf(p), [kinetic, energy, work, error] = Array.from({ length: 4 }, () => new Float64Array(count));
      for (let k = 0, last = 0; k < count; k++) {
        const now = power(p, r[2 * k], r[2 * k + 1]);
        kinetic[k] = body.energy(p, r[2 * k], r[2 * k + 1]);
        energy[k] = kinetic[k] + potential(g.subarray(4 * k, 4 * k + 4));
        work[k] = k ? work[k - 1] + (h * (last + now)) / 2 : 0;
        last = now;
      }
      const most = kinetic.reduce((a, b) => Math.max(a, b), 0);
      energy.forEach((e, k) => (error[k] = most ? Math.abs(e - energy[0] - work[k]) / most : 0));
      return { kinetic, energy, work, error };
    },
    python: (state) => {
      const p = state.parameters, heavy = of(p, "F").some(Boolean), rubs = p.c1 || p.c2;
      const gravity = heavy ? [`potential=nh.Gravity(force=${list(of(p, "F"))}, point=${list(of(p, "x"))})`] : [];
      const parts = [body.python(state), ...gravity, ...(rubs ? [`force=nh.Friction(${list([p.c1, p.c2, 0])})`] : [])];
      return `nh.Forced(\n${parts.map((part) => `    ${part},\n`).join("")})`;
    },
  };
}

/** What the phase portrait shows in place of a continuous motion: levels up to the largest kinetic energy. */
export const levelsOf = (flow, { kinetic }) => ({
  ...flow, size: Math.sqrt(2 * kinetic.reduce((a, b) => Math.max(a, b), 0)), at: () => [NaN, NaN], attracting: null, isForced: true,
});
