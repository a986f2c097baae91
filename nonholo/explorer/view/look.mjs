// Colors: the palette of nonholo.plot, for light and for dark; time runs from violet to yellow.

const VIRIDIS = ["440154", "482878", "3e4989", "31688e", "26828e", "1f9e89", "35b779", "6ece58", "b5de2b"].map((hex) =>
  [0, 2, 4].map((k) => parseInt(hex.slice(k, k + 2), 16) / 255));

/** The color of a part of the time, 0 to 1, as three numbers. */
export function timeColor(part, dark) {
  const place = (dark ? 0.22 + 0.78 * part : 0.94 * part) * (VIRIDIS.length - 1);
  const k = Math.min(Math.floor(place), VIRIDIS.length - 2), t = place - k;
  return VIRIDIS[k].map((c, i) => c + t * (VIRIDIS[k + 1][i] - c));
}

export const css = ([r, g, b]) => `rgb(${Math.round(255 * r)} ${Math.round(255 * g)} ${Math.round(255 * b)})`;

/** The colors of the page as it is shown now. */
export function colors() {
  const style = getComputedStyle(document.documentElement);
  const get = (name) => style.getPropertyValue(`--${name}`).trim();
  return {
    dark: get("scheme") === "dark",
    ...Object.fromEntries(
      ["ink", "muted", "line", "card", "accent", "flow", "unstable", "body", "stripe", "ground", "surface", "crowd"].map((n) => [n, get(n)]),
    ),
  };
}

/** A number in few characters, with the sign of mathematics. */
export function short(x, digits = 3) {
  if (!Number.isFinite(x)) return "–";
  if (x === 0) return "0";
  const size = Math.abs(x);
  const text = size < 1e-3 || size >= 1e5 ? x.toExponential(1).replace("e", "·10^") : String(+x.toPrecision(digits));
  return text.replace(/\^([+-]?)(\d+)$/, (_, sign, n) => (sign === "-" ? "⁻" : "") + raised(n)).replace("-", "−");
}

export const raised = (n) => [...String(n)].map((d) => "⁰¹²³⁴⁵⁶⁷⁸⁹"[d] ?? "⁻").join("");
