// The kernel of nonholo as WebAssembly: numbers go in and come out through its memory.

const STACK = 65536;
const BODY = 8, STATE = 16, CHART = 4, POSE = 10, OUTCOME = 14;
export const MOST_STEPS = 20000;

const bytesOf = (text) => Uint8Array.from(atob(text), (letter) => letter.charCodeAt(0));

/** Return what runs a body: `(table, momentum, pose, steps) => {done, outcome, momenta, charts, poses}`. */
export async function kernelOf(text) {
  const size = STACK + 8 * (BODY + STATE + 8 * MOST_STEPS);
  const memory = new WebAssembly.Memory({ initial: Math.ceil(size / 65536) });
  const env = {
    __linear_memory: memory,
    __stack_pointer: new WebAssembly.Global({ value: "i32", mutable: true }, STACK),
  };
  const { instance } = await WebAssembly.instantiate(bytesOf(text), { env });
  const numbers = new Float64Array(memory.buffer);
  const body = STACK / 8, state = body + BODY, rows = state + STATE;
  return (table, momentum, pose, steps) => {
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
}
