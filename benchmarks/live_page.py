"""How fast the live page is in Chromium without a graphics card: python benchmarks/live_page.py [CHROMIUM] [--smoke].

Prints the size of a page, and for 2,000 steps medians, in milliseconds, of 60 changes of a slider:

- compute: the orbit alone, by the kernel; refresh: all that follows from it, with the pictures in the plane;
- drawn: from the slider's event until every picture is drawn, those in space too, one pixel of which is read back;
- shown: the same in the frames of the screen, which the change waits for: half a frame on average before any work.

Then frames a second while a motion plays, and milliseconds of a step of ten thousand motions.
"""

import shutil
import tempfile
import time
from pathlib import Path

from _command import leave_out, options, small
from peers.solvers import missing

import nonholo as nh

_FLAGS = ["--no-sandbox", "--use-angle=swiftshader", "--enable-unsafe-swiftshader"]
_HOLD = """
const screen = requestAnimationFrame.bind(window);  // the page's clock can be held, and turned by hand
window.requestAnimationFrame = (tick) => { window.tick = tick; return window.held ? 0 : screen(tick); };
window.frame = () => new Promise((done) => screen(done));
window.release = () => { window.held = false; screen(window.tick); };
"""
_COMMON = """
  const set = (id, value) => {
    const slider = document.getElementById(id);
    slider.value = value;
    slider.dispatchEvent(new Event("input"));
  };
  const median = (all) => all.sort((a, b) => a - b)[all.length >> 1];
  const finish = () => {
    for (const id of ["body-canvas", "surface-canvas"]) {
      const gl = document.getElementById(id).getContext("webgl2");
      gl.readPixels(0, 0, 1, 1, gl.RGBA, gl.UNSIGNED_BYTE, new Uint8Array(4));
    }
    for (const id of ["phase-canvas", "energy-canvas"]) {
      document.getElementById(id).getContext("2d").getImageData(0, 0, 1, 1);
    }
  };
"""
_CHANGE = f"""async (key) => {{ {_COMMON}
  document.getElementById("play").click();
  set("slide-steps", 2000);
  for (let k = 0; k < 60; k++) await frame();
  const all = {{ compute: [], refresh: [], drawn: [], shown: [] }};
  const value = (k) => 0.2 + 0.004 * k;
  window.held = true;
  await frame(); await frame();
  for (let k = 0; k < 60; k++) {{
    const began = performance.now();
    set(`slide-${{key}}`, value(k));
    tick(began);
    finish();
    all.drawn.push(performance.now() - began);
    for (const part of ["compute", "refresh"]) all[part].push(nonholo.took[part]);
    await new Promise((done) => setTimeout(done, 60));  // until the screen has the picture, which costs time of its own
  }}
  release();
  for (let k = 0; k < 60; k++) {{
    await new Promise((done) => setTimeout(done, 50 + 17 * Math.random()));
    const began = performance.now();
    set(`slide-${{key}}`, value(k));
    await frame();
    finish();
    all.shown.push(performance.now() - began);
  }}
  return Object.fromEntries(Object.entries(all).map(([part, times]) => [part, median(times)]));
}}"""
_FRAMES = """async () => {
  document.getElementById("play").click();
  let count = 0;
  const began = performance.now();
  while (performance.now() - began < 4000) {
    await frame();
    count++;
  }
  return count / 4;
}"""
_CROWD = f"""() => {{ {_COMMON}
  document.getElementById("play").click();
  document.getElementById("many").click();
  const all = [];
  for (let k = 1; k < 60; k++) {{
    const began = performance.now();
    set("scrub", k);
    all.push(performance.now() - began);
  }}
  return median(all);
}}"""


def main() -> None:
    """Measure and print."""
    parser = options(__doc__)
    parser.add_argument("chromium", nargs="?", default=shutil.which("chromium"))
    program = parser.parse_args().chromium
    if reason := missing("playwright"):
        leave_out(reason)
    if program is None:
        leave_out("no chromium")
    from playwright.sync_api import sync_playwright

    top = nh.SuslovTop([[1.4, 0.2, 0.5], [0.2, 1.0, -0.3], [0.5, -0.3, 0.9]])
    wide = nh.SuslovTop.arrowhead(diagonal=[1.4, 1.0, 0.7, 0.9], coupling=[0.25, -0.15, 0.1])
    bodies = {"top": (top, "J13"), "sleigh": (nh.ChaplyginSleigh(1.0, 1.0, 0.5), "a"), "top on SO(4)": (wide, "J14")}
    with tempfile.TemporaryDirectory() as folder, sync_playwright() as playwright:
        browser = playwright.chromium.launch(executable_path=program, args=_FLAGS)
        for name, (body, key) in list(bodies.items())[: small(None, 1)]:
            path = Path(folder) / f"{name}.html"
            began = time.process_time()
            nh.explore(body).save(path)
            took = time.process_time() - began
            print(f"{name}: {path.stat().st_size / 1e3:.0f} kB, {took:.3f} s of processor to write")
            page = browser.new_page(viewport={"width": 1280, "height": 800})
            page.add_init_script(_HOLD)
            page.goto(path.as_uri())
            page.wait_for_timeout(1000)
            change = page.evaluate(_CHANGE, key)
            print("  " + ", ".join(f"{part} {milliseconds:.1f} ms" for part, milliseconds in change.items()))
            frames = page.evaluate(_FRAMES)
            crowd = "" if body is wide else f", {page.evaluate(_CROWD):.1f} ms for a step of 10,000 motions"
            print(f"  {frames:.0f} frames a second{crowd}")
            page.close()
        browser.close()


if __name__ == "__main__":
    main()
