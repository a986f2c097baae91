// A body in four dimensions: its axes as they are seen along the fourth direction of space, in a ball of radius one.

import { BufferGeometry, CapsuleGeometry, Group, LineLoop, Mesh, SphereGeometry, Vector3 } from "three";
import { clear, ribbon, solid, thin } from "./stage.mjs";

const UP = new Vector3(0, 1, 0), RIM = 96;

export class WideTopView {
  constructor(stage) {
    this.stage = stage;
    this.fixed = new Group();
    this.moving = new Group();
    stage.scene.add(this.fixed, this.moving);
  }

  set(_, orbit, look) {
    clear(this.fixed);
    this.orbit = orbit;
    this.globe(look);
    const { count, g } = orbit, tips = new Float32Array(3 * count);
    for (let k = 0; k < count; k++) for (let i = 0; i < 3; i++) tips[3 * k + i] = g[16 * k + 4 * i + 3];
    this.trace = count > 1 ? ribbon(tips, this.stage.facing(), 0.02, look.dark) : null;
    if (this.trace) this.fixed.add(this.trace);
    this.axes(look);
    if (!this.framed) this.stage.look([0, 0, 0], 1.16);
    this.framed = true;
  }

  /** The rods and their balls, which stay until the colors change. */
  axes(look) {
    if (this.look?.body === look.body) return;
    this.look = look;
    clear(this.moving);
    this.rods = [look.body, look.body, look.body, look.accent].map((color) => {
      const parts = [new CapsuleGeometry(0.016, 1, 4, 12), new SphereGeometry(0.05, 20, 14)].map((shape) => new Mesh(shape, solid(color)));
      this.moving.add(...parts);
      return parts;
    });
  }

  globe(look) {
    for (const [i, j] of [[0, 1], [1, 2], [2, 0]]) {
      const points = Array.from({ length: RIM }, (_, k) => {
        const turn = (2 * Math.PI * k) / RIM, point = [0, 0, 0];
        [point[i], point[j]] = [Math.cos(turn), Math.sin(turn)];
        return new Vector3(...point);
      });
      this.fixed.add(new LineLoop(new BufferGeometry().setFromPoints(points), thin(look.ground)));
    }
  }

  /** Put each axis where it points; the ball at its tip is the larger, the more it points along the fourth direction. */
  show(k) {
    const { g, count } = this.orbit;
    if (!count) return;
    this.rods.forEach(([rod, ball], axis) => {
      const at = (i) => g[16 * k + 4 * i + axis], tip = new Vector3(at(0), at(1), at(2)), long = Math.max(tip.length(), 1e-6);
      ball.position.copy(tip);
      ball.scale.setScalar((axis === 3 ? 1 : 0.6) * (1 + 0.5 * at(3)));
      rod.quaternion.setFromUnitVectors(UP, tip.clone().divideScalar(long));
      rod.scale.set(1, long, 1);
      rod.position.copy(tip).divideScalar(2);
    });
    this.trace?.geometry.setDrawRange(0, 6 * k);
    this.stage.dirty = true;
  }
}
