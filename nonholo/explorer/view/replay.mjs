// A motion without a kernel: its numbers are in the page, and its body axes are drawn.

import { CapsuleGeometry, Group, Mesh, Vector3 } from "three";
import { clear, ribbon, solid } from "./stage.mjs";

/** The numbers that a text holds. */
export const numbersOf = (text) => new Float64Array(Uint8Array.from(atob(text), (letter) => letter.charCodeAt(0)).buffer);

/** The orbit in the data of a page: momenta, energies, and for each state an origin and three axes. */
export function replayed(data) {
  const time = numbersOf(data.time), energy = numbersOf(data.energy), frames = numbersOf(data.frames), r = numbersOf(data.momentum);
  const count = time.length;
  const error = energy.map((e) => (energy[0] === 0 ? 0 : Math.abs(e / energy[0] - 1)));
  return { count, rank: 2, outcome: data.outcome, r, energy, error, frames, time: (k) => time[k] };
}

/** Stands in for the flow in the phase portrait: there is no closed form to draw. */
export const noFlow = (orbit) => ({ size: 0, back: () => [0, 0], attracting: null, at: () => [NaN, NaN], orbit });

export class AxesView {
  constructor(stage) {
    this.stage = stage;
    this.fixed = new Group();
    this.moving = new Group();
    stage.scene.add(this.fixed, this.moving);
  }

  set(_, orbit, look) {
    clear(this.fixed);
    clear(this.moving);
    this.orbit = orbit;
    let low = [Infinity, Infinity, Infinity], high = low.map((x) => -x);
    const { frames, count } = orbit;
    for (let k = 0; k < count; k++) {
      const f = frames.subarray(12 * k, 12 * k + 3);
      low = low.map((x, i) => Math.min(x, f[i]));
      high = high.map((x, i) => Math.max(x, f[i]));
    }
    const extent = Math.hypot(...high.map((x, i) => x - low[i])) / 2, center = high.map((x, i) => (x + low[i]) / 2);
    this.length = extent > 0 ? Math.max(1, extent / 4) : 1;
    const tips = new Float32Array(3 * count), far = extent > 0 ? 0 : this.length; // the last axis of a body in its place
    for (let k = 0; k < count; k++) {
      for (let i = 0; i < 3; i++) tips[3 * k + i] = frames[12 * k + i] + far * frames[12 * k + 9 + i];
    }
    const reach = extent + this.length;
    this.trace = count > 1 ? ribbon(tips, this.stage.facing(), 0.02 * reach, look.dark) : null;
    if (this.trace) this.fixed.add(this.trace);
    this.rods = [look.body, look.flow, look.accent].map((color) => {
      const rod = new Mesh(new CapsuleGeometry(0.025 * this.length, 1, 4, 12), solid(color));
      this.moving.add(rod);
      return rod;
    });
    this.stage.look(center, reach);
  }

  show(k) {
    const f = this.orbit.frames.subarray(12 * k, 12 * k + 12), up = new Vector3(0, 1, 0);
    this.rods.forEach((rod, axis) => {
      const way = new Vector3(...f.subarray(3 + 3 * axis, 6 + 3 * axis));
      const long = Math.max(way.length(), 1e-3) * this.length;
      rod.quaternion.setFromUnitVectors(up, way.clone().normalize());
      rod.scale.set(1, long, 1);
      rod.position.set(f[0], f[1], f[2]).addScaledVector(way.normalize(), long / 2);
    });
    this.trace?.geometry.setDrawRange(0, 6 * k);
    this.stage.dirty = true;
  }
}
