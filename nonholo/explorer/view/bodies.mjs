// The bodies that run in the page: of the two whose steps are known in closed form the numbers that their kernels take, and what is drawn of them.
// Formulas and rows are those of nonholo.discrete.routes and nonholo.analysis.planar.

import { underForces } from "./forces.mjs";
import { literal } from "./literal.mjs";
import { top4 } from "./wide_top.mjs";
import { sleighCount, sleighValues, topCount, topValues } from "./values.mjs";

const cholesky = (b11, b12, b22) => {
  const l11 = Math.sqrt(b11), l21 = b12 / l11;
  return [l11, l21, Math.sqrt(b22 - l21 * l21)];
};

const topNumbers = (p) => ({ b11: p.J11 + p.J33, b12: p.J12, b22: p.J22 + p.J33, c1: p.J13, c2: p.J23 });

/** The squared radius of the disc that no fold reaches: suslov_table of nonholo.kernels. */
function certain({ b11, b12, b22, c1, c2 }) {
  const unit = 2 ** Math.floor(Math.log2(Math.max(Math.abs(b11), Math.abs(b12), Math.abs(b22))));
  [b11, b12, b22, c1, c2] = [b11, b12, b22, c1, c2].map((x) => x / unit);
  const middle = (b11 + b22) / 2, spread = Math.hypot((b11 - b22) / 2, b12);
  const high = middle + spread, low = (b11 * b22 - b12 * b12) / high;
  const length = Math.hypot(c1, c2), pull = Math.hypot(b11 * c1 + b12 * c2, b12 * c1 + b22 * c2);
  const a = pull + 2 * length * high, b = low * high;
  let x = 1;
  for (let k = 0; k < 200; k++) {
    const change = (((a * x + b) * x + pull) * x - b) / ((3 * a * x + 2 * b) * x + pull);
    x -= change;
    if (change <= 1e-9 * x) break;
  }
  return (0.999 * Math.min(x, (0.7 * low) / length)) ** 2;
}

const range = (key, label, name, min, max, step = 0.01) => ({ key, label, name, min, max, step });
const matrix = (p) => [[p.J11, p.J12, p.J13], [p.J12, p.J22, p.J23], [p.J13, p.J23, p.J33]];
const rows = (p) => `[${matrix(p).map((row) => `[${row.map(literal).join(", ")}]`).join(", ")}]`;

export const top = {
  kind: "top",
  name: "Suslov top",
  share: 0.5,
  momenta: ["r₁", "r₂"],
  parameters: [
    range("J11", "J₁₁", "mass tensor 1 1", 0.1, 3), range("J22", "J₂₂", "mass tensor 2 2", 0.1, 3),
    range("J33", "J₃₃", "mass tensor 3 3", 0.1, 3), range("J12", "J₁₂", "mass tensor 1 2", -1, 1),
    range("J13", "J₁₃ = c₁", "mass tensor 1 3", -1, 1), range("J23", "J₂₃ = c₂", "mass tensor 2 3", -1, 1),
  ],
  refusal(p) {
    const { b11, b12, b22 } = topNumbers(p);
    const good = b11 > 0 && b11 * b22 - b12 * b12 > 1e-9 * b11 * b22;
    return good ? "" : "The inertia along the constraint must be positive definite: make J₁₂ smaller, or the diagonal larger.";
  },
  table(p) {
    const n = topNumbers(p);
    return [n.b11, n.b12, n.b22, n.c1, n.c2, certain(n)];
  },
  energy(p, r1, r2) {
    const { b11, b12, b22 } = topNumbers(p);
    return (b22 * r1 * r1 - 2 * b12 * r1 * r2 + b11 * r2 * r2) / (b11 * b22 - b12 * b12) / 2;
  },
  geometry(p) {
    const { b11, b12, b22, c1, c2 } = topNumbers(p), lower = cholesky(b11, b12, b22);
    const [l11, l21, l22] = lower, volume = l11 * l22;
    const first = -c2 / l11, second = (c1 - l21 * first) / l22;
    return { lower, pull: [first / volume, second / volume], speed: Math.sqrt((b11 + b22) / 2) };
  },
  /** h times the momentum (W J - J W^T) / h of the displacement with quaternion z. */
  locusPoint(p, z0, z1, z2) {
    const J = matrix(p);
    const W = [
      [1 - 2 * z1 * z1, -2 * z1 * z2, 2 * z0 * z1],
      [-2 * z1 * z2, 1 - 2 * z2 * z2, 2 * z0 * z2],
      [-2 * z0 * z1, -2 * z0 * z2, 2 * z0 * z0 - 1],
    ];
    const entry = (i, j) => {
      let sum = 0;
      for (let k = 0; k < 3; k++) sum += W[i][k] * J[k][j] - J[i][k] * W[j][k];
      return sum;
    };
    return [-entry(1, 2), entry(0, 2), -entry(0, 1)];
  },
  onLocus(p, h, r1, r2, y1, y2) {
    const z0 = 1 / Math.sqrt(1 + y1 * y1 + y2 * y2);
    return this.locusPoint(p, z0, y1 * z0, y2 * z0);
  },
  values: topValues,
  count: topCount,
  /** The line of all momenta along the constraint that are r, a point of it for each number. */
  fibre: (p, h, [r1, r2]) => (s) => [-h * r2, h * r1, s],
  fibreAxis: 2,
  /** Step angle of a displacement. */
  angle: (y1, y2) => 2 * Math.atan(Math.hypot(y1, y2)),
  mesh(p, orbit, reach, rowsOf = 26, columns = 64) {
    const points = [];
    for (let i = 0; i <= rowsOf; i++) {
      const half = (reach * i) / rowsOf / 2, z0 = Math.cos(half), size = Math.sin(half);
      for (let j = 0; j <= columns; j++) {
        const turn = (2 * Math.PI * j) / columns;
        points.push(this.locusPoint(p, z0, size * Math.cos(turn), size * Math.sin(turn)));
      }
    }
    return { points, rows: rowsOf + 1, columns: columns + 1 };
  },
  axes: ["hM₁", "hM₂", "hM₃"],
  python: (s) => `nh.SuslovTop(${rows(s.parameters)})`,
  toml: (s) => `kind = "suslov"\nmass_tensor = ${rows(s.parameters)}\naxis = [0.0, 0.0, 1.0]`,
  configuration([w, x, y, z]) {
    return [
      [1 - 2 * (y * y + z * z), 2 * (x * y - w * z), 2 * (x * z + w * y)],
      [2 * (x * y + w * z), 1 - 2 * (x * x + z * z), 2 * (y * z - w * x)],
      [2 * (x * z - w * y), 2 * (y * z + w * x), 1 - 2 * (x * x + y * y)],
    ];
  },
};

export const sleigh = {
  kind: "sleigh",
  name: "Chaplygin sleigh",
  share: 1,
  momenta: ["π", "p₁"],
  parameters: [
    range("mass", "m", "mass", 0.1, 4), range("inertia", "J", "moment of inertia about the center of mass", 0.1, 4),
    range("a", "a", "offset of the center of mass along the blade", -1.5, 1.5),
  ],
  refusal: (p) => (p.mass > 0 && p.inertia > 0 ? "" : "Mass and moment of inertia must be positive."),
  table: (p) => [p.mass, p.inertia, p.a],
  energy: (p, r1, r2) => (r1 * r1) / (p.inertia + p.mass * p.a * p.a) / 2 + (r2 * r2) / p.mass / 2,
  geometry(p) {
    const about = p.inertia + p.mass * p.a * p.a, l11 = Math.sqrt(about), l22 = Math.sqrt(p.mass);
    return { lower: [l11, 0, l22], pull: [(p.a * l22) / about, 0], speed: l22 };
  },
  /** X, Y, Z of the conoid: X : Y = cos : sin of half the step angle, Z = J sin of it. */
  onLocus(p, h, r1, r2, y1) {
    const X = p.a === 0 ? h * r2 : p.a * h * r2 + 2 * p.mass * p.a * p.a;
    return [X, X * y1, (2 * p.inertia * y1) / (1 + y1 * y1)];
  },
  values: sleighValues,
  count: sleighCount,
  fibre: (p, h, [r1, r2]) => (s) => (p.a === 0 ? [h * r2, s, h * r1] : [p.a * h * r2 + 2 * p.mass * p.a * p.a, s, h * r1 - s]),
  fibreAxis: 1,
  angle: (y1) => 2 * Math.atan(Math.abs(y1)),
  mesh(p, orbit, reach, rowsOf = 64, columns = 24) {
    let low = 0, high = 0;
    for (const [X, Y] of orbit) {
      const radius = Math.sign(X || 1) * Math.hypot(X, Y);
      low = Math.min(low, radius);
      high = Math.max(high, radius);
    }
    const margin = 0.15 * (high - low || 1), points = [];
    for (let i = 0; i <= rowsOf; i++) {
      const angle = reach * ((2 * i) / rowsOf - 1), cos = Math.cos(angle / 2), sin = Math.sin(angle / 2);
      for (let j = 0; j <= columns; j++) {
        const radius = low - margin + ((high - low + 2 * margin) * j) / columns;
        points.push([radius * cos, radius * sin, p.inertia * Math.sin(angle)]);
      }
    }
    return { points, rows: rowsOf + 1, columns: columns + 1 };
  },
  axes: ["X", "Y", "Z"],
  python: ({ parameters: p }) =>
    `nh.ChaplyginSleigh(mass=${literal(p.mass)}, inertia=${literal(p.inertia)}, a=${literal(p.a)})`,
  toml: ({ parameters: p }) =>
    `kind = "sleigh"\nmass = ${literal(p.mass)}\ninertia = ${literal(p.inertia)}\na = ${literal(p.a)}`,
  configuration: ([cos, sin, x, y]) => [[cos, -sin, x], [sin, cos, y], [0, 0, 1]],
};

export const BODIES = { top, sleigh, forced_top: underForces(top), forced_sleigh: underForces(sleigh), top4 };

/** Put a body under the table of forces that the data of a page hold. */
export const takeTable = (given) => (BODIES[`forced_${given.body}`] = underForces(BODIES[given.body], given));
