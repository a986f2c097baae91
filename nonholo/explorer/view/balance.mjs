// The energy under forces: kinetic, whole, and the first one with the work of friction, on one axis.

import { css, short, timeColor } from "./look.mjs";
import { curve, Picture } from "./plots.mjs";

export class EnergyBalance extends Picture {
  frame() {
    const { energy, kinetic, work, count } = this.data.orbit;
    let low = 0, high = 0; // with zero, as energies of motion begin there
    for (let k = 0; k < count; k++) {
      low = Math.min(low, energy[k], energy[0] + work[k]);
      high = Math.max(high, energy[k], kinetic[k]);
    }
    const size = high - low || 1, step = 10 ** Math.floor(Math.log10(size / 2));
    this.step = size / step > 8 ? 5 * step : size / step > 4 ? 2 * step : step;
    [this.low, this.high] = [low - 0.04 * size, high + 0.08 * size];
    this.box = { left: 40, right: this.w - 12, top: 10, bottom: this.h - 24 };
  }

  place(k, value) {
    const { left, right, top, bottom } = this.box, { count } = this.data.orbit;
    return [left + ((right - left) * k) / Math.max(1, count - 1), bottom - ((bottom - top) * (value - this.low)) / (this.high - this.low)];
  }

  background(pen) {
    const { look, h, box, data: { orbit } } = this;
    pen.textBaseline = "middle";
    pen.textAlign = "right";
    pen.lineWidth = 1;
    for (let i = Math.ceil(this.low / this.step); i * this.step <= this.high; i++) {
      const y = this.place(0, i * this.step)[1];
      pen.strokeStyle = look.line;
      curve(pen, [[box.left, y], [box.right, y]]);
      pen.fillStyle = look.muted;
      pen.fillText(short(i * this.step), box.left - 6, y);
    }
    const stride = Math.max(1, Math.floor(orbit.count / 800)), states = [];
    for (let k = 0; k < orbit.count; k += stride) states.push(k);
    const line = (color, width, dash, value) => {
      Object.assign(pen, { strokeStyle: color, lineWidth: width });
      pen.setLineDash(dash);
      curve(pen, states.map((k) => this.place(k, value(k))));
      pen.setLineDash([]);
    };
    line(look.muted, 1.2, [], (k) => orbit.kinetic[k]);
    for (const k of states) {
      const [x, y] = this.place(k, orbit.energy[k]);
      pen.fillStyle = css(timeColor(k / Math.max(1, orbit.count - 1), look.dark));
      pen.fillRect(x - 1.6, y - 1.6, 3.2, 3.2);
    }
    line(look.flow, 1.6, [5, 4], (k) => orbit.energy[0] + orbit.work[k]);
    pen.fillStyle = look.muted;
    pen.textBaseline = "alphabetic";
    pen.textAlign = "left";
    pen.fillText("t = 0", box.left, h - 7);
    pen.textAlign = "right";
    if (orbit.count) pen.fillText(`t = ${short(orbit.time(orbit.count - 1), 4)}`, box.right, h - 7);
  }

  marks(pen, k) {
    if (!this.data.orbit.count) return;
    this.dot(pen, ...this.place(k, this.data.orbit.energy[k]), 4.2, this.look.accent, this.look.card);
  }
}
