// The page in a frame of a notebook, which may not touch the notebook: it says what its sliders say, as data.

export default {
  render({ model, el }) {
    const frame = document.createElement("iframe");
    frame.setAttribute("sandbox", "allow-scripts allow-downloads allow-modals");
    frame.title = "The live page of nonholo";
    frame.style.cssText = `width:100%;height:${model.get("height")}px;border:0`;
    frame.srcdoc = model.get("text");
    const hear = ({ source, data }) => {
      if (source !== frame.contentWindow || typeof data?.nonholo !== "object") return;
      model.set("state", data.nonholo);
      model.save_changes();
    };
    addEventListener("message", hear);
    el.append(frame);
    return () => removeEventListener("message", hear);
  },
};
