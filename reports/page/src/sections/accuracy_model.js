// Rows of `accuracy` as the page compares them: by setting, by case, and over the cases that all estimators have.
import { group, isInterval, isNumber } from "../base/format.js";
import { groupBy } from "../base/data.js";
import { least, logHalfWidth, overlap, ratio } from "../base/compare.js";

export const isOracle = (row) => String(row.estimator).split(":")[0] === "oracle";
const usable = (row) =>
  (row.status === "ok" || row.status === "degenerate" || row.status === undefined) &&
  isNumber(row.rel_rmse) &&
  row.rel_rmse > 0;

/** What rows must share to be compared at all. */
export const settingOf = (row) => [row.photons, row.sampler, row.lookup, row.front].map(String).join(" · ");
export const settingLabel = (row) =>
  `${group(row.photons)} ${row.sampler ?? ""} photons` +
  (row.lookup && row.lookup !== "sphere" ? `, lookup ${row.lookup}` : "") +
  (row.front === "off" ? ", front off" : "");

/** Settings, the one with the most rows first: [{value, label, rows}]. */
export function settings(rows) {
  const isScene = (row) => Number(String(row.case).startsWith("scene:"));
  const sorted = [...rows].sort((a, b) => isScene(a) - isScene(b)); // cases first, else as in the files
  return [...groupBy(sorted, settingOf)]
    .map(([value, members]) => ({ value, label: settingLabel(members[0]), rows: members }))
    .sort((a, b) => b.rows.length - a.rows.length);
}

/** The name by which a case is told from others: with its file, where two files have it in one setting. */
export function caseKeys(rows, names) {
  const files = groupBy(rows, (row) => `${row.case}|${settingOf(row)}`);
  const twice = new Set();
  for (const members of files.values())
    if (new Set(members.map((row) => row.file_name)).size > 1) twice.add(members[0].case);
  return (row) => names.short(row.case) + (twice.has(row.case) ? ` (${row.file_name})` : "");
}

export const lookupOf = (row) => (row.kind === "radius" ? `R = ${row.radius} m` : `k = ${row.k}`);

/** Marks of one case: an entry for each row of region `all`. */
function entriesOf(rows) {
  return rows.filter(usable).map((row) => ({
    estimator: row.estimator,
    k: row.k,
    lookup: lookupOf(row),
    rmse: row.rel_rmse,
    interval: isInterval(row.rel_rmse_ci95) ? row.rel_rmse_ci95 : null,
    cost: isNumber(row.cost_s) && !isOracle(row) ? row.cost_s : null,
    oracle: isOracle(row),
    cases: 1,
  }));
}

/** Geometric mean over cases. Its interval takes errors of all cases to move together: wide rather than narrow. */
function meanOver(rows, count) {
  const usableRows = rows.filter(usable);
  if (usableRows.length !== count) return null;
  const mean = (value) => Math.exp(usableRows.reduce((sum, row) => sum + Math.log(value(row)), 0) / count);
  const widths = usableRows.map((row) => logHalfWidth(row.rel_rmse_ci95));
  const half = widths.includes(null) ? null : widths.reduce((sum, width) => sum + width, 0) / count;
  const rmse = mean((row) => row.rel_rmse);
  const [first] = usableRows;
  const cost = usableRows.every((row) => isNumber(row.cost_s) && row.cost_s > 0) && !isOracle(first);
  return {
    estimator: first.estimator,
    k: first.k,
    lookup: lookupOf(first),
    rmse,
    interval: half === null ? null : [rmse * Math.exp(-half), rmse * Math.exp(half)],
    cost: cost ? mean((row) => row.cost_s) : null,
    oracle: isOracle(first),
    cases: count,
  };
}

/** Cases that all of the commoner estimators have; those of few cases are left out of the mean. */
function commonCases(rows, keyOf) {
  const byEstimator = new Map();
  for (const row of rows.filter(usable)) {
    if (!byEstimator.has(row.estimator)) byEstimator.set(row.estimator, new Set());
    byEstimator.get(row.estimator).add(keyOf(row));
  }
  const most = Math.max(0, ...[...byEstimator.values()].map((cases) => cases.size));
  const kept = [...byEstimator.values()].filter((cases) => cases.size >= most / 2);
  const all = [...new Set(rows.map(keyOf))];
  return { all, common: all.filter((name) => kept.every((cases) => cases.has(name))) };
}

export const overall = "all cases, geometric mean";

/** {views: Map(name -> entries), cases, common, keyOf}: the overall view first, if there are two cases to average. */
export function frontModel(rows, names) {
  const keyOf = caseKeys(rows, names.case);
  const inAll = rows.filter((row) => row.region === "all");
  const { all, common } = commonCases(inAll, keyOf);
  const views = new Map();
  if (common.length > 1) {
    const members = inAll.filter((row) => common.includes(keyOf(row)));
    const groups = groupBy(members, (row) => `${row.estimator}|${lookupOf(row)}`);
    const entries = [...groups.values()].map((group) => meanOver(group, common.length)).filter(Boolean);
    if (entries.length) views.set(overall, entries);
  }
  for (const [name, members] of groupBy(inAll, keyOf)) {
    const entries = entriesOf(members);
    if (entries.length) views.set(name, entries);
  }
  return { views, all, common, keyOf };
}

/** One entry an estimator, that of least error, the best first; `verdict` compares each with the best. */
export function ranking(entries) {
  const best = [...groupBy(entries, (entry) => entry.estimator).values()]
    .map((group) => least(group, (e) => e.rmse))
    .sort((a, b) => a.rmse - b.rmse);
  const leader = best.find((entry) => !entry.oracle);
  return best.map((entry) => {
    const behind =
      leader && entry !== leader ? ratio(entry.rmse, entry.interval, leader.rmse, leader.interval) : null;
    let verdict = "behind";
    if (entry.oracle) verdict = "floor: knows the truth, cannot be run";
    else if (entry === leader) verdict = "least";
    else if (overlap(entry.interval, leader.interval)) verdict = "tie with the least";
    return {
      ...entry,
      verdict,
      leader: entry === leader,
      tie: verdict.startsWith("tie"),
      ratio: behind?.value ?? (entry === leader ? 1 : null),
      ratio_ci95: behind?.interval ?? null,
    };
  });
}

/** Entries that no other beats in both error and cost, in order of cost. */
export function paretoFront(entries) {
  const sorted = entries.filter((entry) => isNumber(entry.cost)).sort((a, b) => a.cost - b.cost || a.rmse - b.rmse);
  const front = [];
  for (const entry of sorted) if (!front.length || entry.rmse < front[front.length - 1].rmse) front.push(entry);
  return front;
}
