// The kernel of nonholo as WebAssembly: numbers go in and come out through its memory.

const STACK = 65536;
/** Places in a state, and by how many nodes one that has begun is ahead: as `flat_run` and `flat_forced_run` have it. */
const FREE = { size: 16, chart: 4, pose: 10, outcome: 14, ahead: 0 }, FORCED = { size: 24, chart: 8, pose: 4, outcome: 22, ahead: 1 };
export const MOST_STEPS = 20000, MOST_MEMBERS = 10000;
const BODY = 32 + 2 * MOST_STEPS; // room for the numbers of a body and of forces, with a row for each step

const bytesOf = (text) => Uint8Array.from(atob(text), (letter) => letter.charCodeAt(0));
const unpacked = (text) => new Response(new Blob([bytesOf(text)]).stream().pipeThrough(new DecompressionStream("gzip"))).arrayBuffer();

/** Return what runs a body: `(table, momentum, pose, steps) => {done, outcome, start, momenta, charts, poses}`. */
export async function kernelOf(text, isForced) {
  const layout = isForced ? FORCED : FREE, { size: STATE, chart: CHART, pose: POSE, outcome: OUTCOME } = layout;
  const size = STACK + 8 * (BODY + STATE + 8 * MOST_STEPS + STATE * MOST_MEMBERS);
  const memory = new WebAssembly.Memory({ initial: Math.ceil(size / 65536) });
  const env = {
    __linear_memory: memory,
    __stack_pointer: new WebAssembly.Global({ value: "i32", mutable: true }, STACK),
  };
  const { instance } = await WebAssembly.instantiate(await unpacked(text), { env });
  const numbers = new Float64Array(memory.buffer);
  const body = STACK / 8, state = body + BODY, rows = state + STATE;
  const members = rows + 8 * MOST_STEPS;
  /** Begin many motions of one body, with momenta one after another. */
  const gather = (momenta, pose) => {
    numbers.fill(0, members);
    for (let k = 0; k < MOST_MEMBERS; k++) {
      const own = members + STATE * k;
      numbers[own] = momenta[2 * k];
      numbers[own + 1] = momenta[2 * k + 1];
      numbers[own + CHART] = NaN;
      numbers.set(pose, own + POSE);
    }
    return numbers.subarray(members);
  };
  /** Take steps with each of them; a motion that has ended stays where it is. */
  const advance = (table, steps) => {
    numbers.set(table, body);
    const count = BigInt(steps), at = [0, 2, 4].map((column) => 8 * (rows + column * steps));
    for (let k = 0; k < MOST_MEMBERS; k++) {
      const own = members + STATE * k;
      if (numbers[own + OUTCOME] === 0) instance.exports.run(8 * body, 8 * own, count, at[0], at[1], at[2]);
    }
  };
  const run = (table, momentum, pose, steps) => {
    numbers.set(table, body);
    numbers.fill(0, state, state + STATE);
    numbers.set(momentum, state);
    numbers[state + CHART] = NaN;
    numbers.set(pose, state + POSE);
    const at = [0, 2, 4].map((column) => rows + column * steps);
    const done = Number(instance.exports.run(8 * body, 8 * state, BigInt(steps), ...at.map((place) => 8 * place)));
    return {
      done,
      outcome: numbers[state + OUTCOME],
      start: numbers.slice(state + CHART, state + CHART + 2),
      momenta: numbers.slice(at[0], at[0] + 2 * done),
      charts: numbers.slice(at[1], at[1] + 2 * done),
      poses: numbers.slice(at[2], at[2] + 4 * done),
    };
  };
  return Object.assign(run, { gather, advance, layout });
}
