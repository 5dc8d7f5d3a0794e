// The frame of every figure: controls, legend, chart, a sentence that says what it shows, formula, ±, table, CSV.
// Charts are drawn when they come near the screen, tables when they are opened, so that a large report opens at once.
import { append, h, rich, select, uniqueId } from "./base/dom.js";
import { symbolIcon } from "./chart/symbols.js";
import { copyButton, makeCsv, makeTable } from "./table.js";

const waiting = new Map();
const watcher =
  typeof IntersectionObserver === "undefined"
    ? null
    : new IntersectionObserver(
        (entries) => {
          for (const entry of entries) if (entry.isIntersecting) drawNow(entry.target);
        },
        { rootMargin: "600px" },
      );

function drawNow(element) {
  const draw = waiting.get(element);
  if (!draw) return;
  waiting.delete(element);
  watcher?.unobserve(element);
  draw();
}

export function drawAll() {
  for (const element of [...waiting.keys()]) drawNow(element);
}
if (typeof window !== "undefined") window.addEventListener("beforeprint", drawAll);

/**
 * spec: id, title, formula, plusminus, controls? [{key, label, options, value}], legend?(state) [{name, label, index}],
 * draw?(width, state) -> elements [{node, title?}], columns (or columns(state)), rows(state), summary(state), open?
 * state: the controls' values and `hidden`, the names that the legend has put out.
 */
export function figure(spec) {
  const state = { hidden: new Set() };
  for (const control of spec.controls ?? []) state[control.key] = control.value;
  const chart = h("div.charts");
  const summary = h("p.summary", { id: uniqueId("summary") });
  const legend = h("div.legend", { role: "group", "aria-label": "Shown in the chart" });
  const tablePlace = h("div");
  const details = h("details.values", { open: spec.open }, h("summary", {}, "Table of values"), tablePlace);
  const columns = () => (typeof spec.columns === "function" ? spec.columns(state) : spec.columns);
  const frame = h("figure", { id: spec.id, "data-figure": spec.id, "aria-labelledby": `${spec.id}-title` });
  let width = 0;

  const guarded = (job, place) => {
    try {
      job();
    } catch (error) {
      place.replaceChildren(h("p.missing", {}, `This figure cannot be drawn from these data: ${error.message}`));
    }
  };
  const drawChart = () =>
    guarded(() => {
      summary.replaceChildren(...rich(spec.summary(state)));
      if (!spec.draw) return;
      width = chart.clientWidth || 640;
      const parts = spec.draw(Math.max(240, width), state);
      chart.replaceChildren(...parts.map((part) => panel(part, summary.textContent)));
      if (!parts.length) chart.append(h("p.missing", {}, "No values to draw in this choice."));
      frame.dataset.drawn = "yes";
    }, chart);
  const drawTable = () =>
    guarded(() => {
      tablePlace.replaceChildren(makeTable(columns(), spec.rows(state), spec.title));
    }, tablePlace);
  const drawLegend = () => {
    const items = spec.legend ? spec.legend(state) : [];
    legend.hidden = items.length < 2;
    legend.replaceChildren(...items.map((item) => legendButton(item, state, drawChart)));
  };
  const update = () => {
    drawLegend();
    if (!waiting.has(chart)) drawChart();
    if (details.open) drawTable();
  };

  append(frame, [
    h(`${spec.heading ?? "h3"}.figure-title`, { id: `${spec.id}-title` }, rich(spec.title)),
    spec.controls?.length
      ? h(
          "div.controls",
          {},
          spec.controls
            .filter((control) => control.options.length > 1)
            .map((control) =>
              select(control.label, control.options, control.value, (value) => {
                state[control.key] = value;
                update();
              }),
            ),
        )
      : null,
    legend,
    spec.draw ? chart : null,
    h(
      "figcaption",
      {},
      summary,
      h("p.formula", {}, h("b", {}, "Shown: "), rich(spec.formula)),
      spec.plusminus ? h("p.plusminus", {}, h("b", {}, "±: "), rich(spec.plusminus)) : null,
    ),
    details,
    copyButton(() => makeCsv(columns(), spec.rows(state)), spec.title),
  ]);
  drawLegend();
  details.addEventListener("toggle", () => details.open && drawTable());
  if (spec.open) drawTable();
  later(chart, frame, drawChart, spec.draw);
  if (typeof ResizeObserver !== "undefined" && spec.draw) {
    new ResizeObserver(() => {
      if (!waiting.has(chart) && Math.abs(chart.clientWidth - width) > 4) drawChart();
    }).observe(chart);
  }
  return frame;
}

function later(chart, frame, draw, hasChart) {
  if (!hasChart || !watcher) {
    draw();
    return;
  }
  waiting.set(chart, draw);
  watcher.observe(chart);
}

function panel(part, summary) {
  const image = part.node.tagName === "svg" ? part.node : part.node.querySelector("svg");
  if (image) {
    image.setAttribute("role", "img");
    image.setAttribute("aria-label", part.title ? `${part.title}. ${summary}` : summary);
  }
  return h("div.panel", {}, part.title ? h("p.panel-title", {}, part.title) : null, part.node);
}

function legendButton(item, state, redraw) {
  const button = h(
    "button",
    { type: "button", "aria-pressed": String(!state.hidden.has(item.name)) },
    symbolIcon(item.index),
    item.label,
  );
  button.addEventListener("click", () => {
    const hide = !state.hidden.has(item.name);
    state.hidden[hide ? "add" : "delete"](item.name);
    button.setAttribute("aria-pressed", String(!hide));
    redraw();
  });
  return button;
}

/** Says what is not there, and the command that makes it. */
export function missing(what, how) {
  return h(
    "p.missing",
    { role: "note" },
    h("b", {}, "Missing: "),
    rich(what),
    how ? [". To make it: ", h("code", {}, how)] : "",
  );
}
