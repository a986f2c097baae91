// Pictures in the plane, drawn on a canvas: the phase portrait and the energy error.

import { css, raised, short, timeColor } from "./look.mjs";
import { isSoftware } from "./stage.mjs";

const EPSILON = 2 ** -52;
const PEN = { alpha: false, willReadFrequently: isSoftware }; // drawn by the processor where there is nothing else
const FONT = "11px system-ui, sans-serif";

/** A canvas that is drawn anew at its own size, sharp on every screen. */
export class Picture {
  constructor(canvas) {
    this.canvas = canvas;
    this.pen = canvas.getContext("2d", PEN);
    this.still = document.createElement("canvas");
    new ResizeObserver(() => {
      this.draw();
      this.show(this.k ?? 0);
    }).observe(canvas);
  }

  /** Take a motion; who does so shows a state of it. */
  set(data, look) {
    Object.assign(this, { data, look });
    this.draw();
  }

  /** Draw what stands still. */
  draw() {
    if (!this.data) return;
    const ratio = Math.min(window.devicePixelRatio || 1, 2), { clientWidth: w, clientHeight: h } = this.canvas;
    if (!w || !h) return;
    if (w !== this.w || h !== this.h || ratio !== this.ratio) this.resize(w, h, ratio);
    const pen = this.still.getContext("2d", PEN);
    pen.setTransform(ratio, 0, 0, ratio, 0, 0);
    pen.font = FONT;
    pen.fillStyle = this.look.card;
    pen.fillRect(0, 0, w, h);
    this.frame();
    this.background(pen);
  }

  resize(w, h, ratio) {
    Object.assign(this, { w, h, ratio });
    for (const canvas of [this.canvas, this.still]) {
      canvas.width = Math.round(w * ratio);
      canvas.height = Math.round(h * ratio);
    }
  }

  /** Show a state: what stands still is a picture already. */
  show(k) {
    this.k = k;
    if (!this.data || !this.w) return;
    const { pen, ratio } = this;
    pen.setTransform(1, 0, 0, 1, 0, 0);
    pen.drawImage(this.still, 0, 0);
    pen.setTransform(ratio, 0, 0, ratio, 0, 0);
    pen.font = FONT;
    this.marks(pen, k);
  }

  dot(pen, x, y, radius, fill, stroke) {
    pen.beginPath();
    pen.arc(x, y, radius, 0, 2 * Math.PI);
    if (fill) {
      pen.fillStyle = fill;
      pen.fill();
    }
    if (stroke) {
      pen.strokeStyle = stroke;
      pen.lineWidth = 2;
      pen.stroke();
    }
  }
}

export const curve = (pen, points) => {
  pen.beginPath();
  points.forEach(([x, y], k) => (k ? pen.lineTo(x, y) : pen.moveTo(x, y)));
  pen.stroke();
};

/**
 * Momenta along the constraint: levels of energy, lines of equilibria, the flow, and the discrete states as dots.
 *
 * It is drawn about zero, or about the middle of the ranges of a replay, which it names.
 */
export class PhasePortrait extends Picture {
  frame() {
    const { orbit, flow } = this.data;
    this.middle = flow.ranges ? flow.back() : [0, 0];
    let reach = 1e-12;
    const widen = (r, i) => (reach = Math.max(reach, Math.abs(r - (this.middle[i % orbit.rank] ?? 0))));
    for (let turn = 0; turn < 64; turn++) this.level(1, turn).forEach(widen);
    orbit.r.forEach(widen);
    this.unit = (Math.min(this.w, this.h) / 2 - 14) / (1.22 * reach);
    this.reach = reach;
    this.flow = flow;
  }

  level(size, turn) {
    const angle = (2 * Math.PI * turn) / 64, { flow } = this.data;
    return flow.back(size * flow.size * Math.cos(angle), size * flow.size * Math.sin(angle));
  }

  place([r1, r2]) {
    return [this.w / 2 + this.unit * (r1 - this.middle[0]), this.h / 2 - this.unit * (r2 - this.middle[1])];
  }

  momentumAt(x, y) {
    return [this.middle[0] + (x - this.w / 2) / this.unit, this.middle[1] + (this.h / 2 - y) / this.unit];
  }

  background(pen) {
    const { look, w, h, data: { orbit, flow, body } } = this;
    if (this.data.counts) this.shade(pen, this.data.counts);
    pen.strokeStyle = look.line;
    pen.lineWidth = 1;
    for (const size of [0.4, 0.7, 1.3, 1.6, 2, 2.5]) {
      curve(pen, Array.from({ length: 65 }, (_, turn) => this.place(this.level(size, turn))));
    }
    if (flow.attracting) this.equilibria(pen, flow.attracting);
    pen.strokeStyle = flow.isForced || flow.isLevel ? look.line : look.flow;
    pen.lineWidth = 2.2;
    curve(pen, Array.from({ length: 65 }, (_, turn) => this.place(this.level(1, turn))));
    if (flow.curve) {
      pen.strokeStyle = look.flow;
      curve(pen, flow.curve.map((r) => this.place(r)));
    }
    const stride = Math.max(1, Math.floor(orbit.count / 600));
    for (let k = 0; k < orbit.count; k += stride) {
      const color = css(timeColor(k / Math.max(1, orbit.count - 1), look.dark));
      this.dot(pen, ...this.place(orbit.r.subarray(orbit.rank * k)), 2.3, color);
    }
    pen.fillStyle = look.muted;
    const range = ([low, high]) => [low, high].map((x) => short(Math.abs(x) < 1e-9 * (high - low) ? 0 : x)).join(" to ");
    const [first, second] = body.momenta.map((name, i) => (flow.ranges?.[i] ? `${name}: ${range(flow.ranges[i])}` : name));
    pen.textAlign = "right";
    pen.fillText(first, w - 8, flow.ranges ? h - 8 : h / 2 - 6);
    pen.textAlign = "left";
    pen.fillText(second, flow.ranges ? 12 : w / 2 + 6, 14);
  }

  /** Shade momenta by how many real values the map has there: the more, the darker; borders are folds. */
  shade(pen, counts) {
    const at = (x, y) => counts(this.momentumAt(x, y));
    const fill = (x, y, size) => {
      const count = at(x, y), isEven = [at(x + size, y), at(x, y + size), at(x + size, y + size)].every((other) => other === count);
      if (!isEven && size > 1) {
        for (const [i, j] of [[0, 0], [0, 1], [1, 0], [1, 1]]) fill(x + (i * size) / 2, y + (j * size) / 2, size / 2);
        return;
      }
      pen.globalAlpha = 0.06 * count;
      pen.fillRect(x, y, size, size);
    };
    pen.fillStyle = this.look.body;
    for (let x = 0; x < this.w; x += 8) for (let y = 0; y < this.h; y += 8) fill(x, y, 8);
    pen.globalAlpha = 1;
  }

  equilibria(pen, [d1, d2]) {
    const far = (3 * (this.w + this.h)) / this.unit / Math.hypot(d1, d2), { look } = this;
    for (const [sign, color, dash] of [[1, look.ink, []], [-1, look.unstable, [5, 4]]]) {
      pen.strokeStyle = color;
      pen.lineWidth = 1.4;
      pen.setLineDash(dash);
      curve(pen, [this.place([0, 0]), this.place([sign * far * d1, sign * far * d2])]);
    }
    pen.setLineDash([]);
  }

  marks(pen, k) {
    const { orbit, flow } = this.data, { look } = this;
    if (this.data.crowd) this.data.crowd.draw(pen, this);
    if (!orbit.count) return;
    this.dot(pen, ...this.place(flow.at(orbit.time(k))), 7, null, look.flow);
    this.dot(pen, ...this.place(orbit.r.subarray(orbit.rank * k)), 4.2, look.accent, look.card);
  }
}

/** |E / E_0 - 1| of the states on a logarithmic axis; zeros stand on its floor. */
export class EnergyError extends Picture {
  frame() {
    const { error } = this.data.orbit;
    let most = 1e-14;
    for (const e of error) if (e > most) most = e;
    this.top = Math.ceil(Math.log10(most) + 0.3);
    this.bottom = -17;
    this.box = { left: 40, right: this.w - 12, top: 10, bottom: this.h - 24 };
  }

  place(k, error) {
    const { left, right, top, bottom } = this.box, { count } = this.data.orbit;
    const power = error > 0 ? Math.max(Math.log10(error), this.bottom) : this.bottom;
    return [
      left + ((right - left) * k) / Math.max(1, count - 1),
      bottom - ((bottom - top) * (power - this.bottom)) / (this.top - this.bottom),
    ];
  }

  background(pen) {
    const { look, w, h, box, data: { orbit } } = this;
    pen.textBaseline = "middle";
    pen.textAlign = "right";
    const every = Math.max(1, Math.ceil(((this.top - this.bottom) * 18) / (box.bottom - box.top)));
    for (let power = this.bottom + 1; power <= this.top; power += every) {
      const y = this.place(0, 10 ** power)[1];
      pen.strokeStyle = look.line;
      pen.lineWidth = 1;
      curve(pen, [[box.left, y], [box.right, y]]);
      pen.fillStyle = look.muted;
      pen.fillText(`10${raised(power)}`, box.left - 6, y);
    }
    pen.fillText("0", box.left - 6, box.bottom);
    const epsilon = this.place(0, EPSILON)[1];
    pen.strokeStyle = look.flow;
    pen.setLineDash([5, 4]);
    curve(pen, [[box.left, epsilon], [box.right, epsilon]]);
    pen.setLineDash([]);
    const stride = Math.max(1, Math.floor(orbit.count / 800));
    for (let k = 0; k < orbit.count; k += stride) {
      const [x, y] = this.place(k, orbit.error[k]);
      pen.fillStyle = css(timeColor(k / Math.max(1, orbit.count - 1), look.dark));
      pen.fillRect(x - 1.4, y - 1.4, 2.8, 2.8);
    }
    pen.fillStyle = look.muted;
    pen.textBaseline = "alphabetic";
    pen.textAlign = "left";
    pen.fillText("t = 0", box.left, h - 7);
    pen.textAlign = "right";
    if (orbit.count) pen.fillText(`t = ${short(orbit.time(orbit.count - 1), 4)}`, box.right, h - 7);
  }

  marks(pen, k) {
    if (!this.data.orbit.count) return;
    this.dot(pen, ...this.place(k, this.data.orbit.error[k]), 4.2, this.look.accent, this.look.card);
  }
}
