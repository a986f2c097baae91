// A stage in space: one canvas, light, a camera that turns, and a picture that is drawn only when something changed.

import {
  AmbientLight, BufferAttribute, BufferGeometry, Color, DirectionalLight, DoubleSide, Mesh, MeshBasicMaterial,
  MeshLambertMaterial, MeshStandardMaterial, PerspectiveCamera, SRGBColorSpace, Scene, Spherical, Vector3, WebGLRenderer,
} from "three";
import { OrbitControls } from "three/addons/controls/OrbitControls.js";

/** Whether WebGL runs without a graphics card: then light materials, and no smoothing of edges. */
export const isSoftware = (() => {
  const gl = document.createElement("canvas").getContext("webgl2");
  if (!gl) return true;
  const info = gl.getExtension("WEBGL_debug_renderer_info");
  const name = String(gl.getParameter(info ? info.UNMASKED_RENDERER_WEBGL : gl.RENDERER));
  gl.getExtension("WEBGL_lose_context")?.loseContext();
  return /swiftshader|llvmpipe|software|basic render/i.test(name);
})();

export class Stage {
  constructor(canvas, eye, up = [0, 0, 1]) {
    this.renderer = new WebGLRenderer({ canvas, antialias: !isSoftware, alpha: true });
    this.renderer.setPixelRatio(isSoftware ? 1 : Math.min(window.devicePixelRatio || 1, 2));
    this.canvas = canvas;
    this.scene = new Scene();
    this.camera = new PerspectiveCamera(32, 1, 0.01, 1000);
    this.camera.up.set(...up);
    this.eye = new Vector3(...eye).normalize();
    this.controls = new OrbitControls(this.camera, canvas);
    this.controls.enableDamping = false;
    this.controls.enablePan = false;
    canvas.style.touchAction = "pan-y";
    this.controls.addEventListener("change", () => (this.dirty = true));
    this.scene.add(new AmbientLight(0xffffff, 1.5));
    const sun = new DirectionalLight(0xffffff, 2.1);
    sun.position.set(2, -3, 5);
    this.scene.add(sun);
    canvas.addEventListener("keydown", (event) => this.key(event));
    new ResizeObserver(() => this.resize()).observe(canvas.parentElement);
    this.look([0, 0, 0], 1);
  }

  /** Put the camera so that a ball is seen whole. */
  look(center, radius) {
    this.target = new Vector3(...center);
    this.radius = radius;
    this.fit();
  }

  fit() {
    const { camera, controls } = this;
    const half = Math.atan(Math.tan((camera.fov * Math.PI) / 360) * Math.min(1, camera.aspect));
    const direction = this.turned ? camera.position.clone().sub(controls.target).normalize() : this.eye;
    this.turned = true;
    controls.target.copy(this.target);
    camera.position.copy(this.target).addScaledVector(direction, this.radius / Math.sin(half));
    camera.near = this.radius / 100;
    camera.far = this.radius * 100;
    camera.updateProjectionMatrix();
    controls.update();
    this.dirty = true;
  }

  resize() {
    const { clientWidth: w, clientHeight: h } = this.canvas.parentElement;
    if (!w || !h) return;
    this.renderer.setSize(w, h, false);
    this.camera.aspect = w / h;
    this.fit();
  }

  key(event) {
    const turns = { ArrowLeft: [-0.1, 0], ArrowRight: [0.1, 0], ArrowUp: [0, -0.1], ArrowDown: [0, 0.1] };
    const zooms = { "+": 0.9, "=": 0.9, "-": 1.1 };
    const { camera, controls } = this;
    if (!(event.key in turns) && !(event.key in zooms)) return;
    event.preventDefault();
    const away = camera.position.clone().sub(controls.target);
    const [x, y, z] = [away.x, away.y, away.z];
    const sphere = new Spherical().setFromVector3(new Vector3(x, z, -y));
    const [turn, tilt] = turns[event.key] ?? [0, 0];
    sphere.theta += turn;
    sphere.phi = Math.min(Math.max(sphere.phi + tilt, 0.05), Math.PI - 0.05);
    sphere.radius *= zooms[event.key] ?? 1;
    const to = new Vector3().setFromSpherical(sphere);
    camera.position.copy(controls.target).add(new Vector3(to.x, -to.z, to.y));
    controls.update();
    this.dirty = true;
  }

  /** Draw if something changed; tell whether. */
  draw() {
    if (!this.dirty) return false;
    this.dirty = false;
    this.renderer.render(this.scene, this.camera);
    return true;
  }
}

/** The material of a solid: simple without a graphics card. */
export const solid = (color, more = {}) =>
  isSoftware ? new MeshLambertMaterial({ color, ...more }) : new MeshStandardMaterial({ color, roughness: 0.55, ...more });

export const plain = (color, more = {}) => new MeshBasicMaterial({ color: new Color(color), ...more });

/** A band along points, as wide as told, across normals; `colors` has one for each point. */
export function ribbon(points, normals, width, colors) {
  const count = points.length, place = new Float32Array(6 * count), paint = new Float32Array(6 * count), index = [];
  const across = new Vector3(), along = new Vector3(), color = new Color();
  for (let k = 0; k < count; k++) {
    const [p, q] = [points[Math.max(0, k - 1)], points[Math.min(count - 1, k + 1)]];
    along.set(q[0] - p[0], q[1] - p[1], q[2] - p[2]);
    const next = new Vector3(...normals(points[k])).cross(along);
    if (next.lengthSq() > 1e-24) across.copy(next.normalize().multiplyScalar(width / 2));
    for (const [side, sign] of [[0, 1], [3, -1]]) {
      place.set([points[k][0] + sign * across.x, points[k][1] + sign * across.y, points[k][2] + sign * across.z], 6 * k + side);
      paint.set(color.setRGB(...colors[k], SRGBColorSpace).toArray(), 6 * k + side);
    }
    if (k) index.push(2 * k - 2, 2 * k - 1, 2 * k, 2 * k, 2 * k - 1, 2 * k + 1);
  }
  const geometry = new BufferGeometry();
  geometry.setAttribute("position", new BufferAttribute(place, 3));
  geometry.setAttribute("color", new BufferAttribute(paint, 3));
  geometry.setIndex(index);
  const mesh = new Mesh(geometry, new MeshBasicMaterial({ vertexColors: true, side: DoubleSide }));
  mesh.frustumCulled = false;
  return mesh;
}

/** Free what a group holds on the graphics card, and empty it. */
export function clear(group) {
  group.traverse((part) => {
    part.geometry?.dispose();
    part.material?.dispose();
  });
  group.clear();
}
