// The page: controls, clock, and views of one state. `mount` serves the file; a host of widgets can call it too.

import { BODIES, takeTable } from "./bodies.mjs";
import { EnergyBalance } from "./balance.mjs";
import { Controls } from "./controls.mjs";
import { levelsOf } from "./forces.mjs";
import { kernelOf, seriesOf } from "./kernel.mjs";
import { colors, short } from "./look.mjs";
import { flowOf, orbitOf } from "./orbit.mjs";
import { EnergyError, PhasePortrait } from "./plots.mjs";
import { noFlow, replayed, ReplayView } from "./replay.mjs";
import { SleighView } from "./sleigh_view.mjs";
import { isSoftware, Stage } from "./stage.mjs";
import { checked, fragmentOf, stateOf } from "./state.mjs";
import { SurfaceView } from "./surface_view.mjs";
import { TopView } from "./top_view.mjs";
import { WideTopView } from "./wide_top_view.mjs";
import { isReal, valuesOver } from "./values.mjs";
import { WeightView } from "./weight_view.mjs";
import { WORDS } from "./words.mjs";

const SECONDS = 16;
const HOLD = 1.2;
const RESTRICTED = ["r₁", "r₂"]; // momenta along the constraint
const VIEWS = { top: TopView, sleigh: SleighView, top4: WideTopView, replay: ReplayView };
const EYES = { top: [1.6, -2, 0.9], sleigh: [0.25, -1.1, 1.25], top4: [1.6, -2, 0.9] };
const byId = (id) => document.getElementById(id);

export class App {
  constructor(data) {
    this.data = data;
    if (data.table) takeTable(data.table);
    this.clock = 0;
    this.speed = 1;
    this.whole = false;
    this.playing = !matchMedia("(prefers-reduced-motion: reduce)").matches;
    this.phase = new PhasePortrait(byId("phase-canvas"));
    this.energies = [EnergyError, EnergyBalance].map((Kind) => new Kind(byId("energy-canvas")));
    this.surfaceStage = new Stage(byId("surface-canvas"), [1.5, -2, 1.3]);
    this.surface = new SurfaceView(this.surfaceStage);
    this.bodyStage = new Stage(byId("body-canvas"), EYES.top);
    this.weight = new WeightView(this.bodyStage);
  }

  async begin() {
    this.replay = this.data.replay;
    if (!this.replay) await this.compile();
    if (this.replay) this.kind = "replay";
    this.controls = new Controls(this);
    const linked = this.kind === "replay" ? null : this.linked();
    if (this.kind !== "replay") this.state = linked?.state ?? checked(this.data.state).state;
    addEventListener("hashchange", () => this.follow());
    matchMedia("(prefers-color-scheme: dark)").addEventListener("change", () => this.refresh());
    this.refresh();
    if (linked?.problem) this.say(`This link could not be read. ${linked.problem}`, true);
    let last = performance.now();
    const tick = (now) => {
      this.tick((now - last) / 1000);
      last = now;
      requestAnimationFrame(tick);
    };
    requestAnimationFrame(tick);
  }

  /** Make the kernels; where the host of the page allows no WebAssembly, replay the motion with which the page was made. */
  async compile() {
    const { kernels, recorded } = this.data;
    try {
      this.kernels = {};
      for (const [kind, text] of Object.entries(kernels)) this.kernels[kind] = await (kind === "flow4" ? seriesOf : kernelOf)(text, kind);
    } catch (failure) {
      if (!recorded || (globalThis.WebAssembly && !(failure instanceof WebAssembly.CompileError))) throw failure;
      this.replay = recorded;
      this.isBarred = true;
    }
  }

  /** The state of the present link, which may be of a body that this page does not have. */
  linked() {
    const linked = stateOf(location.hash);
    return linked?.state && !this.kernels[linked.state.kind] ? { problem: "It is of a body that this page has no kernel for." } : linked;
  }

  /** Take the state of a link that was typed or opened in this page. */
  follow() {
    if (this.kind === "replay" || location.hash === this.fragment) return;
    const linked = this.linked();
    if (linked?.state) this.change(linked.state);
    if (linked?.problem) this.say(`This link could not be read. ${linked.problem}`, true);
  }

  /** Go to a state that is known to be checked, or to some other values of the present one. */
  change(values) {
    const { state, problem } = checked({ ...this.state, ...values });
    if (problem) return this.say(problem, true);
    if (state.kind !== this.state.kind) this.clock = 0;
    this.state = state;
    this.stale = true;
  }

  /** Compute and draw all anew. */
  refresh() {
    this.stale = false;
    const look = colors(), began = performance.now();
    const replay = this.kind === "replay";
    this.body = replay ? { momenta: this.data.momenta ?? RESTRICTED, name: this.data.title } : BODIES[this.state.kind];
    const refusal = replay ? "" : this.body.refusal(this.state.parameters);
    if (refusal) return this.say(refusal, true);
    const run = replay ? null : this.kernels[this.state.kind];
    this.orbit = replay ? replayed(this.replay) : orbitOf(this.body, this.state, run);
    this.took = { compute: performance.now() - began };
    this.flow = replay ? noFlow(this.orbit) : this.flowBeside();
    const kind = replay ? "replay" : this.state.kind;
    if (this.shown !== kind) this.enter(kind);
    this.view.set(this.state, this.orbit, look, this.flow);
    this.weight.set(this.body, this.state, this.orbit, look, this.view);
    if (!replay) this.surface.set(this.body, this.state, this.orbit, look, this.whole, this.values ? (k) => this.allValues(k).filter(isReal) : null, this.flow.curve);
    if (this.crowd) this.crowd.set(this.body, this.state, this.flow, run);
    const counts = this.values && !replay ? this.counts() : null;
    const picture = { crowd: this.crowd, orbit: this.orbit, flow: this.flow, body: this.body, counts };
    this.phase.set(picture, look);
    this.energy = this.energies[Number(Boolean(this.body.isForced))];
    for (const view of this.energies) view.data = null;
    this.energy.set(picture, look);
    this.clock = Math.min(this.clock, Math.max(0, this.orbit.count - 1));
    this.controls.fill();
    this.report();
    this.show();
    this.remember();
    this.took.refresh = performance.now() - began;
  }

  /** The continuous motion with the body axis of permanent rotation of a top: its velocity along the rows is that of c. */
  flowBeside() {
    if (this.body.flow) return this.body.flow(this.state, this.kernels.flow4);
    const flow = flowOf(this.body, this.state), { J13: c1, J23: c2 } = this.state.parameters;
    if (this.body.isForced) return levelsOf(flow, this.orbit);
    return { ...flow, velocityAxis: c1 || c2 ? [-c2, c1, 0] : null };
  }

  /** How many values are real over a momentum along the constraint, as a function. */
  counts() {
    const { body, state } = this, table = body.table(state.parameters), scale = state.time_step * body.share;
    return (r) => body.count(table, [scale * r[0], scale * r[1]]);
  }

  /** All values over the momentum of a state, or of the start where the motion cannot begin. */
  allValues(k) {
    const { r, y, count } = this.orbit;
    if (!count) return valuesOver(this.body, this.state, this.state.momentum, [0, 0]);
    return valuesOver(this.body, this.state, [r[2 * k], r[2 * k + 1]], [y[2 * k], y[2 * k + 1]]);
  }

  enter(kind) {
    if (this.view) this.bodyStage.scene.remove(this.view.fixed, this.view.moving);
    this.bodyStage.turned = false;
    const seen = this.body.kind ?? kind;
    if (this.body.isForced) this.values = false; // values of the map are those of free steps
    this.bodyStage.eye.set(...(EYES[seen] ?? ReplayView.eye(this.orbit))).normalize();
    this.view = new VIEWS[seen](this.bodyStage);
    this.shown = kind;
    document.documentElement.dataset.kind = kind;
    for (const [name, text] of Object.entries(WORDS[kind])) byId(`${name}-words`).innerHTML = text;
    byId("energy-title").textContent = this.body.isForced ? "Energy" : "Energy error";
    byId("energy-canvas").setAttribute("aria-label", this.body.isForced ? "Kinetic and whole energy at each step" : "Relative energy error at each step");
    byId("surface-axes").textContent = this.body.axes ? `${this.body.axes.join(", ")}, each in its own scale` : "";
    byId("title").textContent = this.data.title && kind === this.data.kind ? this.data.title : this.body.name;
  }

  report() {
    const { count, outcome, error } = this.orbit;
    const worst = error.reduce((most, e) => Math.max(most, e), 0);
    if (outcome !== 0) {
      const [name, message] = this.data.outcomes[outcome] ?? ["unknown", ""];
      const steps = this.kind === "replay" ? count - 1 : this.state.steps;
      const where = count === 0 ? "The motion cannot start" : `The motion ends after ${count - 1} of ${steps} steps`;
      byId("stop").textContent = name.replaceAll("_", " ");
      return this.say(`${where}: ${name.replaceAll("_", " ")}. ${message}`, true);
    }
    const reason = this.isBarred ? "WebAssembly is not allowed here, so nothing can be computed anew" : "this body has no kernel in the page";
    const replay = `${count} states replayed: ${reason}`, computed = `${count - 1} steps computed here in ${short(this.took.compute, 2)} ms`;
    const drawn = this.view.enlarged > 1.05 ? ` · body drawn ${short(this.view.enlarged, 2)} times larger` : "";
    const kept = this.body.isForced ? "energy and work agree to" : "energy kept to";
    this.say(`${this.kind === "replay" ? replay : computed} · ${kept} ${short(worst, 2)}${drawn}`, false);
  }

  say(text, wrong) {
    byId("status").textContent = text;
    byId("status").classList.toggle("wrong", wrong);
    byId("stop").hidden = !(wrong && this.orbit && this.orbit.count === 0);
  }

  tick(seconds) {
    if (this.stale) this.refresh();
    const last = this.orbit.count - 1;
    if (this.playing && last > 0) {
      this.clock += (Math.min(seconds, 0.1) * this.speed * (last + 1)) / SECONDS;
      if (this.clock > last && this.filming?.state === "recording") this.filming.stop();
      if (this.clock > last + (HOLD * (last + 1)) / SECONDS) this.clock = 0;
      this.show();
    }
    const began = performance.now();
    this.bodyStage.draw();
    this.frames = (this.frames ?? 0) + 1;
    if (!isSoftware || !this.playing || this.frames % 3 === 0) this.surfaceStage.draw();
    this.took.draw = performance.now() - began;
  }

  get k() {
    return Math.max(0, Math.min(Math.floor(this.clock), this.orbit.count - 1));
  }

  show() {
    if (this.k === this.drawn?.k && this.orbit === this.drawn.orbit) return;
    this.drawn = { k: this.k, orbit: this.orbit };
    this.crowd?.to(this.k);
    if (this.orbit.count) for (const view of [this.view, this.weight, this.surface, this.phase, this.energy]) view.show(this.k);
    this.controls.clock();
    this.controls.now();
  }

  remember() {
    if (this.kind === "replay") return;
    clearTimeout(this.later);
    this.later = setTimeout(() => {
      this.fragment = fragmentOf(this.state);
      this.tell?.(this.state);
      if (this.changed && location.protocol !== "about:") history.replaceState(null, "", this.fragment); // a frame has no address
      this.changed = true;
    }, 250);
  }
}
