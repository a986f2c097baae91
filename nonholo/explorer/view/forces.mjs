// Bodies under a weight, friction and a table: their sliders, the numbers that `flat_forced_run` of nonholo.kernels takes,
// and their balance of energy. F is constant in space and acts at the point x of the body, U = -F . (g x); friction is -C w.

import { literal } from "./literal.mjs";
import { tableOf } from "./table.mjs";

const BODY = 8; // places before the forces
const list = (values) => `[${values.map(literal).join(", ")}]`;
const indexed = (name, n) => Array.from({ length: n }, (_, i) => `${name}${i + 1}`);
const OWN = {
  top: {
    n: 3,
    frictions: ["friction against turning about body axis 1", "friction against turning about body axis 2"],
    coefficients: ({ c1, c2 }) => [c2, c1],
    along: ([f1, f2]) => [f2, -f1],
    lever: ([x1, x2, x3]) => [x3, 0, -x1, 0, x3, -x2],
    point: ([x1, x2, x3]) => [x1, x2, x3],
  },
  sleigh: {
    n: 2,
    frictions: ["friction against turning", "friction against sliding along the blade"],
    coefficients: ({ c1, c2 }) => [c1, c2],
    along: ([f1, f2]) => [f1, f2],
    lever: ([x1, x2]) => [-x2, x1, 0, 1, 0, 0],
    point: ([x1, x2]) => [x1, x2, 1],
    /** The momentum along the blade of a displacement: half an impulse stands between it and that of the node. */
    onLocus: (body) => (p, h, r1, r2, y1, y2) =>
      body.onLocus(p, h, 0, (2 * p.mass * (y2 - p.a * y1 * y1)) / (1 + y1 * y1) / h, y1),
  },
};

/** A body that has sliders for forces as well, for those of a table if one is given; without any it moves as the body does. */
export function underForces(body, given) {
  const own = OWN[body.kind], acting = tableOf(given), keys = { F: indexed("F", own.n), x: indexed("x", own.n) };
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
  /** The work of friction and of a row of the table over a step with X = 2 y / w. */
  const done = (p, h, [y1, y2], [f1, f2]) => {
    const share = 2 / (1 + y1 * y1 + (own.n === 3 ? y2 * y2 : 0)), [x1, x2] = [share * y1, share * y2], [c1, c2] = own.coefficients(p);
    return f1 * x1 + f2 * x2 - (c1 * x1 ** 2 + c2 * x2 ** 2) / h;
  };
  /** Forces of the rows along those of the kernel, and after them nothing. */
  const rowsOf = (p) => {
    const rows = Array.from({ length: acting.count }, (_, k) => own.along(acting.at(p, k)));
    return [rows.length + 1, ...rows.flat(), 0, 0];
  };
  /** What acts, as Python and TOML write it: the table to the end of the run, and one row more for the last displacement. */
  const acts = ({ parameters: p, steps }) => {
    const count = Math.max(steps, Math.min(acting.count, steps + 1)), rows = Array.from({ length: count }, (_, k) => list(acting.at(p, k)));
    return {
      gravity: of(p, "F").some(Boolean) && [list(of(p, "F")), list(of(p, "x"))],
      friction: Boolean(p.c1 || p.c2) && list([p.c1, p.c2, 0]),
      table: Boolean(p.s) && `[\n  ${rows.join(",\n  ")},\n]`,
    };
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
      ...(given ? [{ key: "s", label: "s", name: "scale of the table of forces", min: -2, max: 2, step: 0.01, isForce: true, fallback: 0 }] : []),
    ],
    tableName: given?.name,
    /** The force of a table over a step. */
    acting: given && ((p, k) => acting.at(p, k)),
    refusal: (p) => body.refusal(p) || (p.c1 >= 0 && p.c2 >= 0 ? "" : "Friction must not be negative: it would add energy."),
    table(p, h) {
      const [c1, c2] = own.coefficients(p), force = of(p, "F"), heavy = force.some(Boolean);
      const numbers = body.table(p), weight = heavy ? [...force, 0].slice(0, 3).concat(own.lever(of(p, "x"))) : new Array(9).fill(0);
      const first = [...numbers, ...new Array(BODY - numbers.length).fill(0), heavy ? own.n : 0, Number(Boolean(c1 || c2))];
      return [...first, h / 2, h * body.share, c1, 0, 0, c2, ...weight, ...rowsOf(p)];
    },
    onLocus: own.onLocus?.(body) ?? body.onLocus.bind(body),
    /** Where the force acts, and the force, both in space. */
    weight: (p, pose) => [placed(p)(pose), of(p, "F")].map((vector) => [...vector, 0].slice(0, 3)),
    /** Kinetic and whole energy of the states, the work of friction and table up to them, what is missing in the sum. */
    balance({ parameters: p, time_step: h }, { count, r, y, g }) {
      const potential = potentialOf(p), [kinetic, energy, work, error] = Array.from({ length: 4 }, () => new Float64Array(count));
      for (let k = 0; k < count; k++) {
        kinetic[k] = body.energy(p, r[2 * k], r[2 * k + 1]);
        energy[k] = kinetic[k] + potential(g.subarray(4 * k, 4 * k + 4));
        if (k + 1 < count) work[k + 1] = work[k] + done(p, h, y.subarray(2 * k), own.along(acting.at(p, k)));
      }
      const most = kinetic.reduce((a, b) => Math.max(a, b), 0);
      energy.forEach((e, k) => (error[k] = most ? Math.abs(e - energy[0] - work[k]) / most : 0));
      return { kinetic, energy, work, error };
    },
    python: (state) => {
      const { gravity, friction, table } = acts(state), forces = [friction && `nh.Friction(${friction})`, table].filter(Boolean);
      const parts = [body.python(state), gravity && `potential=nh.Gravity(force=${gravity[0]}, point=${gravity[1]})`];
      if (forces.length) parts.push(`force=${forces[1] ? `(${forces.join(", ")})` : forces[0]}`);
      return `nh.Forced(\n${parts.filter(Boolean).map((part) => `    ${part},\n`).join("")})`;
    },
    /** The table `forces` of a scenario. */
    forces: (state) => {
      const { gravity, friction, table } = acts(state), weight = gravity && `{force = ${gravity[0]}, point = ${gravity[1]}}`;
      const lines = Object.entries({ gravity: weight, friction, table }).filter(([, text]) => text).map(([key, text]) => `${key} = ${text}\n`);
      return lines.length ? `\n[forces]\n${lines.join("")}` : "";
    },
  };
}

/** What the phase portrait shows in place of a continuous motion: levels up to the largest kinetic energy. */
export const levelsOf = (flow, { kinetic }) => ({
  ...flow, size: Math.sqrt(2 * kinetic.reduce((a, b) => Math.max(a, b), 0)), at: () => [NaN, NaN], attracting: null, isForced: true,
});
