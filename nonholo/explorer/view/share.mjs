// What leaves the page: the page itself, a link, programs that repeat it, pictures.

import { BODIES } from "./bodies.mjs";
import { literal } from "./literal.mjs";

const list = (values) => `[${values.map(literal).join(", ")}]`;

/** Python that computes the same numbers. */
export function pythonOf(state) {
  const body = BODIES[state.kind];
  const pose = state.pose.some((x, k) => x !== (k % 5 ? 0 : 1));
  const placed = pose ? `,\n    configuration=${JSON.stringify(body.configuration(state.pose))}` : "";
  return `import nonholo as nh

body = ${body.python(state)}
orbit = nh.simulate(
    nh.discretize(body, ${literal(state.time_step)}),
    momentum=${list(state.momentum)},  # along the constraint
    steps=${state.steps}${placed},
)
`;
}

/** A scenario for \`nonholo simulate\`. */
export function tomlOf(state) {
  return `title = "From the live page"

[body]
${BODIES[state.kind].toml(state)}

[start]
momentum = ${list(state.momentum)}  # along the constraint
configuration = ${JSON.stringify(BODIES[state.kind].configuration(state.pose))}

[run]
time_step = ${literal(state.time_step)}
steps = ${state.steps}
${BODIES[state.kind].forces?.(state) ?? ""}`;
}

/** Give the user a file. */
export function download(content, name, kind) {
  const link = document.createElement("a");
  link.href = content instanceof Blob ? URL.createObjectURL(content) : URL.createObjectURL(new Blob([content], { type: kind }));
  link.download = name;
  link.click();
  setTimeout(() => URL.revokeObjectURL(link.href), 10000);
}

/** The text of this page, as it was before it began, with another state in it. */
export function pageWith(original, data) {
  const page = new DOMParser().parseFromString(original, "text/html");
  page.getElementById("data").textContent = JSON.stringify(data).replace(/</g, "\\u003c");
  return `<!doctype html>\n${page.documentElement.outerHTML}\n`;
}

/** A picture of a canvas on the color of its card. */
export function pictureOf(canvas, background) {
  const picture = document.createElement("canvas");
  [picture.width, picture.height] = [canvas.width, canvas.height];
  const pen = picture.getContext("2d");
  pen.fillStyle = background;
  pen.fillRect(0, 0, picture.width, picture.height);
  pen.drawImage(canvas, 0, 0);
  return new Promise((done) => picture.toBlob(done, "image/png"));
}
