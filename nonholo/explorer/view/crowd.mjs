// Ten thousand motions at once: momenta fill a disc of energies, and gather at the attracting equilibria.

import { MOST_MEMBERS } from "./kernel.mjs";

const GOLDEN = Math.PI * (3 - Math.sqrt(5));

export class Crowd {
  /** Begin anew, evenly over the energies up to one and a half times that of the motion. */
  set(body, state, flow, kernel) {
    Object.assign(this, { kernel, pose: state.pose, table: body.table(state.parameters, state.time_step), scale: state.time_step * body.share });
    const momenta = new Float64Array(2 * MOST_MEMBERS);
    for (let k = 0; k < MOST_MEMBERS; k++) {
      const size = 1.22 * flow.size * Math.sqrt((k + 0.5) / MOST_MEMBERS), turn = GOLDEN * k;
      const [r1, r2] = flow.back(size * Math.cos(turn), size * Math.sin(turn));
      momenta[2 * k] = this.scale * r1;
      momenta[2 * k + 1] = this.scale * r2;
    }
    this.first = momenta;
    this.begin();
  }

  begin() {
    this.states = this.kernel.gather(this.first, this.pose);
    this.k = 0;
  }

  /** Go to a step, forwards from where they are or from the start. */
  to(k) {
    if (k < this.k) this.begin();
    if (k > this.k) this.kernel.advance(this.table, k - this.k - (this.k ? 0 : this.kernel.layout.ahead));
    this.k = k;
  }

  /** The scaled momenta of a member at the start and now, its outcome, and the step. */
  member(k) {
    const { size, outcome } = this.kernel.layout, own = size * k, now = [...this.states.slice(own, own + 2)];
    return { first: [...this.first.slice(2 * k, 2 * k + 2)], now, outcome: this.states[own + outcome], step: this.k };
  }

  /** Dots of all that still move. */
  draw(pen, picture) {
    const { states, scale, kernel: { layout: { size, outcome } } } = this, { unit, w, h } = picture;
    pen.fillStyle = picture.look.crowd;
    pen.beginPath();
    for (let own = 0; own < size * MOST_MEMBERS; own += size) {
      if (states[own + outcome] === 0) pen.rect(w / 2 + (unit * states[own]) / scale - 0.6, h / 2 - (unit * states[own + 1]) / scale - 0.6, 1.2, 1.2);
    }
    pen.fill();
  }
}
