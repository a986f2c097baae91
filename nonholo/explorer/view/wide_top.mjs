// The top on SO(4) in the principal axes of its constrained inertia: the numbers that its kernel takes, and its pictures.
// The mass tensor is a diagonal with one row and column, as nonholo.SuslovTop.arrowhead has it.

import { Matrix4 } from "three";
import { literal } from "./literal.mjs";

const AXES = [1, 2, 3];
const inertia = (p) => AXES.map((i) => p[`J${i}${i}`] + p.J44);
const coupling = (p) => AXES.map((i) => p[`J${i}4`]);
const list = (values) => `[${values.map(literal).join(", ")}]`;
const range = (key, min, max) => ({ key, label: `J${[...key.slice(1)].map((i) => "₁₂₃₄"[i - 1]).join("")}`, name: `mass tensor ${key[1]} ${key[2]}`, min, max, step: 0.01 });

const CURVE = 400; // times of the continuous motion at least, and parts of the energy's radius that are seen of it
const bits = new DataView(new ArrayBuffer(8));

/** The next power of two above a number. */
function powerAbove(x) {
  bits.setFloat64(0, x);
  return x > 0 ? 2 ** (((bits.getUint32(0) >>> 20) & 0x7ff) - 1022) : 1;
}

/** The continuous motion from a momentum, as a function of times that begin at zero: the numbers of nonholo.flow. */
function continuous(p, momentum, series) {
  const b = inertia(p), root = b.map(Math.sqrt), rates = b.map((x) => 1 / x), gamma = coupling(p).map((x, i) => x / root[i]);
  const x = momentum.map((r, i) => r / root[i]), pull = gamma.reduce((sum, c, i) => sum + c * x[i], 0);
  const unit = powerAbove(Math.max(...x.map((each, i) => Math.abs(Math.sqrt(rates[i]) * each)), Math.abs(Math.max(...rates) * pull)));
  const user = (rows, at) => [rows[at] * unit * root[0], rows[at + 1] * unit * root[1], rows[at + 2] * unit * root[2]];
  const first = x.map((each) => each / unit);
  return (times) => {
    const own = times.slice(1).map((time) => time * unit), rows = series(rates, gamma, first, own, own.at(-1)), all = [user(first, 0)];
    for (let at = 0; at < rows.length; at += 3) all.push(user(rows, at));
    return all;
  };
}

/** The rows that are apart from the one before by what can be seen, and the last one. */
function seen(rows, least) {
  let [x, y, z] = rows[0];
  return rows.filter((row, k) => {
    const isApart = k === 0 || k === rows.length - 1 || Math.abs(row[0] - x) + Math.abs(row[1] - y) + Math.abs(row[2] - z) > least;
    if (isApart) [x, y, z] = row;
    return isApart;
  });
}

/** Where the permanent rotations of an energy are: the velocity is along c; the second one attracts. */
function permanent(p, energy) {
  const b = inertia(p), c = coupling(p), size = Math.sqrt(c.reduce((sum, x, i) => sum + b[i] * x * x, 0));
  return size ? [1, -1].map((sign) => c.map((x, i) => (sign * b[i] * x * Math.sqrt(2 * energy)) / size)) : [];
}

export const top4 = {
  kind: "top4",
  name: "Suslov top, SO(4)",
  share: 0.5,
  entries: 16,
  momenta: ["r₁", "r₂", "r₃"],
  parameters: [...["J11", "J22", "J33", "J44"].map((key) => range(key, 0.1, 3)), ...["J14", "J24", "J34"].map((key) => range(key, -1, 1))],
  refusal: (p) => (inertia(p).every((b) => b > 0) ? "" : "The inertia along the constraint must be positive: make the diagonal larger."),
  table: (p) => [...inertia(p), ...coupling(p).map((x) => -x), Math.min(...inertia(p))],
  energy: (p, ...r) => inertia(p).reduce((sum, b, i) => sum + (r[i] * r[i]) / b, 0) / 2,
  isPose(pose) {
    const row = (i) => pose.slice(4 * i, 4 * i + 4);
    const isUnit = [0, 1, 2, 3].every((i) => [0, 1, 2, 3].every((j) =>
      Math.abs(row(i).reduce((sum, x, k) => sum + x * row(j)[k], i === j ? -1 : 0)) <= 1e-9));
    return isUnit && new Matrix4().set(...pose).determinant() > 0;
  },
  /** Levels of energy as they are seen along the third momentum, and the continuous motion. */
  flow({ parameters: p, momentum, time_step: h, steps }, series) {
    const b = inertia(p), energy = this.energy(p, ...momentum), ends = permanent(p, energy);
    const back = (u, v) => [Math.sqrt(b[0]) * u, Math.sqrt(b[1]) * v];
    const after = continuous(p, momentum, series), rows = after(Array.from({ length: steps + 1 }, (_, k) => k * h));
    const all = steps < CURVE ? after(Array.from({ length: CURVE + 1 }, (_, k) => (k / CURVE) * steps * h)) : rows;
    const curve = seen(all, Math.sqrt(2 * energy * Math.min(...b)) / CURVE);
    const at = (time) => rows[Math.round(time / h)] ?? [NaN, NaN];
    return { size: Math.sqrt(2 * energy), back, at, attracting: ends[1] ?? null, isLevel: true, rows, curve };
  },
  onLocus: (p, h, r1, r2, r3) => [r1, r2, r3],
  angle: (...y) => 2 * Math.atan(Math.hypot(...y)),
  mesh(p, path, reach, rows = 26, columns = 64) {
    const energy = path.length ? this.energy(p, ...path[0]) : 0.5, axes = inertia(p).map((b) => Math.sqrt(2 * energy * b)), points = [];
    for (let i = 0; i <= rows; i++) {
      const down = (Math.PI * i) / rows, ring = Math.sin(down);
      for (let j = 0; j <= columns; j++) {
        const turn = (2 * Math.PI * j) / columns;
        points.push([axes[0] * ring * Math.cos(turn), axes[1] * ring * Math.sin(turn), axes[2] * Math.cos(down)]);
      }
    }
    return { points, rows: rows + 1, columns: columns + 1, marks: permanent(p, energy) };
  },
  axes: ["r₁", "r₂", "r₃"],
  python: ({ parameters: p }) => `nh.SuslovTop.arrowhead(${list([p.J11, p.J22, p.J33, p.J44])}, ${list(coupling(p))})`,
  configuration: (pose) => [0, 4, 8, 12].map((i) => [...pose.slice(i, i + 4)]),
};

const BODY = { J11: 1.4, J22: 1, J33: 0.7, J44: 0.9, J14: 0.5, J24: -0.3, J34: 0.2 };
export const WIDE_PRESETS = [
  { name: "From one permanent rotation to the other", kind: "top4", parameters: BODY, momentum: [1.8, -0.7, 0.6], time_step: 0.1, steps: 800 },
  { name: "Large steps", kind: "top4", parameters: BODY, momentum: [1.1, -0.3, 0.6], time_step: 0.8, steps: 120 },
  { name: "Balanced, steady rotation", kind: "top4", parameters: { ...BODY, J14: 0, J24: 0, J34: 0 }, momentum: [1, 0.6, -0.4], time_step: 0.1, steps: 300 },
  { name: "No real branch", kind: "top4", parameters: BODY, momentum: [2.4, -1.1, 1], time_step: 1.6, steps: 100 },
];
