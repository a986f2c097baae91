// A film of the body, recorded by the page while the motion plays once.

import { Color } from "three";
import { colors } from "./look.mjs";
import { download } from "./share.mjs";

const FRAMES = 30;
const KINDS = ["video/webm;codecs=vp9", "video/webm;codecs=vp8", "video/webm"];

/** Play from the start to the end and give the user the film; pressed again it ends where it is. */
export function film(app, button) {
  if (app.filming) return app.filming.stop();
  const kind = KINDS.find((each) => globalThis.MediaRecorder?.isTypeSupported(each)), stage = app.bodyStage;
  if (!kind) return app.say("This browser cannot record films.", true);
  const parts = [], recorder = new MediaRecorder(stage.canvas.captureStream(FRAMES), { mimeType: kind, videoBitsPerSecond: 6e6 });
  recorder.addEventListener("dataavailable", (event) => parts.push(event.data));
  recorder.addEventListener("stop", () => {
    app.filming = null;
    stage.scene.background = null;
    stage.dirty = true;
    button.textContent = "Film";
    download(new Blob(parts, { type: "video/webm" }), "nonholo.webm");
  });
  stage.scene.background = new Color(colors().card);
  app.clock = 0;
  app.playing = true;
  app.filming = recorder;
  button.textContent = "Stop";
  recorder.start();
}
