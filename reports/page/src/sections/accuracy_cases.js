// All cases at a glance, and how well predictions hold.
import {
  isInterval,
  isNumber,
  list,
  percent,
  percentInterval,
  plural,
  significant,
  signedPercent,
} from "../base/format.js";
import { groupBy } from "../base/data.js";
import { outside } from "../base/compare.js";
import { linearAxis, logAxis, nameMargin, plot, Plot, shorten, tip } from "../chart/plot.js";
import { style } from "../chart/symbols.js";
import { figure } from "../figure.js";
import { frontModel, lookupOf, overall, ranking } from "./accuracy_model.js";

export function caseFigure(choices, names) {
  const models = new Map(choices.map((choice) => [choice.value, frontModel(choice.rows, names)]));
  const rowsOf = (state) =>
    [...models.get(state.setting).views]
      .filter(([name]) => name !== overall)
      .flatMap(([name, entries]) => ranking(entries).map((entry) => ({ ...entry, case: name })));
  return figure({
    id: "by-case",
    title: "Least error of each estimator, by case",
    controls: [{ key: "setting", label: "Photons", options: choices, value: choices[0].value }],
    draw: (width, state) => drawCases(width, rowsOf(state), names),
    rows: rowsOf,
    columns: [
      { key: "case", label: "Case" },
      { key: "estimator", label: "Estimator", format: (v) => names.estimator.short(v) },
      { key: "lookup", label: "Lookup" },
      { key: "rmse", csv: "rel_rmse", label: "RMSE", format: percent },
      { key: "interval", csv: "rel_rmse", label: "95 % interval", interval: true, format: percentInterval },
      { key: "ratio", label: "Over the least" },
      { key: "verdict", label: "Verdict" },
    ],
    summary: (state) => caseSummary(rowsOf(state), names),
    formula:
      "in each cell the least rel_rmse over all k, in percent of the mean truth, and the k at which it is. " +
      "Bold with a frame: the least " +
      "of its case; framed: ties with it (intervals overlap). The darker, the larger the error over the " +
      "least of its row. The oracle " +
      "knows the truth and cannot be run: it takes no part.",
    plusminus: "95 % intervals over trials, in the table.",
  });
}

function drawCases(width, entries, names) {
  if (!entries.length) return [];
  const cases = [...new Set(entries.map((entry) => entry.case))];
  const estimators = [...new Set(entries.map((entry) => entry.estimator))].sort(
    (a, b) => names.estimator.index(a) - names.estimator.index(b),
  );
  const margin = nameMargin(cases, width, 0.3);
  const wide = Math.max(width, margin + estimators.length * 62 + 20);
  const short = new Map(estimators.map((name) => [name, shorten(names.estimator.short(name), 90)]));
  const shade = (entry) => Math.min(0.5, entry.ratio ? 0.16 * Math.log2(Math.max(1, entry.ratio)) : 0);
  const node = plot(wide, {
    height: 96 + cases.length * 34,
    marginLeft: margin,
    marginTop: 84,
    marginBottom: 8,
    x: {
      type: "band",
      domain: estimators,
      axis: "top",
      label: null,
      tickFormat: (name) => short.get(name),
      tickRotate: -38,
      tickSize: 0,
      padding: 0.06,
    },
    y: {
      type: "band",
      domain: cases,
      label: null,
      tickSize: 0,
      tickFormat: (name) => shorten(name, margin - 12),
      padding: 0.08,
    },
    marks: [
      Plot.cell(entries, {
        x: "estimator",
        y: "case",
        fill: "var(--ink)",
        fillOpacity: (entry) => shade(entry),
        inset: 0,
      }),
      Plot.cell(
        entries.filter((entry) => entry.leader || entry.tie),
        {
          x: "estimator",
          y: "case",
          fill: "none",
          stroke: "var(--accent)",
          strokeWidth: (entry) => (entry.leader ? 2.5 : 1),
          inset: 1,
        },
      ),
      Plot.text(entries, {
        x: "estimator",
        y: "case",
        text: (entry) => significant(entry.rmse * 100),
        dy: -5,
        fontWeight: (entry) => (entry.leader ? 700 : 400),
        fontSize: 12,
        fill: "var(--ink)",
      }),
      Plot.text(entries, { x: "estimator", y: "case", text: "lookup", dy: 8, fontSize: 9.5, fill: "var(--ink)" }),
    ],
  });
  const holder = document.createElement("div");
  holder.className = "scroll";
  holder.tabIndex = 0;
  holder.setAttribute("role", "region");
  holder.setAttribute("aria-label", "Least error by case and estimator, percent");
  holder.append(node);
  return [{ node: holder }];
}

function caseSummary(entries, names) {
  const wins = groupBy(
    entries.filter((entry) => entry.leader),
    (entry) => entry.estimator,
  );
  const cases = new Set(entries.map((entry) => entry.case)).size;
  if (!cases) return "No cases can be compared.";
  const parts = [...wins]
    .sort((a, b) => b[1].length - a[1].length)
    .map(([estimator, members]) => {
      const tied = members.filter((win) => entries.some((entry) => entry.case === win.case && entry.tie)).length;
      return `${names.estimator.short(estimator)} in ${members.length}${tied ? ` (${tied} of them with ties)` : ""}`;
    });
  return `Of ${plural(cases, "case")} the least error is that of ${list(parts)}.`;
}

/** Each prediction as its distance from the measurement, in half-widths of the interval: within ±1 it holds. */
function deviations(rows) {
  const found = [];
  for (const row of rows)
    for (const quantity of ["rel_bias", "rel_noise"]) {
      const [measured, predicted, interval] = [row[quantity], row[`predicted_${quantity}`], row[`${quantity}_ci95`]];
      if (!isNumber(measured) || !isNumber(predicted) || !isInterval(interval) || !(interval[1] > interval[0]))
        continue;
      const half = measured > predicted ? measured - interval[0] : interval[1] - measured;
      found.push({
        row,
        quantity,
        measured,
        predicted,
        interval,
        off: half > 0 ? (measured - predicted) / half : null,
        missed: outside(predicted, interval),
      });
    }
  return found.filter((one) => isNumber(one.off));
}

export function missedPredictions(rows) {
  const all = deviations(rows);
  return {
    all: all.length,
    missed: all.filter((one) => one.missed).sort((a, b) => Math.abs(b.off) - Math.abs(a.off)),
  };
}

export function predictionFigure(rows, names, keyOf) {
  const all = deviations(rows);
  const visible = (state) => all.filter((one) => one.quantity === state.quantity);
  return figure({
    id: "predicted",
    title: "Measured beside predicted",
    controls: [
      {
        key: "quantity",
        label: "Quantity",
        options: [
          { value: "rel_bias", label: "bias" },
          { value: "rel_noise", label: "noise" },
        ],
        value: "rel_bias",
      },
    ],
    draw: (width, state) => drawPredictions(width, visible(state), names, keyOf),
    rows: visible,
    columns: [
      {
        key: "estimator",
        label: "Estimator",
        value: (one) => one.row.estimator,
        format: (v) => names.estimator.short(v),
      },
      { key: "case", label: "Case", value: (one) => one.row.case, format: (_, one) => keyOf(one.row) },
      { key: "region", label: "Region", value: (one) => one.row.region },
      { key: "lookup", label: "Lookup", value: (one) => lookupOf(one.row) },
      { key: "measured", label: "Measured", format: signedPercent },
      { key: "interval", csv: "measured", label: "95 % interval", interval: true, format: percentInterval },
      { key: "predicted", label: "Predicted", format: signedPercent },
      { key: "off", label: "Off, half-widths" },
      { key: "missed", label: "Missed" },
    ],
    summary: (state) => {
      const shown = visible(state);
      const held = shown.filter((one) => !one.missed).length;
      return shown.length
        ? `${held} of ${shown.length} predictions of ${state.quantity === "rel_bias" ? "bias" : "noise"} lie ` +
            `within the 95 % interval of the ` +
            `measurement (${percent(held / shown.length)}; 95 % are expected where both are right).`
        : "No row has a prediction.";
    },
    formula:
      "(measured − predicted) / half-width of the measurement's 95 % interval, one mark a row; within −1 and " +
      "1 the prediction lies in the interval. " +
      "Predictions are exact laws by quadrature; beyond them, in estimators and regions without a law, there " +
      "are none.",
    plusminus:
      "the interval over trials is the unit of the axis. Rows of one region share their photons, so they " +
      "miss together; below k = 10 intervals are too short (heavy tails).",
  });
}

function drawPredictions(width, shown, names, keyOf) {
  if (!shown.length) return [];
  const points = shown.map((one) => ({ ...one, x: one.row.k ?? 1 }));
  const limit = Math.min(8, Math.max(2, ...points.map((one) => Math.abs(one.off))));
  const place = (one, i) => one.x * (1 + 0.1 * (((i * 0.618) % 1) - 0.5));
  const x = logAxis(
    "k, photons in an estimate →",
    points.map((one) => one.x),
    { format: String, most: 9 },
  );
  const ks = [...new Set(points.map((one) => one.x))].sort((a, b) => a - b);
  if (ks.length < 10) x.ticks = ks;
  const y = linearAxis("↑ off, in half-widths of the interval", [-limit, limit]);
  const title = (one) =>
    `${names.estimator.short(one.row.estimator)}, ${keyOf(one.row)}, region ${one.row.region}, ` +
    `${lookupOf(one.row)}\nmeasured ` +
    `${signedPercent(one.measured)} ${percentInterval(one.interval)}\npredicted ${signedPercent(one.predicted)}`;
  const clipped = points.map((one, i) => ({
    ...one,
    px: place(one, i),
    py: Math.max(-limit, Math.min(limit, one.off)),
  }));
  return [
    {
      node: plot(width, {
        height: 300,
        x,
        y,
        marks: [
          Plot.rectY([{}], {
            x1: x.domain[0],
            x2: x.domain[1],
            y1: -1,
            y2: 1,
            fill: "var(--accent)",
            fillOpacity: 0.1,
          }),
          Plot.ruleY([-1, 1], { stroke: "var(--accent)", strokeOpacity: 0.7 }),
          Plot.ruleY([0], { stroke: "var(--ink)", strokeOpacity: 0.5 }),
          Plot.dot(clipped, {
            x: "px",
            y: "py",
            fill: (one) => style(names.estimator.index(one.row.estimator)).colour,
            symbol: (one) => style(names.estimator.index(one.row.estimator)).symbol,
            r: 3,
            fillOpacity: 0.85,
          }),
          tip(clipped, { x: "px", y: "py", title }),
        ],
      }),
    },
  ];
}
