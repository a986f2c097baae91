// The surface of discrete momenta, and the orbit that runs on it: the part near the orbit, or as much as asked for.

import { BufferAttribute, BufferGeometry, DoubleSide, Group, Line, LineSegments, Mesh, SphereGeometry } from "three";
import { clear, isSoftware, plain, ribbon, solid, thin } from "./stage.mjs";

export class SurfaceView {
  constructor(stage) {
    this.stage = stage;
    this.group = new Group();
    this.marker = new Group();
    this.others = new Group();
    stage.scene.add(this.group, this.marker, this.others);
  }

  /** Draw a motion, and a curve beside it; with `values`, a function of the state, all real values over its momentum. */
  set(body, state, orbit, look, whole, values, curve) {
    for (const group of [this.group, this.marker, this.others]) clear(group);
    const { parameters: p, time_step: h } = state, { count, y } = orbit, path = [];
    const { rank } = orbit, part = (rows, k) => rows.subarray(rank * k, rank * (k + 1));
    this.point = (k) => body.onLocus(p, h, ...part(orbit.r, k), ...part(y, k));
    let most = 0;
    for (let k = 0; k < count; k++) {
      path.push(this.point(k));
      most = Math.max(most, body.angle(...part(y, k)));
    }
    const reach = whole || values ? Math.PI : Math.min(Math.PI, Math.max(1.6 * most, 1e-3));
    const r = (k) => (count ? part(orbit.r, k) : state.momentum);
    const pointsOver = (k) => values(k).map(([y1, y2]) => body.onLocus(p, h, ...r(k), y1[0], y2[0]));
    const mesh = body.mesh(p, values ? path.concat(pointsOver(0)) : path, reach, ...(isSoftware ? (body.kind === "sleigh" ? [40, 16] : [18, 48]) : []));
    const fit = this.fitted(mesh.points.concat(path));
    this.surface(mesh, fit, look);
    if (values) this.over(body, mesh.points, (k) => [pointsOver(k).map(fit), (s) => fit(body.fibre(p, h, r(k))(s))], look);
    else this.move = null;
    this.path = path.map(fit);
    mesh.marks?.forEach((point, i) => this.ball(this.others, 0.04, i ? look.ink : look.muted, fit(point)));
    if (count > 1) {
      const band = ribbon(Float32Array.from(this.path.flat()), this.stage.facing(), 0.028, look.dark, { depthTest: false });
      band.renderOrder = 2;
      this.group.add(band);
    }
    if (curve) {
      const line = new Line(new BufferGeometry(), thin(look.flow, { depthTest: false }));
      line.geometry.setAttribute("position", new BufferAttribute(Float32Array.from(curve.flatMap(fit)), 3));
      line.renderOrder = 3;
      this.group.add(line);
    }
    this.ball(this.marker, 0.05, look.accent, [0, 0, 0]);
    this.marker.visible = count > 0;
    const reachOf = (point) => Math.hypot(...fit(point));
    this.stage.look([0, 0, 0], 1.04 * mesh.points.reduce((most, point) => Math.max(most, reachOf(point)), 1));
  }

  ball(group, radius, color, place) {
    const dot = new Mesh(new SphereGeometry(radius, 20, 14), plain(color, { depthTest: false }));
    dot.renderOrder = 3;
    dot.position.set(...place);
    group.add(dot);
  }

  /** Return the map of momenta into the box, each axis in its own scale. */
  fitted(points) {
    const low = [Infinity, Infinity, Infinity], high = [-Infinity, -Infinity, -Infinity];
    for (const point of points) {
      for (let i = 0; i < 3; i++) {
        low[i] = Math.min(low[i], point[i]);
        high[i] = Math.max(high[i], point[i]);
      }
    }
    return (point) => point.map((x, i) => (2 * x - low[i] - high[i]) / (high[i] - low[i] || 1));
  }

  surface({ points, rows, columns }, fit, look) {
    const place = new Float32Array(points.flatMap(fit)), faces = [], lines = [];
    for (let i = 0; i + 1 < rows; i++) {
      for (let j = 0; j + 1 < columns; j++) {
        const k = i * columns + j;
        faces.push(k, k + 1, k + columns, k + 1, k + columns + 1, k + columns);
      }
    }
    const every = 4;
    for (let i = 0; i < rows; i++) {
      for (let j = 0; j < columns; j++) {
        const k = i * columns + j;
        if (i % every === 0 && j + 1 < columns) lines.push(k, k + 1);
        if (j % every === 0 && i + 1 < rows) lines.push(k, k + columns);
      }
    }
    const geometry = new BufferGeometry(), net = new BufferGeometry(), attribute = new BufferAttribute(place, 3);
    geometry.setAttribute("position", attribute);
    geometry.setIndex(faces);
    geometry.computeVertexNormals();
    net.setAttribute("position", attribute);
    net.setIndex(lines);
    const sides = { side: DoubleSide, polygonOffset: true, polygonOffsetFactor: 1, polygonOffsetUnits: 1 };
    this.group.add(new Mesh(geometry, solid(look.surface, sides)));
    this.group.add(new LineSegments(net, thin(look.ink, { transparent: true, opacity: 0.22 })));
  }

  /** Make what stands over a momentum: the line of all momenta over it, and where it meets the surface. */
  over(body, points, at, look) {
    const along = points.map((point) => point[body.fibreAxis]), ends = [Math.min(...along), Math.max(...along)];
    const line = new Line(new BufferGeometry(), thin(look.muted, { depthTest: false }));
    const dots = Array.from({ length: 4 }, () => new Mesh(new SphereGeometry(0.045, 20, 14), plain(look.ink, { depthTest: false })));
    [line, ...dots].forEach((part) => (part.renderOrder = 3));
    this.others.add(line, ...dots);
    this.move = (k) => {
      const [places, on] = at(k);
      line.geometry.setAttribute("position", new BufferAttribute(Float32Array.from([...on(ends[0]), ...on(ends[1])]), 3));
      dots.forEach((dot, j) => {
        dot.visible = j > 0 && j < places.length; // the first one is the state's own
        if (dot.visible) dot.position.set(...places[j]);
      });
    };
    this.move(0);
  }

  show(k) {
    this.move?.(k);
    if (!this.path?.length) return;
    this.marker.position.set(...this.path[k]);
    this.stage.dirty = true;
  }
}
