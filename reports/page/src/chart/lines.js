// Lines of several series with whiskers, and predictions dashed beside them.
import { isNumber } from "../base/format.js";
import { ends, plot, Plot, tip } from "./plot.js";
import { style } from "./symbols.js";

/**
 * points: [{series, index, x, y, interval, predicted?, title}] in units of the
 * axes times 1/scale; x, y: axes of plot.js.
 * `scale` multiplies y, interval and predicted (100: percent).
 */
export function lineChart(width, points, { x, y, scale = 1, height = 280, rule = null, extra = [] }) {
  const log = y.type === "log";
  const shown = points.filter((p) => isNumber(p.x) && isNumber(p.y) && (!log || p.y > 0));
  const whiskers = shown
    .map((p) => ({ ...p, range: ends(p.interval, y, scale) }))
    .filter((p) => p.range[0] !== undefined);
  const law = points.filter((p) => isNumber(p.x) && isNumber(p.predicted) && (!log || p.predicted > 0));
  const colour = (p) => style(p.index).colour;
  return plot(width, {
    height,
    x,
    y,
    marks: [
      rule === null ? null : Plot.ruleY([rule], { stroke: "var(--ink)", strokeOpacity: 0.6 }),
      Plot.line(law, {
        x: "x",
        y: (p) => p.predicted * scale,
        z: "series",
        stroke: colour,
        strokeDasharray: "3 3",
        strokeOpacity: 0.9,
        clip: true,
      }),
      Plot.line(shown, { x: "x", y: (p) => p.y * scale, z: "series", stroke: colour, strokeWidth: 1.6 }),
      Plot.ruleX(whiskers, {
        x: "x",
        y1: (p) => p.range[0],
        y2: (p) => p.range[1],
        stroke: colour,
        strokeWidth: 1.6,
      }),
      Plot.dot(shown, {
        x: "x",
        y: (p) => p.y * scale,
        fill: colour,
        symbol: (p) => style(p.index).symbol,
        r: 4.5,
        stroke: "var(--paper)",
        strokeWidth: 0.7,
      }),
      ...extra,
      tip(shown, { x: "x", y: (p) => p.y * scale, title: "title" }),
    ],
  });
}

/** Values of points that an axis has to hold. */
export function extent(points, scale = 1) {
  return points
    .flatMap((p) => [p.y, p.predicted, ...(Array.isArray(p.interval) ? p.interval : [])])
    .filter(isNumber)
    .map((v) => v * scale);
}
