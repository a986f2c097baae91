// A motion without a kernel: its numbers are in the page, with what is drawn at each pose: flat parts, a box, a ball, or axes.

import {
  BoxGeometry, BufferAttribute, BufferGeometry, CapsuleGeometry, DoubleSide, Group, Matrix4, Mesh, ShapeUtils, SphereGeometry, Vector2, Vector3,
} from "three";
import { clear, grid, ribbon, solid } from "./stage.mjs";

/** The numbers that a text holds, of eight bytes each or of another kind. */
export const numbersOf = (text, Kind = Float64Array) => new Kind(Uint8Array.from(atob(text), (letter) => letter.charCodeAt(0)).buffer);

/** The orbit in the data of a page: momenta, energies, coordinates, and for each state an origin and three axes. */
export function replayed({ time, energy, frames, momentum, coordinates, names, drawing, outcome }) {
  const [times, energies] = [time, energy].map((text) => numbersOf(text)), count = times.length;
  const error = energies.map((e) => (energies[0] === 0 ? 0 : Math.abs(e / energies[0] - 1)));
  const q = coordinates ? numbersOf(coordinates) : null, n = names?.length ?? 0;
  const coordinate = (k) => names?.map((name, i) => [name, q[n * k + i]]) ?? [];
  return { count, rank: 2, outcome, r: numbersOf(momentum), energy: energies, error, frames: numbersOf(frames), coordinate, drawing, time: (k) => times[k] };
}

/** Stands in for the flow in the phase portrait: there is no closed form to draw, and the momenta have ranges. */
export function noFlow(orbit) {
  const ranges = [0, 1].map(() => [Infinity, -Infinity]);
  orbit.r.forEach((x, i) => (ranges[i % 2] = [Math.min(ranges[i % 2][0], x), Math.max(ranges[i % 2][1], x)]));
  return { size: 0, ranges, back: () => ranges.map(([low, high]) => (low + high) / 2), attracting: null, at: () => [NaN, NaN], orbit };
}

const SMALLEST = 7; // the radius of a body is at least the extent of its path over this
const LOW = 0.08, HIGH = 0.18, TOP = 0.26; // heights of the body and of what it carries, in radii of its first part
const THIN = 0.04; // half the width of a stroke, in the same
const FLOOR = 0.004; // height of the track, in parts of the picture

/** Flat parts as prisms, between two heights, whose corners may move. */
class Prism {
  constructor(size, [low, high], color) {
    this.size = size < 3 ? 4 : size;
    this.heights = [low, high];
    this.place = new Float32Array(15 * this.size); // the cap, and the four corners of each side
    this.geometry = new BufferGeometry();
    this.geometry.setAttribute("position", new BufferAttribute(this.place, 3));
    this.mesh = new Mesh(this.geometry, solid(color, { side: DoubleSide }));
    this.mesh.frustumCulled = false;
  }

  set(corners, half) {
    const { size, place, geometry, heights: [low, high] } = this, ring = corners.length < 6 ? stroke(corners, half) : corners;
    const points = Array.from({ length: size }, (_, i) => new Vector2(ring[2 * i], ring[2 * i + 1]));
    if (ShapeUtils.isClockWise(points)) points.reverse();
    points.forEach((p, i) => {
      const q = points[(i + 1) % size];
      place.set([p.x, p.y, high], 3 * i);
      place.set([p.x, p.y, low, q.x, q.y, low, q.x, q.y, high, p.x, p.y, high], 3 * size + 12 * i);
    });
    if (!geometry.index) {
      const sides = points.flatMap((_, i) => [0, 1, 2, 0, 2, 3].map((j) => size + 4 * i + j));
      geometry.setIndex([...ShapeUtils.triangulateShape(points, []).flat(), ...sides]);
    }
    geometry.attributes.position.needsUpdate = true;
    geometry.computeVertexNormals();
  }
}

/** The rectangle about a line of two points. */
function stroke([x0, y0, x1, y1], half) {
  const long = Math.hypot(x1 - x0, y1 - y0) || 1, u = (-half * (y1 - y0)) / long, v = (half * (x1 - x0)) / long;
  return [x0 + u, y0 + v, x0 - u, y0 - v, x1 - u, y1 - v, x1 + u, y1 + v];
}

/** Whether the path lies in a plane that is seen as a floor. */
function inPlane({ count, frames, drawing }) {
  for (let k = 0; k < count; k++) if (Math.abs(frames[12 * k + 2] - frames[2]) > 1e-9 * Math.abs(frames[2])) return false;
  return Boolean(drawing.sizes || drawing.ball);
}

export class ReplayView {
  static eye = (orbit) => (inPlane(orbit) ? [0.25, -1.1, 1.25] : [1.6, -2, 1.1]);

  constructor(stage) {
    this.stage = stage;
    this.fixed = new Group();
    this.moving = new Group();
    stage.scene.add(this.fixed, this.moving);
  }

  set(_, orbit, look) {
    clear(this.fixed);
    clear(this.moving);
    const { frames, count, drawing } = orbit, origin = (k) => frames.subarray(12 * k, 12 * k + 3);
    this.orbit = orbit;
    let low = [Infinity, Infinity, Infinity], high = low.map((x) => -x);
    for (let k = 0; k < count; k++) {
      low = low.map((x, i) => Math.min(x, origin(k)[i]));
      high = high.map((x, i) => Math.max(x, origin(k)[i]));
    }
    const extent = Math.hypot(...high.map((x, i) => x - low[i])), center = high.map((x, i) => (x + low[i]) / 2);
    const isFlat = inPlane(orbit), radius = this.radius(drawing, extent);
    this.enlarged = drawing.ball ? 1 : Math.max(1, extent / SMALLEST / radius);
    this.length = extent > 0 ? (drawing.box || drawing.ball ? 1.5 : 1) * radius : 1; // of the axes
    const reach = extent / 2 + this.enlarged * Math.max(radius, drawing.sizes ? 0 : this.length);
    if (isFlat) this.fixed.add(grid(center, reach, look));
    this.trail(extent, reach, isFlat, look);
    this.body(drawing, radius, look);
    this.rods = drawing.sizes ? [] : [look.body, look.flow, look.accent].map((color) => this.add(new CapsuleGeometry((drawing.ball ? 0.08 : 0.025) * radius, 1, 4, 12), color));
    this.moving.scale.setScalar(this.enlarged);
    this.stage.look(center, 0.97 * reach);
  }

  /** The radius of a body about its origin. */
  radius({ sizes, corners, box }, extent) {
    if (sizes) {
      this.corners = numbersOf(corners, Float32Array);
      const first = this.corners.subarray(0, 2 * sizes[0]), [x, y] = [0, 1].map((j) => first.filter((_, i) => i % 2 === j));
      this.unit = Math.hypot(...[x, y].map((side) => Math.max(...side) - Math.min(...side))) / 2 || 1;
      let most = 0;
      for (let i = 0; i < this.corners.length; i += 2) most = Math.max(most, Math.hypot(this.corners[i], this.corners[i + 1]));
      return most || 1;
    }
    if (box) return Math.hypot(...box.half) + Math.hypot(...box.center);
    return this.orbit.drawing.ball && extent > 0 ? extent / 24 : Math.max(1, extent / 8);
  }

  /** The ribbon of the path; of a body in its place that of its last axis. */
  trail(extent, reach, isFlat, look) {
    const { frames, count } = this.orbit, path = new Float32Array(3 * count), far = extent > 0 ? 0 : 1;
    for (let k = 0; k < count; k++) {
      for (let i = 0; i < 3; i++) path[3 * k + i] = frames[12 * k + i] + far * frames[12 * k + 9 + i];
    }
    this.trace = count > 1 ? ribbon(path, isFlat ? () => {} : this.stage.facing(), 0.02 * reach, look.dark) : null;
    if (!this.trace) return;
    if (isFlat) this.trace.position.z = FLOOR * reach;
    this.fixed.add(this.trace);
  }

  add(geometry, color) {
    const mesh = new Mesh(geometry, solid(color));
    this.moving.add(mesh);
    return mesh;
  }

  body({ sizes, box, ball }, radius, look) {
    this.parts = (sizes ?? []).map((size, k) => new Prism(size, (k ? [0, TOP] : [LOW, HIGH]).map((z) => z * this.unit), k ? look.ink : look.body));
    for (const { mesh } of this.parts) this.moving.add(mesh);
    this.solid = box ? this.add(new BoxGeometry(...box.half.map((x) => 2 * x)), look.body) : null;
    if (this.solid) {
      const [u, v, w] = [0, 1, 2].map((j) => new Vector3(...box.axes.map((row) => row[j])));
      this.inside = new Matrix4().makeBasis(u, v, w).setPosition(...box.center);
      this.solid.matrixAutoUpdate = false;
    }
    if (ball) this.add(new SphereGeometry(radius, 32, 20), look.body);
  }

  show(k) {
    const f = this.orbit.frames.subarray(12 * k, 12 * k + 12), axes = [3, 6, 9].map((i) => new Vector3(...f.subarray(i, i + 3)));
    this.moving.position.set(f[0], f[1], f[2]);
    if (this.parts.length) {
      const { sizes, rows } = this.orbit.drawing, width = this.corners.length / rows;
      let at = rows > 1 ? width * k : 0;
      this.moving.rotation.z = Math.atan2(f[4], f[3]);
      this.parts.forEach((part, i) => {
        if (rows > 1 || !part.geometry.index) part.set(this.corners.subarray(at, (at += 2 * sizes[i])), THIN * this.unit);
      });
    }
    if (this.solid) this.solid.matrix.makeBasis(...axes).multiply(this.inside);
    this.rods.forEach((rod, axis) => {
      const long = axes[axis].length() * this.length;
      rod.visible = long > 0;
      rod.quaternion.setFromUnitVectors(new Vector3(0, 1, 0), axes[axis].normalize());
      rod.scale.set(1, long, 1);
      rod.position.copy(axes[axis]).multiplyScalar(long / 2);
    });
    this.trace?.geometry.setDrawRange(0, 6 * k);
    this.stage.dirty = true;
  }
}
