/** A number as Python and TOML write it: the shortest text that gives the same bits. */
export const literal = (x) => (Number.isInteger(x) && Math.abs(x) < 1e16 ? x.toFixed(1) : String(x));
