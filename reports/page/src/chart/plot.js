// What all charts share: axes with units, whiskers, colours that follow dark mode, sizes that fit a telephone.
import * as Plot from "@observablehq/plot";
import { isInterval, isNumber, seconds, tick } from "../base/format.js";

export { Plot };

/** Values at which a logarithmic axis has its ticks: powers of ten, with 2 and 5 (then 3) where these are few. */
export function logTicks(low, high, most = 8) {
  if (!(low > 0) || !(high > low)) return [low];
  for (const steps of [[1, 1.5, 2, 3, 4, 5, 6, 7, 8, 9], [1, 2, 3, 5, 7], [1, 2, 5], [1, 3], [1]]) {
    const ticks = [];
    for (let e = Math.floor(Math.log10(low)); e <= Math.ceil(Math.log10(high)); e++)
      for (const step of steps) {
        const tick = Number((step * 10 ** e).toPrecision(3));
        if (tick >= low * 0.999 && tick <= high * 1.001) ticks.push(tick);
      }
    if (ticks.length <= most) return ticks;
    if (steps.length === 1) return ticks.filter((_, i) => i % Math.ceil(ticks.length / most) === 0);
  }
  return [];
}

/** A logarithmic axis that holds all values above 0, with a little room. */
export function logAxis(label, values, { format = (v) => tick(v), most = 7, room = 1.12 } = {}) {
  const positive = values.filter((v) => isNumber(v) && v > 0);
  if (!positive.length) return { label, type: "linear", domain: [0, 1] };
  const low = Math.min(...positive) / room;
  const high = Math.max(...positive) * room;
  return {
    label,
    type: "log",
    domain: [low, high],
    ticks: logTicks(low, high, most),
    tickFormat: format,
    labelArrow: "none",
  };
}

export function linearAxis(label, values, { zero = true, format = undefined, room = 0.05 } = {}) {
  const known = values.filter(isNumber);
  if (zero) known.push(0);
  if (!known.length) return { label, domain: [0, 1], labelArrow: "none" };
  const low = Math.min(...known);
  const high = Math.max(...known);
  const pad = (high - low || Math.abs(high) || 1) * room;
  return {
    label,
    domain: [low === 0 ? 0 : low - pad, high === 0 ? 0 : high + pad],
    tickFormat: format,
    labelArrow: "none",
  };
}

export const timeAxis = (label, values, options) =>
  logAxis(label, values, { format: (v) => seconds(v, tick), most: 5, ...options });

/** Ends of intervals for whiskers; on a logarithmic axis an end at or below 0 goes to the axis' beginning. */
export function ends(value, axis, scale = 1) {
  if (!isInterval(value)) return [undefined, undefined];
  const clip = (v) => Math.min(Math.max(v * scale, axis.domain[0]), axis.domain[1]);
  return [clip(value[0]), clip(value[1])];
}

/** Lines where the axis has its ticks. */
const grid = (mark, axis) =>
  axis?.type === "band"
    ? null
    : mark({ stroke: "var(--grid)", strokeOpacity: 1, ...(axis?.ticks === undefined ? {} : { ticks: axis.ticks }) });

/** D3 leaves out labels of a logarithmic axis as it sees fit: ours have all that we chose. */
const chosen = (axis) => axis?.type === "log" && Array.isArray(axis.ticks);
const quiet = (axis) => (chosen(axis) ? { ...axis, axis: null, ticks: undefined, tickFormat: undefined } : axis);
const labels = (mark, axis) =>
  chosen(axis) ? mark(axis.ticks, { text: axis.tickFormat, label: axis.label, labelArrow: "none" }) : null;

export function plot(width, options) {
  const narrow = width < 480;
  return Plot.plot({
    width,
    marginLeft: narrow ? 46 : 58,
    marginBottom: 42,
    marginTop: 26,
    marginRight: 16,
    color: { type: "identity" },
    symbol: { type: "identity" },
    style: {
      background: "transparent",
      color: "var(--ink)",
      fontFamily: "inherit",
      fontSize: "12px",
      overflow: "visible",
    },
    ...options,
    x: quiet(options.x),
    y: quiet(options.y),
    marks: [
      grid(Plot.gridX, options.x),
      grid(Plot.gridY, options.y),
      labels(Plot.axisX, options.x),
      labels(Plot.axisY, options.y),
      ...options.marks,
    ],
  });
}

/** A tip under the pointer that shows `title` of the nearest item. */
export function tip(data, options) {
  return Plot.tip(data, Plot.pointer({ fill: "var(--paper)", stroke: "var(--line)", textPadding: 6, ...options }));
}

/** Horizontal rows with whiskers: names at the left, values along x. items: {name, group, value, low, high, index}. */
export function rowHeight(count, each = 22) {
  return 70 + Math.max(1, count) * each;
}

/** The widest of names, in pixels, for a left margin: names take what they need up to 45 % of the width. */
export function nameMargin(names, width, most = 0.42) {
  const longest = Math.max(4, ...names.map((name) => String(name).length));
  return Math.min(Math.ceil(longest * 6.6) + 14, Math.floor(width * most));
}

export const shorten = (text, pixels) => {
  const letters = Math.max(4, Math.floor(pixels / 6.6));
  return text.length > letters ? `${text.slice(0, letters - 1)}…` : text;
};
