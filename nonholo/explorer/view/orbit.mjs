// An orbit of the page: what the kernel computed, in units of the user, with what the views draw of it.

/** Run a state of the page; states 0 to `done` are those of `nonholo.simulate`, to the last bit. */
export function orbitOf(body, state, run) {
  const scale = state.time_step * body.share;
  const table = body.table(state.parameters, state.time_step);
  const start = state.momentum.map((r) => scale * r), { rank, entries } = run.layout;
  const first = run(table, start, state.pose, 0);
  const { done, outcome, momenta, charts, poses } =
    first.outcome === 0 ? run(table, start, state.pose, state.steps) : { ...first, done: -1 };
  const count = done + 1;
  const r = new Float64Array(rank * count), y = new Float64Array(rank * count), g = new Float64Array(entries * count);
  if (count > 0) {
    y.set(first.start);
    g.set(state.pose);
    y.set(charts, rank);
    g.set(poses, entries);
    r.set(start.map((m) => m / scale));
    for (let k = 0; k < rank * done; k++) r[k + rank] = momenta[k] / scale;
  }
  return finished(body, state, { count, rank, outcome, r, y, g, table });
}

function finished(body, state, orbit) {
  const { count, rank, r } = orbit, time = (k) => k * state.time_step;
  if (body.balance) return { ...orbit, ...body.balance(state, orbit), time };
  const energy = new Float64Array(count), error = new Float64Array(count);
  for (let k = 0; k < count; k++) {
    energy[k] = body.energy(state.parameters, ...r.subarray(rank * k, rank * k + rank));
    error[k] = energy[0] === 0 ? 0 : Math.abs(energy[k] / energy[0] - 1);
  }
  return { ...orbit, energy, error, time };
}

/** The continuous motion through the first momentum: a circle run through in the closed form of nonholo.continuous. */
export function flowOf(body, state) {
  const { lower: [l11, l21, l22], pull } = body.geometry(state.parameters);
  const [r1, r2] = state.momentum;
  const x1 = r1 / l11, x2 = (r2 - l21 * x1) / l22;
  const size = Math.hypot(x1, x2), strength = Math.hypot(...pull);
  const back = (u, v) => [l11 * u, l21 * u + l22 * v];
  const [n1, n2] = strength > 0 ? [pull[0] / strength, pull[1] / strength] : [0, 0];
  const across = (x1 * n1 + x2 * n2) / size;
  if (!(strength > 0) || !(size > 0) || Math.abs(across) < 1e-290) {
    return { size, back, at: () => [r1, r2], attracting: strength > 0 ? back(-n2, n1) : null };
  }
  const start = Math.asinh((x2 * n1 - x1 * n2) / size / Math.abs(across)), rate = strength * size;
  const at = (time) => {
    const phase = start + rate * time, sech = Math.sign(across) / Math.cosh(phase), tanh = Math.tanh(phase);
    return back(size * (sech * n1 - tanh * n2), size * (sech * n2 + tanh * n1));
  };
  return { size, back, at, attracting: back(-n2, n1) };
}
