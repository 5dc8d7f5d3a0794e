// Rows with names at the left, a mark and whiskers along x, and a tick where a prediction stands.
import { isNumber } from "../base/format.js";
import { ends, nameMargin, plot, Plot, rowHeight, shorten, tip } from "./plot.js";
import { style } from "./symbols.js";

/** items: [{name, index, value, interval, predicted?, asymptote?, title}]; x: an axis; rules: values with a line. */
export function rowChart(width, items, { x, scale = 1, rules = [], bars = false, each = 22 }) {
  const shown = items.filter((item) => isNumber(item.value));
  const whiskers = shown
    .map((item) => ({ ...item, range: ends(item.interval, x, scale) }))
    .filter((item) => item.range[0] !== undefined);
  const margin = nameMargin(
    items.map((item) => item.name),
    width,
  );
  const fits = x.type !== "log" ? shown : shown.filter((item) => item.value > 0);
  const colour = (item) => style(item.index).colour;
  const law = items.filter((item) => isNumber(item.predicted) && (x.type !== "log" || item.predicted > 0));
  const limits = items.filter((item) => isNumber(item.asymptote));
  const names = new Map(items.map((item) => [item.name, shorten(String(item.name), margin - 14)]));
  return plot(width, {
    height: rowHeight(items.length, each),
    marginLeft: margin,
    x,
    y: {
      type: "band",
      domain: [...names.keys()],
      label: null,
      tickFormat: (name) => names.get(name),
      tickSize: 0,
      padding: 0.25,
    },
    marks: [
      Plot.ruleX(rules, { stroke: "var(--ink)", strokeOpacity: 0.6 }),
      bars
        ? Plot.ruleY(fits, {
            y: "name",
            x1: x.domain[0],
            x2: (i) => i.value * scale,
            stroke: colour,
            strokeWidth: 6,
            strokeOpacity: 0.35,
          })
        : null,
      Plot.ruleY(whiskers, {
        y: "name",
        x1: (i) => i.range[0],
        x2: (i) => i.range[1],
        stroke: colour,
        strokeWidth: 2,
      }),
      Plot.tickX(law, { x: (i) => i.predicted * scale, y: "name", stroke: "var(--ink)", strokeWidth: 2 }),
      Plot.dot(limits, { x: (i) => i.asymptote * scale, y: "name", stroke: "var(--ink)", symbol: "diamond", r: 4 }),
      Plot.dot(fits, {
        x: (i) => i.value * scale,
        y: "name",
        fill: colour,
        symbol: (i) => style(i.index).symbol,
        r: 4.5,
        stroke: "var(--paper)",
        strokeWidth: 0.7,
      }),
      tip(fits, { x: (i) => i.value * scale, y: "name", title: "title" }),
    ],
  });
}
