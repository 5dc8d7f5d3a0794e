// Storage policies: error against photons stored and time, and what they save at equal error.
import {
  group,
  interval,
  isNumber,
  percent,
  percentInterval,
  seconds,
  shortList,
  significant,
  times,
  tick,
} from "../base/format.js";
import { distinct } from "../base/data.js";
import { greatest } from "../base/compare.js";
import { extent, lineChart } from "../chart/lines.js";
import { logAxis, timeAxis } from "../chart/plot.js";
import { rowChart } from "../chart/rows.js";
import { figure, missing } from "../figure.js";

const placeOf = (names) => (row) =>
  `${names.scene.short(row.scene)}, ${row.map ?? "?"} map${row.file_name ? `, ${row.file_name}` : ""}`;

export function storageSection(report) {
  const rows = report.rows("storage");
  const how = "photonbench storage --profile full --json storage.json";
  if (!rows.length) return [missing("storage policies: no rows of `storage`", how)];
  const fronts = report.rows("storage", "fronts");
  const many = report.files.filter((file) => file.command === "storage").length > 1;
  const strip = (row) => (many ? row : { ...row, file_name: "" });
  return [
    errorFigure(rows.map(strip), report.names),
    fronts.length
      ? savingFigure(fronts.map(strip), report.names)
      : missing("what policies save at equal error: no `fronts` in the file", how),
  ];
}

const measures = [
  { value: "rel_added", label: "added by the map (rel_added)" },
  { value: "rel_rmse", label: "RMSE of the image (rel_rmse)" },
];

function errorFigure(rows, names) {
  const place = placeOf(names);
  const places = [...new Set(rows.map(place))];
  const of = (state) => rows.filter((row) => place(row) === state.place);
  return figure({
    id: "storage-front",
    title: "Error against photons stored, and against time",
    controls: [
      { key: "place", label: "Scene and map", options: places, value: places[0] },
      {
        key: "measure",
        label: "Error",
        options: measures,
        value: rows.some((row) => row.rel_added > 0) ? "rel_added" : "rel_rmse",
      },
    ],
    legend: (state) =>
      distinct(of(state), "policy").map((name) => ({
        name,
        label: names.policy.short(name),
        index: names.policy.index(name),
      })),
    draw: (width, state) =>
      drawErrors(
        width,
        of(state).filter((row) => !state.hidden.has(row.policy)),
        state.measure,
        names,
      ),
    rows: of,
    columns: [
      { key: "policy", label: "Policy", format: (v) => names.policy.short(v) },
      { key: "map", label: "Map" },
      { key: "emitted", label: "Sent", format: group },
      { key: "stored", label: "Stored", format: group },
      { key: "trace_s", label: "Tracing", format: seconds },
      { key: "policy_s", label: "Policy", format: seconds },
      { key: "importance_s", label: "Importance", format: seconds },
      { key: "total_s", label: "In all", format: seconds },
      { key: "rel_rmse", label: "RMSE", format: percent },
      { key: "rel_rmse_ci95", csv: "rel_rmse", label: "95 % interval", interval: true, format: percentInterval },
      { key: "rel_added", label: "Added by the map", format: percent },
      { key: "rel_added_ci95", csv: "rel_added", label: "95 % interval", interval: true, format: percentInterval },
      { key: "flux_ratio", label: "Flux kept", format: percent },
      { key: "flux_ratio_ci95", csv: "flux_ratio", label: "95 % interval", interval: true, format: percentInterval },
      { key: "power_spread", label: "Power spread" },
      { key: "trials", label: "Trials" },
      { key: "status", label: "Status" },
    ],
    summary: (state) => errorSummary(of(state), state, names),
    formula:
      "rel_rmse = √(mean of e² over pixels and trials), with e = image − reference over the reference's " +
      "mean, of images of infinitely many eye paths; rel_added = " +
      "√(rel_rmse² − that of the same image with large maps): what the map in question adds. stored: photons " +
      "in the map; total_s = tracing + policy + build + importance, wall clock.",
    plusminus:
      "95 % intervals: of rel_added over trials alone, of rel_rmse over trials and groups of eye paths. " +
      "Squares of next to nothing may come out below 0; the root is then given as 0 " +
      "and does not show on a logarithmic axis. Times are medians over trials, without interval.",
  });
}

function drawErrors(width, rows, measure, names) {
  const each = width >= 760 ? Math.floor((width - 16) / 2) : width;
  const points = (field) =>
    rows
      .filter((row) => row[measure] > 0)
      .map((row) => ({
        series: row.policy,
        index: names.policy.index(row.policy),
        x: row[field],
        size: row.stored,
        y: row[measure],
        interval: row[`${measure}_ci95`],
        title:
          `${names.policy.short(row.policy)}\n${group(row.stored)} stored, ${seconds(row.total_s)}\n` +
          `${percent(row[measure])} ${percentInterval(row[`${measure}_ci95`])}`,
      }))
      .filter((point) => point.x > 0)
      .sort((a, b) => a.size - b.size);
  const chart = (title, list, x) => ({
    title,
    node: lineChart(each, list, {
      x,
      y: logAxis("↑ error, % of mean radiance", extent(list, 100)),
      scale: 100,
      height: 330,
    }),
  });
  const stored = points("stored");
  const total = points("total_s");
  const charts = [];
  if (stored.length)
    charts.push(
      chart(
        "By photons stored",
        stored,
        logAxis(
          "photons stored →",
          stored.map((p) => p.x),
          { most: 5 },
        ),
      ),
    );
  if (total.length)
    charts.push(
      chart(
        "By time in all",
        total,
        timeAxis(
          "time in all →",
          total.map((p) => p.x),
          { most: 4 },
        ),
      ),
    );
  return charts;
}

function errorSummary(rows, state, names) {
  const known = rows.filter((row) => isNumber(row[state.measure]));
  if (!known.length)
    return `${state.place}: no errors here: ${shortList(distinct(rows, "detail").filter(Boolean), 2) || "no rows"}.`;
  const best = known.reduce((a, b) => (b[state.measure] < a[state.measure] ? b : a));
  return (
    `${state.place}: the least error is ${percent(best[state.measure])} ` +
    `${percentInterval(best[`${state.measure}_ci95`])}, ` +
    `by ${names.policy.short(best.policy)} with ` +
    `${group(best.stored)} photons stored in ${seconds(best.total_s)}.`
  );
}

const savings = [
  { value: "stored", label: "photons stored" },
  { value: "trace", label: "time of tracing" },
  { value: "time", label: "time in all" },
];

function savingFigure(fronts, names) {
  const place = placeOf(names);
  const places = [...new Set(fronts.map(place))];
  const of = (state) => fronts.filter((front) => place(front) === state.place);
  const value = (front, what) => front[`${what}_ratio`];
  return figure({
    id: "storage-saving",
    title: "At equal error: how many times as much `all` needs",
    controls: [{ key: "place", label: "Scene and map", options: places, value: places[0] }],
    draw: (width, state) => drawSavings(width, of(state), value, names),
    rows: of,
    columns: [
      { key: "policy", label: "Policy", format: (v) => names.policy.short(v) },
      { key: "map", label: "Map" },
      { key: "measure", label: "Error by" },
      { key: "rel_error", label: "At error", format: percent },
      ...savings.flatMap(({ value: what, label }) => [
        { key: `${what}_ratio`, label: `${label}`, format: times },
        {
          key: `${what}_ratio_ci95`,
          csv: `${what}_ratio`,
          label: "95 % interval",
          interval: true,
          format: (v) => interval(v),
        },
      ]),
      { key: "status", label: "Status" },
      { key: "detail", label: "Why" },
    ],
    summary: (state) => savingSummary(of(state), state, names),
    formula:
      "cost of `all` over cost of the policy, at the least error that both reach (straight lines between " +
      "logarithms of the rows' means): above 1 the policy saves. " +
      "No ratio where no error is one that both reach: such fronts are incomparable, and named below.",
    plusminus: "95 % intervals over trials, which both have alike; they do not hold what all rows share.",
  });
}

function drawSavings(width, fronts, value, names) {
  const each = width >= 900 ? Math.floor((width - 32) / 3) : width;
  return savings.flatMap(({ value: what, label }) => {
    const items = fronts
      .filter((front) => isNumber(value(front, what)) && front.policy !== "all")
      .map((front) => ({
        name: names.policy.short(front.policy),
        index: names.policy.index(front.policy),
        value: value(front, what),
        interval: front[`${what}_ratio_ci95`],
        title:
          `${names.policy.short(front.policy)}: ${times(value(front, what))} ` +
          interval(front[`${what}_ratio_ci95`]),
      }));
    if (!items.length) return [];
    const x = logAxis(
      `${label}: all / policy →`,
      [0.9, 1.1, ...items.flatMap((item) => [item.value, ...(item.interval ?? [])])],
      { most: 5, format: (v) => tick(v, 2) },
    );
    return [{ title: label[0].toUpperCase() + label.slice(1), node: rowChart(each, items, { x, rules: [1] }) }];
  });
}

function savingSummary(fronts, state, names) {
  const others = fronts.filter((front) => front.policy !== "all");
  const best = greatest(others, (front) => front.stored_ratio);
  const quick = greatest(others, (front) => front.time_ratio);
  const not = others.filter((front) => front.status && front.status !== "ok");
  const parts = [];
  if (best)
    parts.push(
      `${names.policy.short(best.policy)} saves most photons: \`all\` stores ${times(best.stored_ratio)} ` +
        `${interval(best.stored_ratio_ci95)} as many at ${percent(best.rel_error)}`,
    );
  if (quick)
    parts.push(
      `${names.policy.short(quick.policy)} does best by time in all, ${times(quick.time_ratio)} ` +
        `${interval(quick.time_ratio_ci95)}`,
    );
  if (not.length)
    parts.push(
      `incomparable: ${shortList(
        not.map((front) => names.policy.short(front.policy)),
        5,
      )}`,
    );
  return `${state.place}: ${parts.join("; ") || "nothing to compare"}.`;
}
