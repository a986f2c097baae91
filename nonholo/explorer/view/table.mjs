// A table of forces that a page brings along, body covectors: row k acts over step k, times the slider s, and after the
// last row nothing acts.

import { numbersOf } from "./replay.mjs";

const product = (A, B) => [A[0] * B[0] + A[1] * B[2], A[0] * B[1] + A[1] * B[3], A[2] * B[0] + A[3] * B[2], A[2] * B[1] + A[3] * B[3]];
const sum = (A, a, B) => A.map((x, i) => x + a * B[i]);

/** V of friction over a time: the sums and products of `rubbed` in nonholo.kernels, in their order. */
export function pushOf([b11, b12, b22], C, time) {
  const one = [1, 0, 0, 1], none = [0, 0, 0, 0], lean = b12 / b11;
  const second = (C[1] - C[0] * lean) / (b22 - b12 * lean), fourth = (C[3] - C[2] * lean) / (b22 - b12 * lean);
  let X = sum(none, -time, [(C[0] - second * b12) / b11, second, (C[2] - fourth * b12) / b11, fourth]), phi = one, doublings = 0;
  for (; doublings < 1100 && Math.abs(X[0]) + Math.abs(X[1]) + Math.abs(X[2]) + Math.abs(X[3]) > 0.5; doublings++) [X, time] = [sum(none, 0.5, X), time / 2];
  for (let k = 14; k > 1; k--) phi = sum(one, 1 / k, product(X, phi));
  let E = product(X, phi), V = sum(none, time, phi);
  for (; doublings; doublings--) [V, E] = [sum(product(E, V), 2, V), sum(product(E, E), 2, E)];
  return V;
}

/** How many rows there are, and the force of a step. */
export function tableOf(given) {
  const rows = given ? numbersOf(given.rows) : [];
  return { count: rows.length / 3, at: (p, k) => [0, 1, 2].map((i) => (p.s ? p.s * (rows[3 * k + i] ?? 0) : 0)) };
}
