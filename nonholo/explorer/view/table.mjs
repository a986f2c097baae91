// A table of forces that a page brings along, body covectors: row k acts over step k, times the slider s, and after the
// last row nothing acts.

import { numbersOf } from "./replay.mjs";

/** How many rows there are, and the force of a step. */
export function tableOf(given) {
  const rows = given ? numbersOf(given.rows) : [];
  return { count: rows.length / 3, at: (p, k) => [0, 1, 2].map((i) => (p.s ? p.s * (rows[3 * k + i] ?? 0) : 0)) };
}
