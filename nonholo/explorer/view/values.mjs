// All values of the map over a momentum along the constraint, real and complex, each as two Cayley coordinates.

const times = ([a, b], [c, d]) => [a * c - b * d, a * d + b * c];
const plus = (...terms) => terms.reduce(([a, b], [c, d]) => [a + c, b + d], [0, 0]);
const scaled = (k, [a, b]) => [k * a, k * b];
const over = ([a, b], [c, d]) => scaled(1 / (c * c + d * d), [a * c + b * d, b * c - a * d]);
const size = ([a, b]) => Math.hypot(a, b);
const TURN = [Math.cos(0.7), Math.sin(0.7)]; // in rotated axes no two values have the same first coordinate, as a rule
const REAL = 1e-7;

/** The roots of a polynomial, its leading coefficient first: all at once, by the iteration of Durand and Kerner. */
export function rootsOf(coefficients) {
  const most = Math.max(...coefficients.map(Math.abs));
  const first = coefficients.findIndex((c) => Math.abs(c) > 1e-13 * most);
  const own = first < 0 ? [] : coefficients.slice(first).map((c) => c / coefficients[first]), degree = own.length - 1;
  if (degree < 1) return [];
  const reach = 1 + Math.max(...own.slice(1).map((c, k) => Math.abs(c) ** (1 / (k + 1))));
  const roots = Array.from({ length: degree }, (_, k) => scaled(reach, [Math.cos((2 * Math.PI * k) / degree + 0.4), Math.sin((2 * Math.PI * k) / degree + 0.4)]));
  for (let turn = 0; turn < 100; turn++) {
    let change = 0;
    roots.forEach((x, k) => {
      const value = own.reduce((sum, c) => plus(times(sum, x), [c, 0]), [0, 0]);
      const apart = roots.reduce((product, other, j) => (j === k ? product : times(product, plus(x, scaled(-1, other)))), [1, 0]);
      const step = size(apart) ? over(value, apart) : [0, 0];
      roots[k] = plus(x, scaled(-1, step));
      change = Math.max(change, size(step) / (1 + size(x)));
    });
    if (change < 1e-15) break;
  }
  return roots;
}

const product = (p, q) => {
  const out = Array(p.length + q.length - 1).fill(0);
  p.forEach((a, i) => q.forEach((b, j) => (out[i + j] += a * b)));
  return out;
};
const combined = (a, p, b, q) => p.map((x, k) => a * x + b * q[k]);

/** How many roots of a cubic or a quartic are real, with multiplicity: from the signs of its discriminants. */
export function realRoots(coefficients) {
  const cubic = coefficients.length === 4, [a, b, c, d, e] = cubic ? [0, ...coefficients] : coefficients;
  if (cubic) return 18 * b * c * d * e - 4 * c ** 3 * e + c * c * d * d - 4 * b * d ** 3 - 27 * b * b * e * e >= 0 ? 3 : 1;
  const i = 12 * a * e - 3 * b * d + c * c, j = 72 * a * c * e + 9 * b * c * d - 27 * a * d * d - 27 * e * b * b - 2 * c ** 3;
  const p = 8 * a * c - 3 * b * b, q = 64 * a ** 3 * e - 16 * a * a * c * c + 16 * a * b * b * c - 16 * a * a * b * d - 3 * b ** 4;
  return 4 * i ** 3 < j * j ? 2 : p < 0 && q < 0 ? 4 : 0;
}

/** The points where B y + (c . y_perp) y_perp = (1 + |y|^2) m are two conics: their resultant, and what else is of use. */
function conics([b11, b12, b22, c1, c2], [m1, m2]) {
  const [cos, sin] = TURN, turned = (x, y) => [cos * x + sin * y, cos * y - sin * x];
  const [d1, d2] = turned(c1, c2), [n1, n2] = turned(m1, m2);
  const [row1, row2] = [turned(b11, b12), turned(b12, b22)];
  const [a11, a12] = [cos * row1[0] + sin * row2[0], cos * row1[1] + sin * row2[1]], a22 = cos * row2[1] - sin * row1[1];
  // each equation is alpha y2^2 + beta(y1) y2 + gamma(y1), coefficients of high powers of y1 first
  const alpha = [d1 - n1, -n2], beta = [[-d2, a12], [-d1, a22]], gamma = [[-n1, a11, -n1], [d2 - n2, a12, -n2]];
  const square = combined(alpha[0], gamma[1], -alpha[1], gamma[0]), line = combined(alpha[0], beta[1], -alpha[1], beta[0]);
  const cubic = combined(1, product(beta[0], gamma[1]), -1, product(beta[1], gamma[0]));
  const resultant = combined(1, product(square, square), -1, product(line, cubic));
  return { square, line, resultant, table: [a11, a12, a22, d1, d2], m: [n1, n2] };
}

/** How many values of a top are real. */
export const topCount = (table, m) => realRoots(conics(table, m).resultant);

/** All values of a top. */
export function topValues(body, momentum) {
  const { square, line, resultant, table, m } = conics(body, momentum), [cos, sin] = TURN;
  const at = (p, x) => p.reduce((sum, c) => plus(times(sum, x), [c, 0]), [0, 0]);
  return rootsOf(resultant).map((x) => {
    const y = polished([x, scaled(-1, over(at(square, x), at(line, x)))], table, m);
    return [plus(scaled(cos, y[0]), scaled(-sin, y[1])), plus(scaled(sin, y[0]), scaled(cos, y[1]))];
  });
}

/** Newton's method on the two conics themselves. */
function polished(y, [b11, b12, b22, c1, c2], [m1, m2]) {
  let [x, z] = y;
  for (let turn = 0; turn < 4; turn++) {
    const pull = plus(scaled(c2, x), scaled(-c1, z)), whole = plus([1, 0], times(x, x), times(z, z));
    const first = plus(scaled(b11, x), scaled(b12, z), scaled(-1, times(pull, z)), scaled(-m1, whole));
    const second = plus(scaled(b12, x), scaled(b22, z), times(pull, x), scaled(-m2, whole));
    const f1 = plus([b11, 0], scaled(-c2, z), scaled(-2 * m1, x)), f2 = plus([b12, 0], scaled(-1, pull), scaled(c1, z), scaled(-2 * m1, z));
    const s1 = plus([b12, 0], pull, scaled(c2, x), scaled(-2 * m2, x)), s2 = plus([b22, 0], scaled(-c1, x), scaled(-2 * m2, z));
    const determinant = plus(times(f1, s2), scaled(-1, times(f2, s1)));
    if (!(size(determinant) > 1e-9 * (size(f1) + size(f2)) * (size(s1) + size(s2)))) break; // two values meet
    x = plus(x, scaled(-1, over(plus(times(first, s2), scaled(-1, times(f2, second))), determinant)));
    z = plus(z, scaled(-1, over(plus(times(f1, second), scaled(-1, times(first, s1))), determinant)));
  }
  return [x, z];
}

/** The cubic of the tangent of half the step angle of a sleigh. */
const halfAngle = ([mass, inertia, a], [m1, m2]) => [a * (m2 + 2 * mass * a), -m1, 2 * inertia + a * (m2 + 2 * mass * a), -m1];

/** How many values of a sleigh are real; of a balanced one without those that turn by half. */
export function sleighCount(table, m) {
  const cubic = halfAngle(table, m);
  return cubic[0] ? realRoots(cubic) : Math.abs(m[0]) <= table[1] ? 2 : 0;
}

/** The roots t of the half-angle cubic, each with the second coordinate that belongs to it. */
export function sleighValues([mass, inertia, a], [m1, m2]) {
  return rootsOf(halfAngle([mass, inertia, a], [m1, m2])).map((t) => {
    const square = times(t, t);
    return [t, plus([m2 / (2 * mass), 0], scaled(m2 / (2 * mass) + a, square))];
  });
}

export const isReal = (value) => value.every((y) => Math.abs(y[1]) <= REAL * (1 + size(y)));

/** All values over a momentum r; real ones first, the one next to y, the root that the map takes, before the others. */
export function valuesOver(body, state, r, y) {
  const scale = state.time_step * body.share;
  const all = body.values(body.table(state.parameters), [scale * r[0], scale * r[1]]);
  const away = (value) => (isReal(value) ? 0 : 1e300) + Math.hypot(value[0][0] - y[0], value[1][0] - y[1]);
  return all.sort((one, other) => away(one) - away(other));
}
