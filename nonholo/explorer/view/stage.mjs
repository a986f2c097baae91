// A stage in space: one canvas, light, a camera that turns, and a picture that is drawn only when something changed.

import {
  AmbientLight, BufferAttribute, BufferGeometry, Color, DirectionalLight, DoubleSide,
  LineBasicMaterial, LineSegments, Mesh, MeshBasicMaterial,
  MeshStandardMaterial, PerspectiveCamera, SRGBColorSpace, Scene, ShaderMaterial, Spherical, Vector3, WebGLRenderer,
} from "three";
import { OrbitControls } from "three/addons/controls/OrbitControls.js";
import { timeColor } from "./look.mjs";

/** Whether WebGL runs without a graphics card: then light materials, and no smoothing of edges. */
export const isSoftware = (() => {
  const gl = document.createElement("canvas").getContext("webgl2");
  if (!gl) return true;
  const info = gl.getExtension("WEBGL_debug_renderer_info");
  const name = String(gl.getParameter(info ? info.UNMASKED_RENDERER_WEBGL : gl.RENDERER));
  gl.getExtension("WEBGL_lose_context")?.loseContext();
  return /swiftshader|llvmpipe|software|basic render/i.test(name);
})();

const STILL = 350; // milliseconds
const AMBIENT = 1.5, SUNLIGHT = 2.1, SUN = [2, -3, 5];

export class Stage {
  constructor(canvas, eye, up = [0, 0, 1]) {
    this.renderer = new WebGLRenderer({ canvas, antialias: !isSoftware, alpha: true });
    this.renderer.setPixelRatio(isSoftware ? 1 : Math.min(window.devicePixelRatio || 1, 2));
    this.canvas = canvas;
    this.fine = false;
    this.changed = 0;
    this.scene = new Scene();
    this.camera = new PerspectiveCamera(32, 1, 0.01, 1000);
    this.camera.up.set(...up);
    this.eye = new Vector3(...eye).normalize();
    this.controls = new OrbitControls(this.camera, canvas);
    this.controls.enableDamping = false;
    this.controls.enablePan = false;
    canvas.style.touchAction = "pan-y";
    this.controls.addEventListener("change", () => (this.dirty = true));
    this.scene.add(new AmbientLight(0xffffff, AMBIENT));
    const sun = new DirectionalLight(0xffffff, SUNLIGHT);
    sun.position.set(...SUN);
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

  /** What turns a ribbon toward the camera, from where it is now. */
  facing() {
    const eye = this.camera.position.toArray();
    return (p, normal) => ([normal[0], normal[1], normal[2]] = [eye[0] - p[0], eye[1] - p[1], eye[2] - p[2]]);
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

  /** Draw if something changed; without a graphics card once more, finer, when all stands still. */
  draw(now = performance.now()) {
    const isStill = isSoftware && !this.fine && now - this.changed > STILL;
    if (!this.dirty && !isStill) return;
    if (this.dirty) this.changed = now;
    if (isSoftware && this.fine === this.dirty) {
      this.fine = !this.dirty;
      this.renderer.setPixelRatio(this.fine ? 2 : 1);
    }
    this.dirty = false;
    this.renderer.render(this.scene, this.camera);
  }
}

const materials = new Map();

/** The material of a kind, a color and options: one for all that ask, since each new one is a program to compile. */
function material(Kind, options) {
  const key = Kind.name + JSON.stringify(options);
  if (!materials.has(key)) materials.set(key, new Kind(options));
  return materials.get(key);
}

/** A dull solid under the light of the stage, which is reckoned at corners instead of at every pixel. */
class Dull extends ShaderMaterial {
  constructor({ color, ...more }) {
    const sun = new Vector3(...SUN).normalize();
    super({ ...more, uniforms: { own: { value: new Color(color) }, sun: { value: sun } }, vertexShader: CORNER, fragmentShader: PIXEL });
  }
}

const CORNER = `
uniform vec3 own, sun;
varying vec3 shade;
void main() {
  vec4 place = modelViewMatrix * vec4(position, 1.0);
  vec3 outwards = normalize(normalMatrix * normal);
  if (dot(outwards, place.xyz) > 0.0) outwards = -outwards;
  float light = ${(AMBIENT / Math.PI).toFixed(4)} + ${(SUNLIGHT / Math.PI).toFixed(4)} * max(0.0, dot(outwards, mat3(viewMatrix) * sun));
  shade = light * own;
  #ifdef USE_COLOR
  shade *= color;
  #endif
  gl_Position = projectionMatrix * place;
}`;
const PIXEL = `
varying vec3 shade;
void main() {
  gl_FragColor = vec4(shade, 1.0);
  #include <colorspace_fragment>
}`;

/** The material of a solid: simple without a graphics card. */
export const solid = (color, more = {}) =>
  isSoftware ? material(Dull, { color, ...more }) : material(MeshStandardMaterial, { color, roughness: 0.55, ...more });

export const plain = (color, more = {}) => material(MeshBasicMaterial, { color, ...more });

export const thin = (color, more = {}) => material(LineBasicMaterial, { color, ...more });

/**
 * A band along points, as wide as told, colored by time. Points lie one after another in an array; `facing` writes the
 * normal at a point to its second argument.
 */
export function ribbon(points, facing, width, dark, more = {}) {
  const count = points.length / 3, place = new Float32Array(6 * count), paint = new Float32Array(6 * count);
  const index = new Uint32Array(6 * Math.max(0, count - 1)), shades = timeShades(dark);
  const here = [0, 0, 0], normal = [0, 0, 1], across = [0, 0, 0];
  for (let k = 0; k < count; k++) {
    const p = 3 * Math.max(0, k - 1), q = 3 * Math.min(count - 1, k + 1), at = 3 * k;
    const x = points[q] - points[p], y = points[q + 1] - points[p + 1], z = points[q + 2] - points[p + 2];
    for (let i = 0; i < 3; i++) here[i] = points[at + i];
    facing(here, normal);
    const u = normal[1] * z - normal[2] * y, v = normal[2] * x - normal[0] * z, w = normal[0] * y - normal[1] * x;
    const size = Math.sqrt(u * u + v * v + w * w), half = width / 2 / size;
    if (size > 1e-12) [across[0], across[1], across[2]] = [half * u, half * v, half * w];
    const shade = 3 * Math.floor((SHADES * k) / count);
    for (let i = 0; i < 3; i++) {
      place[2 * at + i] = points[at + i] + across[i];
      place[2 * at + 3 + i] = points[at + i] - across[i];
      paint[2 * at + i] = paint[2 * at + 3 + i] = shades[shade + i];
    }
    for (let i = 0; i < 6 && k; i++) index[6 * k - 6 + i] = 2 * k + CORNERS[i];
  }
  const geometry = new BufferGeometry();
  geometry.setAttribute("position", new BufferAttribute(place, 3));
  geometry.setAttribute("color", new BufferAttribute(paint, 3));
  geometry.setIndex(new BufferAttribute(index, 1));
  const mesh = new Mesh(geometry, material(MeshBasicMaterial, { vertexColors: true, side: DoubleSide, ...more }));
  mesh.frustumCulled = false;
  return mesh;
}

const CORNERS = [-2, -1, 0, 0, -1, 1]; // of the two triangles between neighbors
const SHADES = 256;
const shadesOf = {};

/** The colors of the time as the graphics card adds them up. */
function timeShades(dark) {
  const color = new Color(), all = (shadesOf[dark] ??= new Float32Array(3 * SHADES));
  if (all[0] + all[1] + all[2] === 0) {
    for (let k = 0; k < SHADES; k++) all.set(color.setRGB(...timeColor(k / (SHADES - 1), dark), SRGBColorSpace).toArray(), 3 * k);
  }
  return all;
}

/** The lines of a floor about a point, at its height. */
export function grid(center, reach, look) {
  const step = 10 ** Math.floor(Math.log10(reach)), size = reach > 5 * step ? 2 * step : reach > 2 * step ? step : step / 2;
  const [x0, y0] = center.map((x) => Math.round(x / size) * size), count = Math.ceil((1.6 * reach) / size), points = [];
  for (let k = -count; k <= count; k++) {
    points.push(new Vector3(x0 + k * size, y0 - count * size, 0), new Vector3(x0 + k * size, y0 + count * size, 0));
    points.push(new Vector3(x0 - count * size, y0 + k * size, 0), new Vector3(x0 + count * size, y0 + k * size, 0));
  }
  const lines = new LineSegments(new BufferGeometry().setFromPoints(points), thin(look.ground));
  lines.position.z = center[2];
  return lines;
}

/** Free the shapes that a group holds on the graphics card, and empty it. */
export function clear(group) {
  group.traverse((part) => part.geometry?.dispose());
  group.clear();
}
