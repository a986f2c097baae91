// Sliders, the clock's buttons, what is shared, and dragging on the phase portrait.

import { BODIES } from "./bodies.mjs";
import { MOST_STEPS } from "./kernel.mjs";
import { Crowd } from "./crowd.mjs";
import { film } from "./film.mjs";
import { colors, short } from "./look.mjs";
import { download, pageWith, pictureOf, pythonOf, tomlOf } from "./share.mjs";
import { fragmentOf } from "./state.mjs";
import { isReal } from "./values.mjs";
import { WIDE_PRESETS } from "./wide_top.mjs";
import { PRESETS } from "./words.mjs";

const byId = (id) => document.getElementById(id);
const element = (name, attributes = {}, ...children) => {
  const made = document.createElement(name);
  for (const [key, value] of Object.entries(attributes)) made.setAttribute(key, value);
  made.append(...children);
  return made;
};

export class Controls {
  constructor(app) {
    this.app = app;
    this.fields = [];
    this.clockButtons();
    this.sharing();
    this.cards();
    if (app.kind === "replay") return;
    this.presets();
    this.dragging();
  }

  presets() {
    const select = byId("preset"), all = [...PRESETS, ...WIDE_PRESETS].filter(({ kind }) => this.app.kernels[kind]);
    all.forEach(({ name }, k) => select.append(element("option", { value: k }, name)));
    select.addEventListener("change", () => {
      const { data } = this.app;
      this.chosen = null;
      const chosen = select.value === "own" ? data.state : { table: undefined, ...all[select.value] };
      this.app.clock = 0;
      this.app.values = Boolean(chosen.values);
      byId("values").setAttribute("aria-pressed", String(this.app.values));
      this.app.change({ pose: null, ...chosen });
    });
  }

  /** Make a slider with a number beside it for each value of the state; make them anew for another body. */
  build() {
    const { app } = this, { state } = app, body = BODIES[state.kind];
    this.kind = state.kind;
    this.fields = [];
    const group = (id, fields) => byId(id).replaceChildren(...fields.map((field) => this.field(field)));
    const all = body.parameters.map((p) => ({
      ...p, get: () => app.state.parameters[p.key], set: (x) => ({ parameters: { ...app.state.parameters, [p.key]: x } }),
    }));
    group("parameters", all.filter((p) => !p.isForce));
    group("forces", all.filter((p) => p.isForce));
    group("start", body.momenta.map((label, k) => ({
      key: `r${k + 1}`, label, name: `momentum ${k + 1} at the start`, min: -3, max: 3, step: 0.01,
      get: () => app.state.momentum[k], set: (x) => ({ momentum: app.state.momentum.map((r, i) => (i === k ? x : r)) }),
    })));
    group("run", [
      { key: "time_step", label: "h", name: "time step", min: 0.01, max: 2, step: 0.01, get: () => app.state.time_step, set: (x) => ({ time_step: x }) },
      { key: "steps", label: "steps", name: "number of steps", min: 10, max: 3000, step: 10, get: () => app.state.steps, set: (x) => ({ steps: Math.min(Math.round(x), MOST_STEPS) }) },
    ]);
  }

  field({ key, label, name, min, max, step, get, set }) {
    const slider = element("input", { type: "range", id: `slide-${key}`, min, max, step, "aria-label": name });
    const number = element("input", { type: "number", id: `number-${key}`, step: "any", "aria-label": `${name}, as a number` });
    const take = (text) => {
      const value = Number(text);
      if (text.trim() !== "" && Number.isFinite(value)) this.app.change(set(value));
    };
    slider.addEventListener("input", () => take(slider.value));
    number.addEventListener("change", () => take(number.value));
    this.fields.push({ slider, number, get });
    return element("div", { class: "field" }, element("label", { for: `slide-${key}`, title: name }, label), slider, number);
  }

  /** Show the values of the state. */
  fill() {
    const { app } = this, scrub = byId("scrub");
    if (app.kind !== "replay") {
      if (this.kind !== app.state.kind) this.build();
      const text = JSON.stringify(app.state);
      this.chosen ??= text;
      if (text !== this.chosen) byId("preset").value = "changed";
      for (const { slider, number, get } of this.fields) {
        slider.value = get();
        if (document.activeElement !== number) number.value = String(+get().toPrecision(12));
      }
    }
    scrub.max = Math.max(0, app.orbit.count - 1);
    scrub.disabled = app.orbit.count < 2;
  }

  /** Show the time. */
  clock() {
    const { app } = this, { k, orbit } = app;
    byId("scrub").value = k;
    byId("scrub").setAttribute("aria-valuetext", `step ${k}`);
    byId("time").textContent = orbit.count ? `t = ${short(orbit.time(k), 4)}` : "t = –";
    byId("step").textContent = `step ${Math.max(0, k)}`;
    byId("play").setAttribute("aria-label", app.playing ? "Pause" : "Play");
    byId("play").dataset.playing = app.playing;
  }

  /** Show the numbers of the present state. */
  now() {
    const { app } = this, { k, orbit, body } = app, list = byId("now"), part = (rows) => rows.subarray(orbit.rank * k, orbit.rank * (k + 1));
    const known = orbit.count ? [
      ...(orbit.coordinate?.(k) ?? []).map(([name, x]) => [name, short(x, 6)]),
      ...body.momenta.map((label, i) => [label, short(part(orbit.r)[i], 6)]),
      ["energy", short(orbit.energy[k], 6)],
      ...(app.state?.table ? [["force", body.acting(app.state.parameters, k).map((f) => short(f, 3)).join(", ")]] : []),
      ...(body.angle ? [["step angle", `${short((body.angle(...part(orbit.y)) * 180) / Math.PI, 4)}°`]] : []),
    ] : [];
    if (app.values && app.kind !== "replay") known.push(["real values", this.counted(app.allValues(k))]);
    if (list.children.length !== 2 * known.length) {
      list.replaceChildren(...known.flatMap(() => [element("dt"), element("dd")]));
    }
    known.flat().forEach((text, place) => {
      if (list.children[place].textContent !== text) list.children[place].textContent = text;
    });
  }

  counted(values) {
    return `${values.filter(isReal).length} of ${values.length}`;
  }

  /** Turn something on or off that is not of the motion, and draw anew. */
  toggle(name, on) {
    this.app[name] = on;
    byId(name).setAttribute("aria-pressed", String(on));
    this.app.refresh();
  }

  clockButtons() {
    const { app } = this;
    const play = (on) => {
      app.playing = on;
      byId("play").setAttribute("aria-label", on ? "Pause" : "Play");
      byId("play").dataset.playing = on;
    };
    byId("play").addEventListener("click", () => {
      if (!app.playing && app.k === app.orbit.count - 1) app.clock = 0;
      play(!app.playing);
    });
    byId("scrub").addEventListener("input", () => {
      play(false);
      app.clock = Number(byId("scrub").value);
      app.show();
    });
    byId("speed").addEventListener("change", () => (app.speed = Number(byId("speed").value)));
    addEventListener("keydown", (event) => {
      if (event.key !== " " || event.target.closest("button, input, select, textarea, a, summary")) return;
      event.preventDefault();
      play(!app.playing);
    });
    byId("theme").addEventListener("click", () => {
      document.documentElement.dataset.theme = colors().dark ? "light" : "dark";
      app.refresh();
    });
  }

  sharing() {
    const { app } = this, original = document.documentElement.outerHTML;
    const menu = byId("share");
    const close = (event) => menu.open && !menu.contains(event.target) && (menu.open = false);
    addEventListener("pointerdown", close);
    menu.addEventListener("keydown", (event) => {
      if (event.key !== "Escape") return;
      menu.open = false;
      menu.querySelector("summary").focus();
    });
    const offer = (id, heading, make) => byId(id)?.addEventListener("click", () => this.offer(heading, make()));
    offer("copy-link", "A link to this motion", () => location.href.replace(/#.*$/, "") + fragmentOf(app.state));
    offer("copy-python", "Python for the same numbers", () => pythonOf(app.state));
    offer("copy-toml", "A scenario for nonholo simulate", () => tomlOf(app.state));
    byId("save").addEventListener("click", () => {
      const own = app.kind === "replay" ? {} : { state: app.state, kind: app.state.kind };
      download(pageWith(this.app.original ?? original, { ...app.data, ...own }), "nonholo.html", "text/html");
    });
    byId("dialog-close").addEventListener("click", () => byId("dialog").close());
  }

  /** Copy a text, and show it for those whose browser does not. */
  async offer(heading, text) {
    byId("share").open = false;
    byId("dialog-title").textContent = heading;
    byId("dialog-text").value = text;
    byId("dialog").showModal();
    byId("dialog-text").select();
    const copied = await navigator.clipboard?.writeText(text).then(() => true, () => false);
    byId("dialog-note").textContent = copied ? "Copied to the clipboard." : "Select and copy it from here.";
  }

  cards() {
    const { app } = this;
    for (const card of document.querySelectorAll(".card[id]")) {
      const about = card.querySelector(".about"), words = card.querySelector(".words"), picture = card.querySelector(".picture");
      about?.addEventListener("click", () => {
        words.hidden = !words.hidden;
        about.setAttribute("aria-expanded", String(!words.hidden));
      });
      picture?.addEventListener("click", async () => {
        const stage = { body: app.bodyStage, surface: app.surfaceStage }[card.id];
        if (stage) {
          stage.dirty = true;
          stage.draw();
        }
        download(await pictureOf(card.querySelector("canvas"), colors().card), `nonholo-${card.id}.png`);
      });
    }
    byId("film").addEventListener("click", () => film(app, byId("film")));
    byId("many").addEventListener("click", () => {
      app.crowd = app.crowd ? null : new Crowd();
      byId("many").setAttribute("aria-pressed", String(Boolean(app.crowd)));
      app.refresh();
    });
    for (const name of ["whole", "values"]) byId(name).addEventListener("click", () => this.toggle(name, !app[name]));
  }

  dragging() {
    const { app } = this, canvas = byId("phase-canvas");
    const take = (event) => {
      const momentum = app.phase.momentumAt(event.offsetX, event.offsetY).map((r) => +r.toPrecision(4));
      app.clock = 0;
      app.change({ momentum: [...momentum, ...app.state.momentum.slice(2)] });
    };
    canvas.addEventListener("pointerdown", (event) => {
      canvas.setPointerCapture(event.pointerId);
      take(event);
    });
    canvas.addEventListener("pointermove", (event) => canvas.hasPointerCapture(event.pointerId) && take(event));
    canvas.addEventListener("keydown", (event) => {
      const way = { ArrowLeft: [-1, 0], ArrowRight: [1, 0], ArrowUp: [0, 1], ArrowDown: [0, -1] }[event.key];
      if (!way) return;
      event.preventDefault();
      app.change({ momentum: app.state.momentum.map((r, i) => +(r + 0.02 * (way[i] ?? 0) * app.phase.reach).toPrecision(6)) });
    });
  }
}
