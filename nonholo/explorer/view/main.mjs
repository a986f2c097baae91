// The page as a file: its data stand in it, and nothing is fetched.

import { App } from "./app.mjs";

const original = document.documentElement.outerHTML;
const data = JSON.parse(document.getElementById("data").textContent);
const app = new App(data);
app.original = original;
if (parent !== window) app.tell = (state) => parent.postMessage({ nonholo: state }, "*"); // whoever shows the page in a frame
app.begin().catch((failure) => {
  const status = document.getElementById("status");
  status.textContent = `The page could not begin: ${failure.message}`;
  status.classList.add("wrong");
  throw failure;
});

globalThis.nonholo = {
  get state() {
    return app.state;
  },
  get orbit() {
    return app.orbit;
  },
  get flow() {
    return app.flow;
  },
  /** All values of the map over the present momentum along the constraint: two complex coordinates each. */
  get values() {
    return app.allValues(app.k);
  },
  /** How many values are real over a momentum. */
  count(r) {
    return app.counts()(r);
  },
  /** The point of a state on the surface of momenta. */
  point(k) {
    return app.surface.point(k);
  },
  get crowd() {
    return app.crowd;
  },
  /** Milliseconds of the last computation, of all that a change took, and of the last picture in space. */
  get took() {
    return { ...app.took };
  },
};
