// The comparer's elements: every key has a button too, so that it works by touch.
import { h, select } from "../base/dom.js";
import { paintScale, scaleTicks } from "./colours.js";
import { keys } from "./keys.js";

export function buildPanel(comparer, keysId) {
  const panel = {
    canvas: h("canvas", { role: "img", "aria-label": "No picture yet" }),
    live: h("p.live", { role: "status", "aria-live": "polite" }),
    problems: h("p.problems", {}),
    views: h("div.views", { role: "group", "aria-label": "Views" }),
    readout: h("div.readout", {}),
    crops: h("div.crops", { hidden: true, role: "group", "aria-label": "Crops of all views at the same place" }),
    scale: h("canvas", { width: 256, height: 14, "aria-hidden": "true" }),
    ticks: h("div.ticks", {}),
    scaleTitle: h("p.scale-title", {}),
    keys: h(
      "div.keys",
      { id: keysId, hidden: true },
      h("h3", {}, "Keys, while the comparer has the focus"),
      h(
        "dl",
        {},
        keys.map((key) => [h("dt", {}, h("kbd", {}, key.show)), h("dd", {}, key.what)]),
      ),
    ),
  };
  panel.tools = tools(comparer);
  panel.wipeSlider = h("input", {
    type: "range",
    min: 0,
    max: 1,
    step: 0.01,
    "aria-label": "Place of the wipe's line",
    oninput: () => comparer.moveWipe(Number(panel.wipeSlider.value) - comparer.wipeAt),
  });
  const scenes = comparer.scenes.map((scene) => ({ value: scene, label: comparer.names.short(scene.scene) }));
  panel.root = h(
    "div.comparer",
    {
      id: "comparer",
      tabindex: 0,
      role: "application",
      "aria-roledescription": "image comparer",
      "aria-label": "Image comparer. Number keys show views, question mark shows all keys.",
      "aria-describedby": keysId,
    },
    h(
      "div.controls",
      {},
      select("Scene", scenes, scenes[0].value, (scene) => comparer.open(scene)),
    ),
    panel.views,
    h(
      "div.stage",
      {},
      h(
        "div.picture",
        {},
        panel.canvas,
        panel.wipeSlider,
        h("div.scale", {}, panel.scaleTitle, panel.scale, panel.ticks),
      ),
      h(
        "div.side",
        {},
        h("div.tools", { role: "group", "aria-label": "Tools" }, Object.values(panel.tools)),
        panel.live,
        panel.readout,
        panel.problems,
      ),
    ),
    panel.crops,
    panel.keys,
  );
  return panel;
}

function tools(comparer) {
  const tool = (name, key, action, ...rest) =>
    h(
      "button",
      {
        type: "button",
        "data-tool": name,
        onclick: () => comparer.current && comparer[action](...rest),
        "aria-keyshortcuts": key,
      },
      name,
      " ",
      h("kbd", { "aria-hidden": "true" }, key),
    );
  return {
    wipe: tool("Wipe", "w", "toggleWipe"),
    swap: tool("Swap", "x", "swap"),
    error: tool("Signed error", "d", "toggleError"),
    falseColour: tool("False colour", "f", "toggleFalse"),
    crops: tool("Crops", "c", "toggleCrops"),
    brighter: tool("Brighter", "e", "expose", 0.5),
    darker: tool("Darker", "E", "expose", -0.5),
    larger: tool("Zoom in", "+", "zoomBy", 2),
    smaller: tool("Zoom out", "-", "zoomBy", 0.5),
    reset: tool("Reset", "r", "reset"),
    keys: tool("Keys", "?", "toggleKeys"),
  };
}

export function showTools(comparer) {
  const { tools: buttons, wipeSlider } = comparer.panel;
  const pressed = {
    wipe: comparer.wipe,
    falseColour: comparer.settings.falseColour,
    crops: comparer.crops,
    error: comparer.current?.kind === "error",
  };
  for (const [name, on] of Object.entries(pressed)) buttons[name].setAttribute("aria-pressed", String(on));
  wipeSlider.hidden = !comparer.wipe;
  wipeSlider.value = String(comparer.wipeAt);
}

export function showViews(comparer) {
  const { views, current, other, wipe } = comparer;
  comparer.panel.views.replaceChildren(
    ...views.map((view, i) => {
      const at = view === current ? (wipe ? " (left)" : "") : wipe && view === other ? " (right)" : "";
      return h(
        "button",
        {
          type: "button",
          "aria-pressed": String(view === current),
          "data-kind": view.kind,
          onclick: () => comparer.turnTo(view),
        },
        i < 9 ? h("kbd", { "aria-hidden": "true" }, String(i + 1)) : null,
        ` ${view.label}${at}`,
      );
    }),
  );
}

export function showScale(panel, scale) {
  const ticks = scaleTicks(scale);
  const what = {
    screen: "Radiance on the screen",
    log: "Luminance, logarithmic",
    linear: "Value",
    signed: "Signed error: blue too dark, red too bright",
  }[scale.kind];
  panel.scaleTitle.textContent = `${what}${scale.unit ? `, ${scale.unit}` : ""}`;
  paintScale(panel.scale, scale);
  panel.ticks.replaceChildren(...ticks.map((tick) => h("span", { style: `left:${100 * tick.at}%` }, tick.text)));
}

export function showKeys(panel) {
  panel.keys.hidden = !panel.keys.hidden;
  return !panel.keys.hidden;
}
