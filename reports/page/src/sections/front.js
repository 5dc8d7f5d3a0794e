// First screen: error against time, one mark an estimator, and what may be had within a time or an error.
import {
  interval,
  isNumber,
  percent,
  percentInterval,
  seconds,
  shortList,
  significant,
  times,
  tick,
  list,
} from "../base/format.js";
import { least, overlap } from "../base/compare.js";
import { edgeLabels } from "../chart/labels.js";
import { ends, logAxis, logTicks, plot, Plot, timeAxis, tip } from "../chart/plot.js";
import { style } from "../chart/symbols.js";
import { figure } from "../figure.js";
import { frontModel, overall, paretoFront, ranking } from "./accuracy_model.js";

export const rmseIntervals =
  "95 % intervals over trials (independent photon maps; jackknife, of the logarithm). Probes of one map share " +
  "photons and are no replicates. A mean over cases has the mean of their intervals in the logarithm, as if all moved " +
  "together: wide rather than narrow. Intervals that overlap are called a tie. Costs have no interval: they are of " +
  "this machine. What is shorter than a mark is hidden by it: the table has it.";

export function frontFigure(choices, names) {
  const models = new Map(choices.map((choice) => [choice.value, frontModel(choice.rows, names)]));
  const views = [...new Set([...models.values()].flatMap((model) => [...model.views.keys()]))];
  const entriesOf = (state) => models.get(state.setting).views.get(state.view) ?? [];
  const name = (entry) => names.estimator.short(entry.estimator);
  const visible = (state) => ranking(entriesOf(state)).filter((entry) => !state.hidden.has(entry.estimator));
  return figure({
    id: "front",
    title: "Error against time, the best of each estimator",
    heading: "h2",
    controls: [
      { key: "view", label: "Case", options: views, value: views[0] },
      { key: "setting", label: "Photons", options: choices, value: choices[0].value },
    ],
    draw: (width, state) => drawFront(width, visible(state), paretoFront(entriesOf(state)), names.estimator),
    rows: (state) => ranking(entriesOf(state)),
    columns: [
      { key: "estimator", label: "Estimator", format: (_, row) => name(row) },
      { key: "lookup", label: "Lookup" },
      { key: "rmse", label: "RMSE", csv: "rel_rmse", format: percent },
      { key: "interval", label: "95 % interval", csv: "rel_rmse", interval: true, format: percentInterval },
      { key: "cost", label: "Cost", csv: "cost_s", format: seconds },
      { key: "ratio", label: "Error over the least", format: times },
      { key: "ratio_ci95", label: "95 % interval", csv: "ratio", interval: true, format: (v) => interval(v) },
      { key: "verdict", label: "Verdict" },
    ],
    summary: (state) => frontSummary(ranking(entriesOf(state)), name, state.view, models.get(state.setting)),
    formula:
      "rel_rmse = √(mean of e² over probes and trials) / M, with e = estimate − truth and M = mean of " +
      "|truth| over region " +
      "`all`; cost_s = drawing or tracing the photons + build + the queries of region `all`, on one thread. " +
      "Each estimator stands at " +
      "the k at which its error is least. Dashed, with small circles: the rows, of any k, than which none " +
      "has both less error and less cost. Over cases: " +
      "geometric means, at the same k for all.",
    plusminus: rmseIntervals,
    open: false,
  });
}

function drawFront(width, entries, pareto, names) {
  const name = (entry) => names.short(entry.estimator);
  const indexOf = (entry) => names.index(entry.estimator);
  const marks = entries.filter((entry) => isNumber(entry.cost));
  if (!marks.length) return [];
  const floor = entries.find((entry) => entry.oracle);
  const errors = [
    ...marks.flatMap((entry) => entry.interval ?? [entry.rmse]),
    ...marks.map((entry) => entry.rmse),
    floor?.rmse,
  ];
  const y = logAxis(
    "↑ RMSE, % of mean truth",
    errors.map((v) => v * 100),
    { most: 8 },
  );
  const x = timeAxis(
    "cost of a map and its queries, one thread →",
    marks.map((entry) => entry.cost),
    { most: width < 480 ? 3 : 6, room: 1.06 },
  );
  const height = Math.max(300, Math.min(430, width * 0.55));
  const right = width < 480 ? 126 : 150;
  const inside = pareto.filter(
    (entry) => entry.cost <= x.domain[1] && entry.rmse * 100 <= y.domain[1] && entry.cost >= x.domain[0],
  );
  const whiskers = marks
    .map((entry) => ({ entry, range: ends(entry.interval, y, 100) }))
    .filter((one) => one.range[0] !== undefined);
  const indexed = marks.map((entry) => ({ ...entry, index: indexOf(entry) }));
  const colour = (entry) => style(entry.index).colour;
  const chart = plot(width, {
    height,
    marginRight: right,
    x,
    y,
    marks: [
      Plot.line(inside, {
        x: "cost",
        y: (d) => d.rmse * 100,
        curve: "step-after",
        stroke: "var(--ink)",
        strokeDasharray: "4 3",
        strokeOpacity: 0.5,
      }),
      floor ? Plot.ruleY([floor.rmse * 100], { stroke: "var(--ink)", strokeDasharray: "1 4" }) : null,
      Plot.ruleX(whiskers, {
        x: (d) => d.entry.cost,
        y1: (d) => d.range[0],
        y2: (d) => d.range[1],
        stroke: (d) => style(indexOf(d.entry)).colour,
        strokeWidth: 2,
      }),
      Plot.dot(inside, { x: "cost", y: (d) => d.rmse * 100, r: 2.5, fill: "var(--paper)", stroke: "var(--ink)" }),
      Plot.dot(indexed, {
        x: "cost",
        y: (d) => d.rmse * 100,
        fill: colour,
        symbol: (d) => style(d.index).symbol,
        r: 6,
        stroke: "var(--paper)",
        strokeWidth: 1,
      }),
      tip(indexed, {
        x: "cost",
        y: (d) => d.rmse * 100,
        title: (d) =>
          `${name(d)}, ${d.lookup}\nRMSE ${percent(d.rmse)} ${percentInterval(d.interval)}\n` +
          `cost ${seconds(d.cost)}\n${d.verdict}`,
      }),
    ],
  });
  const sx = chart.scale("x");
  const sy = chart.scale("y");
  const labels = indexed.map((entry) => ({
    x: sx.apply(entry.cost),
    y: sy.apply(entry.rmse * 100),
    text: name(entry) + (entry.tie ? ", tie" : entry.leader ? ", least" : ""),
    colour: colour(entry),
  }));
  if (floor)
    labels.push({
      x: width - right - 6,
      y: sy.apply(floor.rmse * 100),
      text: `${name(floor)}, floor`,
      colour: "var(--ink)",
    });
  edgeLabels(chart, labels, { left: width - right + 18, top: 34, bottom: height - 46 });
  return [{ node: chart }];
}

function frontSummary(ranks, name, view, model) {
  const best = ranks.find((entry) => entry.leader);
  if (!best) return "No rows can be compared here.";
  const ties = ranks.filter((entry) => entry.tie);
  const left = model.all.filter((one) => !model.common.includes(one));
  const note =
    view === overall && left.length
      ? ` Left out of the mean, since not all estimators can do them: ${shortList(left, 6)}.`
      : "";
  const ks = view === overall ? ` ${lookups(model.views.get(overall))}` : "";
  const tied = ties.length ? `ties with ${shortList(ties.map(name), 5)}` : "is apart from all others";
  return (
    `${view}: ${name(best)} at ${best.lookup} has the least RMSE, ${percent(best.rmse)} ` +
    `${percentInterval(best.interval)}, at ` +
    `${seconds(best.cost)}; it ${tied}.${ks}${note}`
  );
}

/** In the mean only lookups count that every case has. */
const lookups = (entries) => `All cases have ${list([...new Set(entries.map((entry) => entry.lookup))])}.`;

/** Equal time and equal error: what is best within a budget, rows as they were measured, nothing interpolated. */
export function budgetFigure(choices, names) {
  const models = new Map(choices.map((choice) => [choice.value, frontModel(choice.rows, names)]));
  const views = [...new Set([...models.values()].flatMap((model) => [...model.views.keys()]))];
  const rowsOf = (state) =>
    budgets(
      (models.get(state.setting).views.get(state.view) ?? []).filter((entry) => isNumber(entry.cost)),
      names,
    );
  return figure({
    id: "budget",
    title: "Equal time, equal error",
    controls: [
      { key: "view", label: "Case", options: views, value: views[0] },
      { key: "setting", label: "Photons", options: choices, value: choices[0].value },
    ],
    rows: rowsOf,
    columns: [
      { key: "budget", label: "Budget" },
      { key: "winner", label: "Best" },
      { key: "lookup", label: "Lookup" },
      { key: "rmse", label: "RMSE", csv: "rel_rmse", format: percent },
      { key: "interval", label: "95 % interval", csv: "rel_rmse", interval: true, format: percentInterval },
      { key: "cost", label: "Cost", csv: "cost_s", format: seconds },
      { key: "ties", label: "Ties with it" },
    ],
    summary: (state) => {
      const rows = rowsOf(state);
      const said = (row) =>
        row.budget.startsWith("time")
          ? `within ${row.budget.slice(7)} ${row.winner} has the least error (${percent(row.rmse)})`
          : `an RMSE of ${row.budget.slice(7)} is reached soonest by ${row.winner} (${seconds(row.cost)})`;
      return rows.length ? `${state.view}: ${list(pick(rows).map(said))}.` : "No rows with a cost.";
    },
    formula:
      "equal time: the row of least rel_rmse among those whose cost_s is within the budget; equal error: the " +
      "row of least " +
      "cost_s among those whose rel_rmse is within it. Rows as measured, of any k; nothing is interpolated.",
    plusminus: `${rmseIntervals} Ties within a time: other estimators whose best interval overlaps the best's.`,
    open: true,
  });
}

/** The tightest and the widest of the budgets in time, and the same of those in error. */
function pick(rows) {
  const times = rows.filter((row) => row.budget.startsWith("time"));
  const errors = rows.filter((row) => !row.budget.startsWith("time"));
  return [times[0], times[times.length - 1], errors[0], errors[errors.length - 1]].filter(
    (row, i, all) => row && all.indexOf(row) === i,
  );
}

function budgets(entries, names) {
  if (!entries.length) return [];
  const costs = entries.map((entry) => entry.cost);
  const errors = entries.map((entry) => entry.rmse);
  const name = (entry) => names.estimator.short(entry.estimator);
  const tiesOf = (within, best) =>
    shortList(
      [
        ...new Set(
          within
            .filter((entry) => entry.estimator !== best.estimator && overlap(entry.interval, best.interval))
            .map(name),
        ),
      ],
      5,
    );
  const row = (budget, best, ties) => ({
    budget,
    winner: name(best),
    lookup: best.lookup,
    rmse: best.rmse,
    interval: best.interval,
    cost: best.cost,
    ties,
  });
  const rows = [];
  for (const budget of logTicks(Math.min(...costs), Math.max(...costs) * 1.2, 4)) {
    const within = entries.filter((entry) => entry.cost <= budget);
    const best = least(within, (entry) => entry.rmse);
    if (best) rows.push(row(`time ≤ ${seconds(budget, tick)}`, best, tiesOf(within, best)));
  }
  for (const budget of logTicks(Math.min(...errors), Math.max(...errors), 5)) {
    const within = entries.filter((entry) => entry.rmse <= budget);
    const best = least(within, (entry) => entry.cost);
    if (best) rows.push(row(`RMSE ≤ ${tick(budget * 100)} %`, best, ""));
  }
  return rows;
}
