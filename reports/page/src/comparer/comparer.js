// The image comparer: what it holds and what its keys, buttons and the pointer do to it.
import { h, uniqueId } from "../base/dom.js";
import { percent, significant } from "../base/format.js";
import { missing } from "../figure.js";
import { paint, scaleOf } from "./colours.js";
import { cropStrip } from "./crops.js";
import { errorFigure } from "./errors.js";
import { actionOf } from "./keys.js";
import { buildPanel, showKeys, showScale, showTools, showViews } from "./panel.js";
import { readings, readoutTable, spoken } from "./readout.js";
import { scenesOf, viewsOf } from "./scenes.js";
import { Stage } from "./stage.js";

export function comparerSection(report) {
  const scenes = scenesOf(report.images);
  const how =
    "photonbench render cornell --size 128x128 --estimator disc,cone,hull --aov --half -o cornell.exr && " +
    "photonbench report … cornell*.exr -o report";
  if (!scenes.length) return [missing("images: none were given to the report", how)];
  return [new Comparer(scenes, report.names.scene).element, errorFigure(scenes, report.names.scene)];
}

class Comparer {
  constructor(scenes, names) {
    this.scenes = scenes;
    this.names = names;
    this.views = [];
    this.problems = [];
    this.current = null; // the view that is shown; left of the wipe
    this.other = null; // right of the wipe
    this.cursor = null;
    this.settings = { exposure: 0, falseColour: false, white: 1, signed: 1 };
    this.wipe = false;
    this.wipeAt = 0.5;
    this.crops = false;
    this.bitmaps = new Map();
    this.panel = buildPanel(this, uniqueId("keys"));
    this.element = this.panel.root;
    this.stage = new Stage(this.panel.canvas);
    this.listen();
    this.openWhenNear();
  }

  /** Decodes nothing before the comparer comes near the screen. */
  openWhenNear() {
    const open = () => this.open(this.scenes[0]);
    if (typeof IntersectionObserver === "undefined") return open();
    const watcher = new IntersectionObserver(
      (entries) => {
        if (!entries.some((entry) => entry.isIntersecting)) return;
        watcher.disconnect();
        open();
      },
      { rootMargin: "400px" },
    );
    return watcher.observe(this.element);
  }

  async open(scene) {
    this.scene = scene;
    this.say(`Loading ${this.names.short(scene.scene)}`);
    const found = await viewsOf(scene);
    if (this.scene !== scene) return; // another was chosen meanwhile
    Object.assign(this, { views: found.views, problems: found.problems, cursor: null });
    Object.assign(this.settings, { white: found.white, signed: found.signed, exposure: 0 });
    this.bitmaps.clear();
    this.current = this.views[0] ?? null;
    this.other = found.truth ?? this.views[1] ?? this.current;
    if (this.current) this.stage.fit(this.current.pixels.width, this.current.pixels.height);
    this.element.dataset.ready = "yes";
    this.refresh(true);
  }

  // What keys and buttons do.

  show(index) {
    if (this.views[index]) this.turnTo(this.views[index]);
  }
  showTruth() {
    this.turnTo(this.views.find((view) => view.kind === "truth"));
  }
  step(by) {
    const at = this.views.indexOf(this.current);
    this.turnTo(this.views[(at + by + this.views.length) % this.views.length]);
  }
  toggleError() {
    const to =
      this.current?.kind === "error"
        ? this.current.of
        : this.views.find((view) => view.kind === "error" && view.of === this.current);
    if (to) this.turnTo(to);
    else this.say("There is no signed error of this view");
  }
  turnTo(view) {
    if (!view || view === this.current) return this.say(view ? `${view.label} is shown` : "There is no such view");
    if (!this.wipe) this.other = this.current;
    this.current = view;
    return this.refresh(true);
  }
  toggleWipe() {
    this.wipe = !this.wipe;
    if (this.other === this.current) this.other = this.views.find((view) => view !== this.current) ?? this.current;
    this.refresh(true);
  }
  moveWipe(by) {
    this.wipeAt = Math.max(0, Math.min(1, this.wipeAt + by));
    this.refresh(false);
  }
  swap() {
    [this.current, this.other] = [this.other, this.current];
    this.refresh(true);
  }
  zoomBy(factor) {
    this.stage.zoomBy(factor, this.cursor && { x: this.cursor.x + 0.5, y: this.cursor.y + 0.5 });
    this.say(`Zoom ${significant(this.stage.zoom)} times`);
    this.refresh(false);
  }
  pan([dx, dy]) {
    const step = this.stage.size.width / this.stage.zoom / 8;
    if (this.stage.zoom === 1) this.say("The whole picture is shown; zoom in to pan");
    this.stage.pan(dx * step, dy * step);
    this.refresh(false);
  }
  moveCursor([dx, dy]) {
    const { width, height } = this.stage.size;
    const from = this.cursor ?? { x: Math.floor(this.stage.x), y: Math.floor(this.stage.y) };
    this.cursor = {
      x: Math.max(0, Math.min(width - 1, from.x + dx)),
      y: Math.max(0, Math.min(height - 1, from.y + dy)),
    };
    this.follow();
    this.refresh(false);
    this.say(spoken(readings(this.views, this.current, this.cursor), this.cursor));
  }
  /** The part that is shown goes with the cursor. */
  follow() {
    const half = { x: this.stage.size.width / this.stage.zoom / 2, y: this.stage.size.height / this.stage.zoom / 2 };
    const beyond = (at, middle, reach) =>
      at < middle - reach ? at - middle + reach : at > middle + reach ? at - middle - reach : 0;
    this.stage.pan(
      beyond(this.cursor.x + 0.5, this.stage.x, half.x * 0.9),
      beyond(this.cursor.y + 0.5, this.stage.y, half.y * 0.9),
    );
  }
  expose(by) {
    this.settings.exposure = Math.max(-12, Math.min(12, this.settings.exposure + by));
    this.bitmaps.clear();
    this.refresh(false);
    this.say(`Exposure ${this.settings.exposure > 0 ? "+" : ""}${this.settings.exposure} stops`);
  }
  toggleFalse() {
    this.settings.falseColour = !this.settings.falseColour;
    this.bitmaps.clear();
    this.refresh(false);
    this.say(this.settings.falseColour ? "False colour of luminance, logarithmic" : "Colours as they are");
  }
  toggleCrops() {
    this.crops = !this.crops;
    this.refresh(false);
    this.say(this.crops ? "Crops of all views are shown below" : "Crops are hidden");
  }
  toggleKeys() {
    this.say(showKeys(this.panel) ? "The keys are shown below" : "The keys are hidden");
  }
  reset() {
    this.stage.reset();
    Object.assign(this, { wipe: false, wipeAt: 0.5, cursor: null });
    Object.assign(this.settings, { exposure: 0, falseColour: false });
    this.bitmaps.clear();
    this.refresh(true);
  }

  // The screen.

  bitmapOf(view) {
    if (!this.bitmaps.has(view)) {
      const canvas = h("canvas", { width: view.pixels.width, height: view.pixels.height });
      canvas.getContext("2d").putImageData(paint(view, this.settings), 0, 0);
      this.bitmaps.set(view, canvas);
    }
    return this.bitmaps.get(view);
  }

  refresh(announce) {
    const { panel, current } = this;
    showViews(this);
    showTools(this);
    panel.problems.textContent = this.problems.length ? `Missing here: ${this.problems.join("; ")}.` : "";
    if (!current) return this.say("There is nothing to show of this scene");
    const same =
      this.other &&
      this.other.pixels.width === current.pixels.width &&
      this.other.pixels.height === current.pixels.height;
    const split = this.wipe && same;
    const layers = split
      ? [
          { bitmap: this.bitmapOf(current), from: 0, to: this.wipeAt },
          { bitmap: this.bitmapOf(this.other), from: this.wipeAt, to: 1 },
        ]
      : [{ bitmap: this.bitmapOf(current), from: 0, to: 1 }];
    this.stage.draw(layers, this.cursor, split ? this.wipeAt : null);
    panel.canvas.setAttribute("aria-label", this.describe(split));
    showScale(panel, scaleOf(current, this.settings));
    panel.readout.replaceChildren(...readoutTable(readings(this.views, current, this.cursor), this.cursor));
    panel.crops.hidden = !this.crops;
    panel.crops.replaceChildren(
      ...(this.crops ? cropStrip(this.views, this.cursor, (view) => this.bitmapOf(view)) : []),
    );
    this.mirror(split);
    if (announce) this.say(this.describe(split));
    return undefined;
  }

  describe(split) {
    const { current } = this;
    const error = current.kind === "error" ? current.pixels : current.error;
    const numbers =
      error && Number.isFinite(error.rms)
        ? `; RMS error ${percent(error.rms)}, mean ${percent(error.mean)} of the mean truth`
        : "";
    const right = split ? `; to the right of the line ${this.other.label}` : "";
    return `${this.names.short(this.scene.scene)}: ${current.label}${numbers}${right}`;
  }

  /** What is shown, for whoever wants to read it from outside: styles and tests. */
  mirror(split) {
    Object.assign(this.element.dataset, {
      scene: this.scene.scene ?? "",
      view: this.current.label,
      kind: this.current.kind,
      other: split ? this.other.label : "",
      wipe: String(split),
      wipeAt: this.wipeAt.toFixed(3),
      zoom: String(this.stage.zoom),
      x: this.stage.x.toFixed(2),
      y: this.stage.y.toFixed(2),
      exposure: String(this.settings.exposure),
      falseColour: String(this.settings.falseColour),
      crops: String(this.crops),
      cursor: this.cursor ? `${this.cursor.x},${this.cursor.y}` : "",
    });
  }

  say(text) {
    this.panel.live.textContent = text;
  }

  // Keys and pointer.

  listen() {
    const { root, canvas } = this.panel;
    root.addEventListener("keydown", (event) => {
      if (event.target.matches("select, input, textarea")) return;
      const action = actionOf(event);
      if (!action || !this.current) return;
      event.preventDefault();
      this[action[0]](action[1]);
    });
    canvas.addEventListener(
      "wheel",
      (event) => {
        // The page scrolls until the comparer is entered.
        if (!event.ctrlKey && !root.contains(document.activeElement)) return;
        event.preventDefault();
        this.stage.zoomBy(event.deltaY < 0 ? 1.25 : 0.8, this.stage.toImage(event.clientX, event.clientY));
        this.refresh(false);
      },
      { passive: false },
    );
    this.listenPointer(canvas);
    if (typeof ResizeObserver !== "undefined")
      new ResizeObserver(() => this.current && this.refresh(false)).observe(canvas);
  }

  listenPointer(canvas) {
    let drag = null;
    const place = (event) => {
      const { x, y } = this.stage.toImage(event.clientX, event.clientY);
      const { width, height } = this.stage.size;
      this.cursor = {
        x: Math.max(0, Math.min(width - 1, Math.floor(x))),
        y: Math.max(0, Math.min(height - 1, Math.floor(y))),
      };
    };
    const share = (event) => {
      const box = canvas.getBoundingClientRect();
      return (event.clientX - box.left) / box.width;
    };
    canvas.addEventListener("pointerdown", (event) => {
      this.panel.root.focus({ preventScroll: true });
      drag = { x: event.clientX, y: event.clientY, line: this.wipe && Math.abs(share(event) - this.wipeAt) < 0.05 };
      canvas.setPointerCapture(event.pointerId);
    });
    canvas.addEventListener("pointermove", (event) => {
      if (!this.current) return;
      place(event);
      if (drag?.line) this.wipeAt = Math.max(0, Math.min(1, share(event)));
      else if (drag) {
        const density = canvas.width / canvas.getBoundingClientRect().width / this.stage.scale;
        this.stage.pan((drag.x - event.clientX) * density, (drag.y - event.clientY) * density);
        Object.assign(drag, { x: event.clientX, y: event.clientY });
      }
      this.refresh(false);
    });
    for (const type of ["pointerup", "pointercancel"]) canvas.addEventListener(type, () => (drag = null));
  }
}
