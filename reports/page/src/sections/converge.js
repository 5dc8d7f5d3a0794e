// How fast progressive methods converge: error by pass beside its law, and the fitted slopes.
import {
  group,
  interval,
  isInterval,
  isNumber,
  percent,
  percentInterval,
  seconds,
  significant,
  shortList,
  tick,
} from "../base/format.js";
import { distinct, groupBy } from "../base/data.js";
import { least, outside } from "../base/compare.js";
import { Names } from "../base/names.js";
import { extent, lineChart } from "../chart/lines.js";
import { linearAxis, logAxis, timeAxis } from "../chart/plot.js";
import { rowChart } from "../chart/rows.js";
import { figure, missing } from "../figure.js";

const quantities = [
  { value: "rel_rmse", label: "RMSE" },
  { value: "rel_noise", label: "noise" },
  { value: "rel_bias", label: "size of the bias" },
];
const axes = [
  { value: "pass", label: "passes" },
  { value: "photons", label: "photons emitted" },
  { value: "seconds", label: "time of a run" },
];

/** A series by method, and by alpha and estimator where these differ within the report. */
export function seriesNamer(rows, names) {
  const alphas = distinct(rows, "alpha").filter(isNumber).length > 1;
  const estimators = new Names(rows.map((row) => row.estimator));
  const seriesOf = (row) => [row.scene, row.method, row.alpha, row.estimator].join("|");
  const files = new Map([...groupBy(rows, seriesOf)].map(([name, all]) => [name, distinct(all, "file_name").length]));
  return (row) =>
    names.method.short(row.method) +
    (alphas && isNumber(row.alpha) ? ` α=${row.alpha}` : "") +
    (estimators.full.length > 1 && row.estimator ? ` ${estimators.short(row.estimator)}` : "") +
    (files.get(seriesOf(row)) > 1 ? ` (${row.file_name})` : "");
}

export function convergeSection(report) {
  const rows = report.rows("converge");
  const how = "photonbench converge plate --method all --profile full --json converge.json";
  if (!rows.length) return [missing("convergence of progressive methods: no rows of `converge`", how)];
  const namer = seriesNamer(rows, report.names);
  const order = [...new Set(rows.map(namer))];
  const index = (row) => order.indexOf(namer(row));
  const fits = report.rows("converge", "fits");
  return [
    errorFigure(rows, report.names, namer, index),
    fits.length
      ? slopeFigure(fits, report.names, namer, index)
      : missing("fitted slopes: no `fits` in the file", how),
  ];
}

const predictedOf = (quantity, row) => {
  if (quantity === "rel_bias") return isNumber(row.predicted_rel_bias) ? Math.abs(row.predicted_rel_bias) : null;
  if (quantity === "rel_noise") return row.predicted_rel_noise;
  return isNumber(row.predicted_rms_bias) && isNumber(row.predicted_rel_noise)
    ? Math.hypot(row.predicted_rms_bias, row.predicted_rel_noise)
    : null;
};

function measured(quantity, row) {
  const ci = row[`${quantity}_ci95`];
  if (quantity !== "rel_bias") return { y: row[quantity], interval: ci };
  const size = Math.abs(row.rel_bias);
  if (!isInterval(ci)) return { y: size, interval: null };
  return {
    y: size,
    interval:
      ci[0] <= 0 && ci[1] >= 0
        ? [0, Math.max(-ci[0], ci[1])]
        : [Math.min(...ci.map(Math.abs)), Math.max(...ci.map(Math.abs))],
  };
}

function errorFigure(rows, names, namer, index) {
  const scenes = distinct(rows, "scene").map((value) => ({ value, label: names.scene.short(value) }));
  const of = (state) => rows.filter((row) => row.scene === state.scene);
  return figure({
    id: "converge",
    title: "Error of progressive methods",
    controls: [
      { key: "scene", label: "Scene", options: scenes, value: scenes[0].value },
      { key: "quantity", label: "Quantity", options: quantities, value: "rel_rmse" },
      { key: "axis", label: "Against", options: axes, value: "pass" },
    ],
    legend: (state) =>
      [...groupBy(of(state), namer)].map(([name, members]) => ({ name, label: name, index: index(members[0]) })),
    draw: (width, state) =>
      drawErrors(
        width,
        of(state).filter((row) => !state.hidden.has(namer(row))),
        state,
        namer,
        index,
      ),
    rows: of,
    columns: [
      { key: "series", label: "Series", value: namer },
      { key: "method", label: "Method" },
      { key: "alpha", label: "α" },
      { key: "estimator", label: "Estimator", format: (v) => names.estimator.short(v) },
      { key: "pass", label: "Pass", format: group },
      { key: "photons", label: "Photons", format: group },
      { key: "seconds", label: "Time", format: seconds },
      { key: "rel_bias", label: "Bias", format: percent },
      { key: "rel_bias_ci95", csv: "rel_bias", label: "95 % interval", interval: true, format: percentInterval },
      { key: "predicted_rel_bias", label: "Predicted", format: percent },
      { key: "rel_noise", label: "Noise", format: percent },
      { key: "predicted_rel_noise", label: "Predicted", format: percent },
      { key: "rel_rmse", label: "RMSE", format: percent },
      { key: "rel_rmse_ci95", csv: "rel_rmse", label: "95 % interval", interval: true, format: percentInterval },
      { key: "trials", label: "Trials" },
      { key: "truth", label: "Truth" },
      { key: "status", label: "Status" },
      { key: "detail", label: "Why" },
    ],
    summary: (state) => errorSummary(of(state), state, names, namer),
    formula:
      "with e = answer − truth at each point in each band and b its mean over trials: rel_bias = mean of b, " +
      "rel_noise = √(mean variance over trials), rel_rmse = √(mean of e²), each " +
      "over the mean truth. Dashed: the expectation of the method by the law of its lookups, from the first " +
      "radii as found (RMSE: √(rms_bias² + noise²)).",
    plusminus: "95 % intervals over trials, each an independent run; readings of one run hang together.",
  });
}

function drawErrors(width, rows, state, namer, index) {
  const points = rows
    .map((row) => ({
      series: namer(row),
      index: index(row),
      x: row[state.axis],
      predicted: predictedOf(state.quantity, row),
      ...measured(state.quantity, row),
      title:
        `${namer(row)}, pass ${group(row.pass)}\n` +
        `${percent(row[state.quantity])} ${percentInterval(row[`${state.quantity}_ci95`])}\n` +
        `${group(row.photons)} photons, ${seconds(row.seconds)}`,
    }))
    .filter((point) => isNumber(point.x) && point.x > 0 && point.y > 0)
    .sort((a, b) => a.x - b.x);
  if (!points.length) return [];
  const xs = points.map((point) => point.x);
  const x =
    state.axis === "seconds"
      ? timeAxis("time of one run →", xs, { most: 6 })
      : logAxis(state.axis === "pass" ? "passes →" : "photons emitted →", xs, {
          most: 7,
          format: (v) => (v < 1e5 ? group(v) : tick(v, 1)),
        });
  const label = quantities.find((q) => q.value === state.quantity).label;
  return [
    {
      node: lineChart(width, points, {
        x,
        y: logAxis(
          `↑ ${label}, % of mean truth`,
          extent(points, 100).filter((v) => v > 1e-3),
        ),
        scale: 100,
        height: 380,
      }),
    },
  ];
}

function errorSummary(rows, state, names, namer) {
  const best = least(rows, (row) => row.rel_rmse);
  const not = rows.filter((row) => row.status && row.status !== "ok");
  const whyNot = (row) => `${namer(row)} (${row.detail ?? row.status})`;
  const said = not.length ? ` Without a curve: ${shortList([...new Set(not.map(whyNot))], 4)}.` : "";
  if (!best) return `${names.scene.short(state.scene)}: no errors here.${said}`;
  return (
    `${names.scene.short(state.scene)}: the least RMSE is ${percent(best.rel_rmse)} ` +
    `${percentInterval(best.rel_rmse_ci95)}, of ${namer(best)} after ` +
    `${group(best.pass)} passes and ${seconds(best.seconds)}.${said}`
  );
}

function slopeFigure(fits, names, namer, index) {
  const scenes = distinct(fits, "scene").map((value) => ({ value, label: names.scene.short(value) }));
  const of = (state) => fits.filter((fit) => fit.scene === state.scene);
  return figure({
    id: "slopes",
    title: "Fitted slopes beside theory",
    controls: [{ key: "scene", label: "Scene", options: scenes, value: scenes[0].value }],
    draw: (width, state) => drawSlopes(width, of(state), namer, index),
    rows: of,
    columns: [
      { key: "series", label: "Series", value: namer },
      { key: "quantity", label: "Quantity" },
      { key: "slope", label: "Slope" },
      { key: "slope_ci95", csv: "slope", label: "95 % interval", interval: true },
      { key: "predicted", label: "Predicted" },
      { key: "asymptote", label: "Asymptote" },
      { key: "first_pass", label: "From pass" },
      { key: "last_pass", label: "To pass" },
      { key: "status", label: "Status" },
      { key: "detail", label: "Why" },
    ],
    summary: (state) => slopeSummary(of(state), namer),
    formula:
      "slope of the straight line through ln quantity over ln pass (variance = rel_noise²). Upright tick: " +
      "the slope of the same line through the law's values, over the same passes; " +
      "hollow diamond: what it tends to with infinitely many.",
    plusminus:
      "95 % intervals by jackknife over trials. A bias that is not 5 standard errors clear at every reading " +
      "has no fit.",
  });
}

function drawSlopes(width, fits, namer, index) {
  const each = width >= 900 ? Math.floor((width - 32) / 3) : width;
  return [...groupBy(fits, (fit) => fit.quantity)].flatMap(([quantity, members]) => {
    const items = members
      .filter((fit) => isNumber(fit.slope))
      .map((fit) => ({
        name: namer(fit),
        index: index(fit),
        value: fit.slope,
        interval: fit.slope_ci95,
        predicted: fit.predicted,
        asymptote: fit.asymptote,
        title:
          `${namer(fit)}: ${significant(fit.slope)} ${interval(fit.slope_ci95)}\n` +
          `predicted ${significant(fit.predicted)}, asymptote ${significant(fit.asymptote)}`,
      }));
    if (!items.length) return [];
    const x = linearAxis(
      "slope →",
      items.flatMap((item) => [item.value, item.predicted, item.asymptote, ...(item.interval ?? [])]),
      { zero: false, room: 0.08 },
    );
    x.ticks = 5;
    return [{ title: `Slope of the ${quantity === "rmse" ? "RMSE" : quantity}`, node: rowChart(each, items, { x }) }];
  });
}

function slopeSummary(fits, namer) {
  const fitted = fits.filter((fit) => isNumber(fit.slope));
  const judged = fitted.filter((fit) => isNumber(fit.predicted) && isInterval(fit.slope_ci95));
  const missed = judged.filter((fit) => outside(fit.predicted, fit.slope_ci95));
  const unfit = fits.length - fitted.length;
  return (
    `${fitted.length} of ${fits.length} slopes could be fitted` +
    `${unfit ? ` (${unfit} could not, the table says why)` : ""}; of ${judged.length} ` +
    `with a prediction ${judged.length - missed.length} hold it in ` +
    `their interval${
      missed.length
        ? `, not: ${shortList(
            missed.map((fit) => `${fit.quantity} of ${namer(fit)}`),
            4,
          )}`
        : ""
    }.`
  );
}
