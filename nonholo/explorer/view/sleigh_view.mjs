// The sleigh on the plane: an elliptic plate on a blade, its center of mass, and the track of the contact point.

import {
  BoxGeometry, BufferAttribute, BufferGeometry, CylinderGeometry, ExtrudeGeometry, Group, Line, Mesh, Shape, SphereGeometry,
} from "three";
import { clear, grid, ribbon, solid, thin } from "./stage.mjs";

const SLENDER = 1.6;

export class SleighView {
  constructor(stage) {
    this.stage = stage;
    this.fixed = new Group();
    this.moving = new Group();
    stage.scene.add(this.fixed, this.moving);
  }

  set(state, orbit, look) {
    const drawn = JSON.stringify(look);
    clear(this.fixed);
    if (drawn !== this.drawn) {
      clear(this.moving);
      this.build(look);
      this.drawn = drawn;
    }
    this.orbit = orbit;
    const { mass, inertia, a } = state.parameters;
    const long = SLENDER * Math.sqrt((4 * inertia) / mass / (1 + SLENDER * SLENDER));
    const { count, g } = orbit, track = new Float32Array(3 * count);
    let box = [Infinity, Infinity, -Infinity, -Infinity];
    for (let k = 0; k < count; k++) {
      const x = g[4 * k + 2], y = g[4 * k + 3];
      track[3 * k] = x;
      track[3 * k + 1] = y;
      box = [Math.min(box[0], x), Math.min(box[1], y), Math.max(box[2], x), Math.max(box[3], y)];
    }
    if (!orbit.count) box = [-1, -1, 1, 1];
    const extent = Math.hypot(box[2] - box[0], box[3] - box[1]);
    this.enlarged = Math.max(1, extent / (7 * (long + Math.abs(a))));
    const reach = extent / 2 + this.enlarged * (long + Math.abs(a));
    const center = [(box[0] + box[2]) / 2, (box[1] + box[3]) / 2, 0];
    this.reach = reach;
    this.height = 0.42 * this.enlarged * long; // of the center of mass
    this.fixed.add(grid(center, reach, look));
    this.track = count > 1 ? ribbon(track, () => {}, 0.02 * reach, look.dark) : null;
    if (this.track) this.track.position.z = 0.004 * reach;
    if (count > 1) this.fixed.add(this.whole(track, 0.002 * reach, look));
    if (this.track) this.fixed.add(this.track);
    for (const part of this.about) part.position.x = a / long;
    this.moving.scale.setScalar(this.enlarged * long);
    this.stage.look(center, 0.97 * reach);
  }

  /** The track that is still to come, as a thin line. */
  whole(track, height, look) {
    const geometry = new BufferGeometry();
    geometry.setAttribute("position", new BufferAttribute(track, 3));
    const line = new Line(geometry, thin(look.muted));
    line.position.z = height;
    return line;
  }

  /** The body in units of its half length; the plate and the center of mass lie ahead of the blade. */
  build(look) {
    const shape = new Shape();
    shape.absellipse(0, 0, 1, 1 / SLENDER, 0, 2 * Math.PI);
    const options = { depth: 0.13, bevelEnabled: true, bevelSize: 0.04, bevelThickness: 0.04, curveSegments: 48 };
    const plate = new Mesh(new ExtrudeGeometry(shape, options), solid(look.body));
    plate.position.z = 0.2;
    const blade = new Mesh(new BoxGeometry(0.8, 0.05, 0.26), solid(look.ink));
    blade.position.z = 0.13;
    const bow = new Mesh(new BoxGeometry(0.8, 0.045, 0.01), solid(look.ink));
    bow.position.z = 0.385;
    const mass = new Mesh(new SphereGeometry(0.1, 24, 16), solid(look.accent));
    mass.position.z = 0.42;
    const contact = new Mesh(new CylinderGeometry(0.05, 0.05, 0.012, 24), solid(look.card));
    contact.rotation.x = Math.PI / 2;
    contact.position.z = 0.395;
    this.about = [plate, mass];
    this.moving.add(plate, blade, bow, mass, contact);
  }

  show(k) {
    const { g, count } = this.orbit;
    if (!count) return;
    this.moving.rotation.z = Math.atan2(g[4 * k + 1], g[4 * k]);
    this.moving.position.set(g[4 * k + 2], g[4 * k + 3], 0);
    this.track?.geometry.setDrawRange(0, 6 * k);
    this.stage.dirty = true;
  }
}
