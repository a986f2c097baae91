"""How fast the live page is in Chromium without a graphics card: python benchmarks/live_page.py [CHROMIUM].

Prints the size of a page; milliseconds from a slider to the new picture for 2,000 steps, as medians of 60 changes: the
kernel alone, all that the page computes, and both with drawing; frames a second while a motion plays; and milliseconds
of a step of ten thousand motions.
"""

import shutil
import sys
import tempfile
import time
from pathlib import Path

from playwright.sync_api import sync_playwright

import nonholo as nh

_FLAGS = ["--no-sandbox", "--use-angle=swiftshader", "--enable-unsafe-swiftshader"]
_CHANGE = """async (key) => {
  const frame = () => new Promise((done) => requestAnimationFrame(done));
  const set = (id, value) => {
    const slider = document.getElementById(id);
    slider.value = value;
    slider.dispatchEvent(new Event("input"));
  };
  const median = (all) => all.sort((a, b) => a - b)[all.length >> 1];
  document.getElementById("play").click();
  set("slide-steps", 2000);
  await frame(); await frame();
  const compute = [], refresh = [], picture = [];
  for (let k = 0; k < 60; k++) {
    const began = performance.now();
    set(`slide-${key}`, 0.2 + 0.004 * k);
    await frame(); await frame();
    picture.push(performance.now() - began);
    compute.push(nonholo.took.compute);
    refresh.push(nonholo.took.refresh);
  }
  return { kernel: median(compute), page: median(refresh), picture: median(picture) };
}"""
_FRAMES = """async () => {
  document.getElementById("play").click();
  let count = 0;
  const began = performance.now();
  while (performance.now() - began < 4000) {
    await new Promise((done) => requestAnimationFrame(done));
    count++;
  }
  return count / 4;
}"""
_CROWD = """() => {
  document.getElementById("play").click();
  document.getElementById("many").click();
  const all = [], scrub = document.getElementById("scrub");
  for (let k = 1; k < 60; k++) {
    scrub.value = k;
    const began = performance.now();
    scrub.dispatchEvent(new Event("input"));
    all.push(performance.now() - began);
  }
  return all.sort((a, b) => a - b)[all.length >> 1];
}"""


def main() -> None:
    """Measure and print."""
    program = sys.argv[1] if len(sys.argv) > 1 else shutil.which("chromium")
    top = nh.SuslovTop([[1.4, 0.2, 0.5], [0.2, 1.0, -0.3], [0.5, -0.3, 0.9]])
    bodies = {"top": (top, "J13"), "sleigh": (nh.ChaplyginSleigh(1.0, 1.0, 0.5), "a")}
    with tempfile.TemporaryDirectory() as folder, sync_playwright() as playwright:
        browser = playwright.chromium.launch(executable_path=program, args=_FLAGS)
        for name, (body, key) in bodies.items():
            path = Path(folder) / f"{name}.html"
            began = time.process_time()
            nh.explore(body).save(path)
            took = time.process_time() - began
            print(f"{name}: {path.stat().st_size / 1e3:.0f} kB, {took:.3f} s of processor to write")
            page = browser.new_page(viewport={"width": 1280, "height": 800})
            page.goto(path.as_uri())
            page.wait_for_timeout(1000)
            change = page.evaluate(_CHANGE, key)
            print("  " + ", ".join(f"{part} {milliseconds:.1f} ms" for part, milliseconds in change.items()))
            frames, crowd = page.evaluate(_FRAMES), page.evaluate(_CROWD)
            print(f"  {frames:.0f} frames a second, {crowd:.1f} ms for a step of 10,000 motions")
            page.close()
        browser.close()


if __name__ == "__main__":
    main()
