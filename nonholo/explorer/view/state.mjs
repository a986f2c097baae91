// The state of the page and what may come from outside: everything is checked as data, and nothing of it is run.

import { BODIES } from "./bodies.mjs";
import { MOST_STEPS } from "./kernel.mjs";

const LARGEST = 1e6;
const number = (value) => (typeof value === "string" ? (value.trim() ? Number(value) : NaN) : value);
const within = (value, low, high) => typeof value === "number" && value >= low && value <= high;

/** Return a checked state, or say in words what is wrong with it. */
export function checked(given) {
  const body = Object.hasOwn(BODIES, given.kind) ? BODIES[given.kind] : null;
  if (!body) return { problem: "There is no such body: “kind” is top, sleigh, one of them under forces, or top4." };
  const parameters = {};
  for (const { key, label, fallback } of body.parameters) {
    parameters[key] = number(given.parameters?.[key] ?? fallback);
    if (!within(parameters[key], -LARGEST, LARGEST)) return { problem: `${label} must be a number of at most a million.` };
  }
  if (given.table && given.table !== body.tableName) return { problem: "It is a motion under a table of forces, which this page does not have." };
  const momentum = body.momenta.map((_, k) => number(given.momentum?.[k]));
  if (!momentum.every((r) => within(r, -LARGEST, LARGEST))) return { problem: `The momentum must be ${momentum.length} numbers of at most a million.` };
  const time_step = number(given.time_step), steps = number(given.steps);
  if (!within(time_step, 1e-6, 100)) return { problem: "The time step must be a number from 0.000001 to 100." };
  if (!Number.isInteger(steps) || !within(steps, 1, MOST_STEPS)) return { problem: `Steps must be a whole number from 1 to ${MOST_STEPS}.` };
  const pose = Array.from({ length: body.entries ?? 4 }, (_, k) => number(given.pose?.[k] ?? (k % 5 ? 0 : 1))); // the identity
  const size = body.kind === "top" ? Math.hypot(...pose) : Math.hypot(pose[0], pose[1]);
  if (!pose.every((x) => within(x, -LARGEST, LARGEST)) || !(body.isPose?.(pose) ?? Math.abs(size - 1) <= 1e-9)) return { problem: "The first pose must be a pose." };
  const table = parameters.s ? body.tableName : undefined; // what acts, beside its scale
  return { state: { kind: given.kind, parameters, momentum, time_step, steps, pose, table } };
}

/** The fragment of a link to a state. */
export function fragmentOf({ kind, parameters, momentum, time_step, steps, pose, table }) {
  const named = table ? { table } : {};
  const query = new URLSearchParams({ kind, ...parameters, h: time_step, steps, r: momentum.join(" "), g: pose.join(" "), ...named });
  return `#${query}`;
}

/** The state that a fragment holds, which may be anything: null if it holds none, else as `checked`. */
export function stateOf(fragment) {
  const query = new URLSearchParams(fragment.replace(/^#/, ""));
  if (!query.has("kind")) return null;
  const numbers = (name) => (query.get(name) ?? "").split(" ").filter(Boolean);
  const g = numbers("g");
  return checked({
    kind: query.get("kind"),
    parameters: Object.fromEntries(query),
    momentum: numbers("r"),
    time_step: query.get("h"),
    steps: query.get("steps"),
    table: query.get("table"),
    pose: g.length ? g : undefined,
  });
}
