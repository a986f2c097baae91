// The force that is fixed in space, as an arrow at its point of the body.

import { CylinderGeometry, Group, Mesh, Vector3 } from "three";
import { clear, plain } from "./stage.mjs";

const UP = new Vector3(0, 1, 0);

export class WeightView {
  constructor(stage) {
    this.group = new Group();
    stage.scene.add(this.group);
  }

  /** Draw the arrow of a body under forces beside a view of it; nothing of another one, or where there is no weight. */
  set(body, state, orbit, look, { enlarged = 1, reach = 1.6, height = 0 }) {
    clear(this.group);
    this.at = null;
    if (!body.isForced || !orbit.count) return;
    const [, force] = body.weight(state.parameters, state.pose), way = new Vector3(...force), size = 0.3 * reach;
    if (!way.length()) return;
    const paint = () => plain(look.ink, { depthTest: false }), top = 0.3 * size;
    const shaft = new Mesh(new CylinderGeometry(0.022 * size, 0.022 * size, size - top, 12), paint());
    const head = new Mesh(new CylinderGeometry(0, 0.075 * size, top, 20), paint());
    shaft.position.y = (size - top) / 2;
    head.position.y = size - top / 2;
    for (const part of [shaft, head]) part.renderOrder = 4;
    this.group.add(shaft, head);
    this.group.quaternion.setFromUnitVectors(UP, way.normalize());
    this.at = (k) => {
      const pose = orbit.g.subarray(4 * k, 4 * k + 4), [place] = body.weight(state.parameters, pose);
      const own = body.weight({ ...state.parameters, x1: 0, x2: 0, x3: 0 }, pose)[0]; // enlarged with the body about its origin
      return place.map((x, i) => own[i] + enlarged * (x - own[i]) + (i === 2 ? height : 0));
    };
  }

  show(k) {
    if (this.at) this.group.position.set(...this.at(k));
  }
}
