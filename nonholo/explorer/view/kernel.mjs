// The kernel of nonholo as WebAssembly: numbers go in and come out through its memory.

const STACK = 65536;
/**
 * Places in a state, as `flat_run`, `flat_forced_run` and `flat_secular_run` have it: what is NaN at `fresh` has not begun.
 * By how many nodes one that has begun is ahead, and how many numbers a momentum and a pose have.
 */
const FREE = { size: 16, fresh: 4, chart: 4, pose: 10, outcome: 14, ahead: 0, rank: 2, entries: 4 };
const FORCED = { ...FREE, size: 24, fresh: 8, chart: 8, pose: 4, outcome: 22, ahead: 1 };
const WIDE = { size: 40, fresh: 6, chart: 30, pose: 13, outcome: 29, ahead: 0, rank: 3, entries: 16 };
const LAYOUTS = { top: FREE, sleigh: FREE, forced_top: FORCED, forced_sleigh: FORCED, top4: WIDE };
export const MOST_STEPS = 20000, MOST_MEMBERS = 10000;
const BODY = 32 + 2 * MOST_STEPS; // room for the numbers of a body and of forces, with a row for each step

const bytesOf = (text) => Uint8Array.from(atob(text), (letter) => letter.charCodeAt(0));
const unpacked = (text) => new Response(new Blob([bytesOf(text)]).stream().pipeThrough(new DecompressionStream("gzip"))).arrayBuffer();

/** A module with so many bytes of memory, whose numbers begin at the place STACK / 8. */
async function begun(text, size) {
  const memory = new WebAssembly.Memory({ initial: Math.ceil(size / 65536) });
  const env = {
    __linear_memory: memory,
    __stack_pointer: new WebAssembly.Global({ value: "i32", mutable: true }, STACK),
  };
  const { instance } = await WebAssembly.instantiate(await unpacked(text), { env });
  return [instance, new Float64Array(memory.buffer)];
}

/** Return what continues the momenta of a top on SO(4): `flat_arrowhead_run`, from x at time zero to rows at some times. */
export async function seriesOf(text) {
  const body = STACK / 8, state = body + 8, own = state + 8, [instance, numbers] = await begun(text, STACK + 8 * (16 + 4 * MOST_STEPS));
  return (rates, coupling, x, times, end) => {
    const rows = own + times.length;
    numbers.set([...rates, ...coupling, end, 0, ...x, 0, 0, 0, 0, 0], body);
    numbers.set(times, own);
    const reached = Number(instance.exports.run(8 * body, 8 * state, BigInt(times.length), 8 * own, 8 * rows, 0));
    return numbers.slice(rows, rows + 3 * reached);
  };
}

/** Return what runs a body: `(table, momentum, pose, steps) => {done, outcome, start, momenta, charts, poses}`. */
export async function kernelOf(text, kind) {
  const layout = LAYOUTS[kind], { size: STATE, fresh: FRESH, chart: CHART, pose: POSE, outcome: OUTCOME, rank, entries } = layout;
  const row = 2 * rank + entries, size = STACK + 8 * (BODY + STATE + row * MOST_STEPS + STATE * MOST_MEMBERS);
  const [instance, numbers] = await begun(text, size);
  const body = STACK / 8, state = body + BODY, rows = state + STATE;
  const members = rows + row * MOST_STEPS;
  /** Begin many motions of one body, with momenta one after another. */
  const gather = (momenta, pose) => {
    numbers.fill(0, members);
    for (let k = 0; k < MOST_MEMBERS; k++) {
      const own = members + STATE * k;
      numbers[own] = momenta[2 * k];
      numbers[own + 1] = momenta[2 * k + 1];
      numbers[own + FRESH] = NaN;
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
    numbers[state + FRESH] = NaN;
    numbers.set(pose, state + POSE);
    const at = [0, rank, 2 * rank].map((column) => rows + column * steps);
    const done = Number(instance.exports.run(8 * body, 8 * state, BigInt(steps), ...at.map((place) => 8 * place)));
    return {
      done,
      outcome: numbers[state + OUTCOME],
      start: numbers.slice(state + CHART, state + CHART + rank),
      momenta: numbers.slice(at[0], at[0] + rank * done),
      charts: numbers.slice(at[1], at[1] + rank * done),
      poses: numbers.slice(at[2], at[2] + entries * done),
    };
  };
  return Object.assign(run, { gather, advance, layout });
}
