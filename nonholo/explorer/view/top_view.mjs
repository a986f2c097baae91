// The top in space: its ellipsoid of inertia in two tones, the forbidden axis with its trace on a sphere.

import {
  BufferAttribute, CapsuleGeometry, Group, LineLoop, BufferGeometry, Mesh, Quaternion, SphereGeometry,
  Vector3,
} from "three";
import { clear, isSoftware, plain, ribbon, solid, thin } from "./stage.mjs";

const UP = new Vector3(0, 1, 0), Z = new Vector3(0, 0, 1);

/** Eigenvalues and eigenvectors (columns) of a symmetric 3 x 3 matrix, by Jacobi's rotations. */
function principal(A) {
  const a = A.map((row) => [...row]), v = [[1, 0, 0], [0, 1, 0], [0, 0, 1]];
  for (let sweep = 0; sweep < 30; sweep++) {
    for (const [p, q] of [[0, 1], [0, 2], [1, 2]]) {
      if (Math.abs(a[p][q]) < 1e-15) continue;
      const angle = Math.atan2(2 * a[p][q], a[q][q] - a[p][p]) / 2, c = Math.cos(angle), s = Math.sin(angle);
      for (let k = 0; k < 3; k++) [a[k][p], a[k][q]] = [c * a[k][p] - s * a[k][q], s * a[k][p] + c * a[k][q]];
      for (let k = 0; k < 3; k++) [a[p][k], a[q][k]] = [c * a[p][k] - s * a[q][k], s * a[p][k] + c * a[q][k]];
      for (let k = 0; k < 3; k++) [v[k][p], v[k][q]] = [c * v[k][p] - s * v[k][q], s * v[k][p] + c * v[k][q]];
    }
  }
  return { values: [a[0][0], a[1][1], a[2][2]], vectors: v };
}

export class TopView {
  constructor(stage) {
    this.stage = stage;
    this.fixed = new Group();
    this.moving = new Group();
    stage.scene.add(this.fixed, this.moving);
  }

  set(state, orbit, look, flow) {
    const drawn = JSON.stringify(look), { count, g } = orbit;
    this.orbit = orbit;
    if (drawn !== this.drawn) {
      clear(this.fixed);
      clear(this.moving);
      this.globe(look);
      this.build(look);
      this.drawn = drawn;
    }
    this.shape(state.parameters, flow);
    if (this.trace) {
      this.fixed.remove(this.trace);
      this.trace.geometry.dispose();
    }
    const tips = new Float32Array(3 * count);
    for (let k = 0; k < count; k++) {
      const w = g[4 * k], x = g[4 * k + 1], y = g[4 * k + 2], z = g[4 * k + 3];
      const out = 1 + (0.03 * k) / count; // so that turns over each other stay apart
      tips[3 * k] = out * 2 * (x * z + w * y);
      tips[3 * k + 1] = out * 2 * (y * z - w * x);
      tips[3 * k + 2] = out * (1 - 2 * (x * x + y * y));
    }
    const outwards = (p, normal) => ([normal[0], normal[1], normal[2]] = p);
    this.trace = count > 1 ? ribbon(tips, outwards, 0.028, look.dark) : null;
    if (this.trace) this.fixed.add(this.trace);
    if (!this.framed) this.stage.look([0, 0, 0], 1.16);
    this.framed = true;
  }

  globe(look) {
    const circle = (turn, scale = 1, height = 0) => {
      const points = Array.from({ length: 96 }, (_, k) => {
        const angle = (2 * Math.PI * k) / 96;
        return turn(new Vector3(scale * Math.cos(angle), scale * Math.sin(angle), height));
      });
      const line = new LineLoop(new BufferGeometry().setFromPoints(points), thin(look.ground));
      this.fixed.add(line);
    };
    circle((p) => p);
    for (const height of [-0.5, 0.5]) circle((p) => p, Math.sqrt(1 - height * height), height);
    for (let k = 0; k < 4; k++) {
      const way = new Quaternion().setFromAxisAngle(Z, (Math.PI * k) / 4);
      circle((p) => new Vector3(p.x, 0, p.y).applyQuaternion(way));
    }
  }

  /** The solid, its forbidden axis, and the axis of permanent rotation; `shape` gives them sides and direction. */
  build(look) {
    const geometry = new SphereGeometry(1, isSoftware ? 40 : 72, isSoftware ? 24 : 48).toNonIndexed();
    const place = geometry.attributes.position, paint = new Float32Array(3 * place.count);
    const tones = [look.body, look.stripe].map((hex) => plain(hex).color.toArray());
    for (let k = 0; k < place.count; k += 3) {
      let [x, y, z] = [0, 0, 0];
      for (let corner = k; corner < k + 3; corner++) [x, y, z] = [x + place.getX(corner), y + place.getY(corner), z + place.getZ(corner)];
      const tone = tones[x * y * z > 0 ? 0 : 1];
      for (let corner = k; corner < k + 3; corner++) paint.set(tone, 3 * corner);
    }
    geometry.setAttribute("color", new BufferAttribute(paint, 3));
    this.solid = new Mesh(geometry, solid(0xffffff, { vertexColors: true }));
    this.solid.matrixAutoUpdate = false;
    this.moving.add(this.solid);
    this.rod(Z, 0.98, 0.016, look.accent, true);
    this.axis = this.rod(Z, 0.86, 0.012, look.ink, false);
  }

  shape(p, flow) {
    const { values, vectors: v } = principal([[p.J11, p.J12, p.J13], [p.J12, p.J22, p.J23], [p.J13, p.J23, p.J33]]);
    const axes = values.map((value) => Math.sqrt(Math.max(value, 0.02))), scale = 0.62 / Math.max(...axes), turn = this.solid.matrix;
    turn.set(v[0][0], v[0][1], v[0][2], 0, v[1][0], v[1][1], v[1][2], 0, v[2][0], v[2][1], v[2][2], 0, 0, 0, 0, 1);
    if (turn.determinant() < 0) turn.scale(new Vector3(-1, 1, 1));
    turn.scale(new Vector3(...axes.map((axis) => scale * axis)));
    this.solid.matrixWorldNeedsUpdate = true;
    this.axis.visible = Boolean(flow.velocityAxis);
    if (this.axis.visible) this.axis.quaternion.setFromUnitVectors(UP, new Vector3(...flow.velocityAxis).normalize());
  }

  rod(direction, length, radius, color, tipped) {
    const rod = new Mesh(new CapsuleGeometry(radius, length * (tipped ? 1 : 2), 4, 12), solid(color));
    rod.quaternion.setFromUnitVectors(UP, direction);
    if (tipped) rod.position.copy(direction).multiplyScalar(length / 2);
    this.moving.add(rod);
    if (!tipped) return rod;
    const tip = new Mesh(new SphereGeometry(0.042, 20, 14), solid(color));
    tip.position.copy(direction);
    this.moving.add(tip);
  }

  show(k) {
    const { g, count } = this.orbit;
    if (!count) return;
    this.moving.quaternion.set(g[4 * k + 1], g[4 * k + 2], g[4 * k + 3], g[4 * k]);
    this.trace?.geometry.setDrawRange(0, 6 * k);
    this.stage.dirty = true;
  }
}
