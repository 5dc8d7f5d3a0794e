// Bias, noise and error of the estimators by k and by region, measured beside predicted.
import { h } from "../base/dom.js";
import { isNumber, percent, percentInterval, plural, signedPercent } from "../base/format.js";
import { distinct } from "../base/data.js";
import { least } from "../base/compare.js";
import { extent, lineChart } from "../chart/lines.js";
import { linearAxis, logAxis } from "../chart/plot.js";
import { rowChart } from "../chart/rows.js";
import { figure, missing } from "../figure.js";
import { caseKeys, isOracle, lookupOf } from "./accuracy_model.js";
import { caseFigure, predictionFigure } from "./accuracy_cases.js";

export const definitions = {
  rel_bias:
    "rel_bias = mean over probes of b / M, where b is the mean over trials of estimate − truth at a probe " +
    "and M the mean of |truth| over region `all`; bright and dark can cancel in it.",
  rms_bias:
    "rms_bias = √(mean of b² − mean of v/T, floored at 0) / M: bias that cannot cancel (v: variance over the " +
    "T trials).",
  rel_noise: "rel_noise = √(mean over probes of the variance over trials) / M.",
  rel_rmse: "rel_rmse = √(mean over probes and trials of (estimate − truth)²) / M: bias and noise together.",
};
export const overTrials =
  "95 % intervals over trials, each an independent photon map (jackknife; of the logarithm for noise and RMSE). " +
  "Rows of one region share their photons, so they miss together.";
const predictions =
  "Predictions are exact laws by quadrature over the same probes, for the fixed number of photons; nothing " +
  "is fitted to the " +
  "measurement, and where no law is known there is none.";

export const columnsOf = (names, keyOf) => [
  { key: "estimator", label: "Estimator", format: (v) => names.estimator.short(v) },
  { key: "case", label: "Case", format: (_, row) => keyOf(row) },
  { key: "region", label: "Region" },
  { key: "lookup_of", csv: "lookup", label: "Lookup", value: lookupOf },
  { key: "rel_bias", label: "Bias", format: signedPercent },
  { key: "rel_bias_ci95", csv: "rel_bias", label: "95 % interval", interval: true, format: percentInterval },
  { key: "predicted_rel_bias", label: "Predicted bias", format: signedPercent },
  { key: "rms_bias", label: "RMS bias", format: percent },
  { key: "rel_noise", label: "Noise", format: percent },
  { key: "rel_noise_ci95", csv: "rel_noise", label: "95 % interval", interval: true, format: percentInterval },
  { key: "predicted_rel_noise", label: "Predicted noise", format: percent },
  { key: "rel_rmse", label: "RMSE", format: percent },
  { key: "rel_rmse_ci95", csv: "rel_rmse", label: "95 % interval", interval: true, format: percentInterval },
  { key: "ns_per_query", label: "ns per query" },
  { key: "cost_s", label: "Cost, s" },
  { key: "trials", label: "Trials" },
  { key: "status", label: "Status" },
];

export function accuracySection(report, choices) {
  const rows = report.rows("accuracy");
  if (!rows.length)
    return [
      missing(
        "bias, noise and error of estimators: no rows of `accuracy`",
        "photonbench accuracy --profile full --json accuracy.json",
      ),
    ];
  const keyOf = caseKeys(rows, report.names.case);
  const odd = rows.filter((row) => row.status !== "ok" && row.status !== undefined);
  return [
    byK(choices, report.names, keyOf),
    byRegion(choices, report.names, keyOf),
    caseFigure(choices, report.names),
    predictionFigure(rows, report.names, keyOf),
    odd.length
      ? h(
          "p",
          {},
          `${plural(odd.length, "row")} of ${rows.length} have a status other than ok: ` +
            `${distinct(odd, "status").join(", ")}. They are in the tables with it.`,
        )
      : null,
  ];
}

const quantities = [
  { value: "rel_rmse", label: "RMSE" },
  { value: "rel_bias", label: "bias" },
  { value: "rel_noise", label: "noise" },
  { value: "rms_bias", label: "RMS bias" },
];
const predictionOf = (quantity, row) => {
  if (quantity === "rel_bias" || quantity === "rel_noise") return row[`predicted_${quantity}`];
  return null;
};

function pointsOf(rows, quantity, names) {
  return rows
    .filter((row) => row.kind !== "radius")
    .map((row) => ({
      series: row.estimator,
      index: names.estimator.index(row.estimator),
      x: row.k,
      y: row[quantity],
      interval: row[`${quantity}_ci95`],
      predicted: predictionOf(quantity, row),
      title:
        `${names.estimator.short(row.estimator)}, ${lookupOf(row)}\n` +
        `${quantity} ${percent(row[quantity])} ${percentInterval(row[`${quantity}_ci95`])}` +
        (isNumber(predictionOf(quantity, row)) ? `\npredicted ${percent(predictionOf(quantity, row))}` : ""),
    }))
    .sort((a, b) => a.x - b.x);
}

export function legendOf(rows, field, names) {
  return distinct(rows, field)
    .filter((name) => name !== null)
    .map((name) => ({ name, label: names.short(name), index: names.index(name) }));
}

function byK(choices, names, keyOf) {
  const all = choices.flatMap((choice) => choice.rows);
  const cases = [...new Set(all.map(keyOf))];
  const regions = distinct(all, "region");
  const rowsOf = (state) =>
    (choices.find((choice) => choice.value === state.setting)?.rows ?? []).filter(
      (row) => keyOf(row) === state.case && row.region === state.region,
    );
  const shown = (state) => rowsOf(state).filter((row) => !state.hidden.has(row.estimator));
  return figure({
    id: "by-k",
    title: "Bias, noise and RMSE by k",
    controls: [
      { key: "case", label: "Case", options: cases, value: cases[0] },
      { key: "region", label: "Region", options: regions, value: regions.includes("all") ? "all" : regions[0] },
      { key: "setting", label: "Photons", options: choices, value: choices[0].value },
    ],
    legend: (state) => legendOf(rowsOf(state), "estimator", names.estimator),
    draw: (width, state) => drawByK(width, shown(state), names),
    rows: rowsOf,
    columns: columnsOf(names, keyOf),
    summary: (state) => byKSummary(rowsOf(state), names, state),
    formula:
      `${definitions.rel_bias} ${definitions.rel_noise} ${definitions.rel_rmse} Dashed: predicted. ` +
      `${predictions}`,
    plusminus: overTrials,
  });
}

function drawByK(width, rows, names) {
  if (!rows.some((row) => isNumber(row.k))) return [];
  const each = width >= 860 ? Math.floor((width - 32) / 3) : width;
  const x = logAxis(
    "k, photons in an estimate →",
    rows.map((row) => row.k),
    { most: 8, format: String },
  );
  const ks = [...new Set(rows.map((row) => row.k).filter(isNumber))].sort((a, b) => a - b);
  if (ks.length < 9) x.ticks = ks;
  return [
    ["rel_bias", "bias, % of mean truth", "Bias"],
    ["rel_noise", "noise, % of mean truth", "Noise"],
    ["rel_rmse", "RMSE, % of mean truth", "RMSE"],
  ].map(([quantity, label, title]) => {
    const points = pointsOf(rows, quantity, names);
    const values = extent(points, 100);
    const bias = quantity === "rel_bias";
    const y = bias ? linearAxis(`↑ ${label}`, values) : logAxis(`↑ ${label}`, values);
    return { title, node: lineChart(each, points, { x, y, scale: 100, rule: bias ? 0 : null }) };
  });
}

function byKSummary(rows, names, state) {
  const best = least(
    rows.filter((row) => !isOracle(row)),
    (row) => row.rel_rmse,
  );
  if (!best) return `${state.case}, region ${state.region}: no rows.`;
  return (
    `${state.case}, region ${state.region}: the least RMSE is ${percent(best.rel_rmse)} ` +
    `${percentInterval(best.rel_rmse_ci95)}, by ` +
    `${names.estimator.short(best.estimator)} at ${lookupOf(best)}: bias ${signedPercent(best.rel_bias)}, ` +
    `noise ${percent(best.rel_noise)}.`
  );
}

function byRegion(choices, names, keyOf) {
  const all = choices.flatMap((choice) => choice.rows);
  const cases = [...new Set(all.map(keyOf))];
  const many =
    cases.find((name) => new Set(all.filter((row) => keyOf(row) === name).map((row) => row.region)).size > 2) ??
    cases[0];
  const lookups = [...new Set(all.map(lookupOf))];
  const rowsOf = (state) =>
    (choices.find((choice) => choice.value === state.setting)?.rows ?? []).filter(
      (row) => keyOf(row) === state.case && lookupOf(row) === state.lookup,
    );
  return figure({
    id: "by-region",
    title: "By region",
    controls: [
      { key: "case", label: "Case", options: cases, value: many },
      { key: "lookup", label: "Lookup", options: lookups, value: lookups.includes("k = 50") ? "k = 50" : lookups[0] },
      { key: "quantity", label: "Quantity", options: quantities, value: "rel_bias" },
      { key: "setting", label: "Photons", options: choices, value: choices[0].value },
    ],
    legend: (state) => legendOf(rowsOf(state), "estimator", names.estimator),
    draw: (width, state) =>
      drawRegions(
        width,
        rowsOf(state).filter((row) => !state.hidden.has(row.estimator)),
        state.quantity,
        names,
      ),
    rows: rowsOf,
    columns: columnsOf(names, keyOf),
    summary: (state) => regionSummary(rowsOf(state), names, state),
    formula:
      `${Object.values(definitions).join(" ")} Upright ticks: predicted. Regions are disjoint ` +
      `parts of a case; all are over the mean truth of region \`all\`.`,
    plusminus: `${overTrials} That of the RMS bias inverts a test, and is one-sided from 0 where 0 is not excluded.`,
  });
}

function drawRegions(width, rows, quantity, names) {
  const regions = distinct(rows, "region");
  const columns = width >= 900 ? Math.min(3, regions.length) : width >= 620 ? Math.min(2, regions.length) : 1;
  const each = Math.floor((width - 16 * (columns - 1)) / columns);
  const label = `${quantities.find((q) => q.value === quantity).label}, % of mean truth →`;
  return regions.map((region) => {
    const items = rows
      .filter((row) => row.region === region)
      .map((row) => ({
        name: names.estimator.short(row.estimator),
        index: names.estimator.index(row.estimator),
        value: row[quantity],
        interval: row[`${quantity}_ci95`],
        predicted: predictionOf(quantity, row),
        title:
          `${names.estimator.short(row.estimator)}: ${percent(row[quantity])} ` +
          `${percentInterval(row[`${quantity}_ci95`])}`,
      }));
    const values = items
      .flatMap((item) => [item.value, item.predicted, ...(item.interval ?? [])])
      .filter(isNumber)
      .map((v) => 100 * v);
    const x = linearAxis(label, values);
    return { title: `Region ${region}`, node: rowChart(each, items, { x, scale: 100, rules: [0] }) };
  });
}

function regionSummary(rows, names, state) {
  const known = rows.filter((row) => row.region !== "all" && isNumber(row[state.quantity]) && !isOracle(row));
  if (!known.length) return `${state.case}, ${state.lookup}: no regions but the whole.`;
  const size = (row) => Math.abs(row[state.quantity]);
  const worst = known.reduce((a, b) => (size(b) > size(a) ? b : a));
  const label = quantities.find((q) => q.value === state.quantity).label;
  return (
    `${state.case}, ${state.lookup}: the largest ${label} is ${percent(worst[state.quantity])} ` +
    `${percentInterval(worst[`${state.quantity}_ci95`])}, of ${names.estimator.short(worst.estimator)} in ` +
    `region ${worst.region}.`
  );
}
