// Searches by number of photons and k: recursive against iterative against the rest, builds and memory.
import { h } from "../base/dom.js";
import {
  group,
  interval,
  isInterval,
  isNumber,
  milliseconds,
  nanoseconds,
  significant,
  times,
  tick,
  plural,
} from "../base/format.js";
import { distinct, groupBy } from "../base/data.js";
import { least } from "../base/compare.js";
import { extent, lineChart } from "../chart/lines.js";
import { logAxis, timeAxis } from "../chart/plot.js";
import { rowChart } from "../chart/rows.js";
import { figure, missing } from "../figure.js";

const peers = ["nanoflann", "flann", "ann", "cgal", "embree-pointquery"];
export const isPeer = (row) => peers.some((peer) => row.search === peer || String(row.search).startsWith(`${peer}-`));
export const searchName = (row) => `${row.search}${isNumber(row.batch) && row.batch > 1 ? ` ×${row.batch}` : ""}`;

/** What rows of one comparison share. */
export const comparisonOf = (row) =>
  [row.case, row.photons, row.kind, row.k, row.radius, row.order, row.lookup, row.front, row.threads, row.file_name]
    .map(String)
    .join("|");
const filterOf = (row) =>
  [
    row.case,
    row.order,
    row.lookup === "sphere" ? null : row.lookup,
    row.front === "on" ? "front on" : null,
    row.shown_file,
  ]
    .filter(Boolean)
    .join(", ");
const lookupOf = (row) => (row.kind === "radius" ? `R = ${significant(row.radius)} m` : `k = ${row.k}`);

const intervals =
  "95 % intervals: of times from the order statistics of the samples, of ratios by the sign test over " +
  "interleaved rounds, corrected for the number " +
  "of contenders. They speak of this run on this machine.";

export function searchSection(report) {
  const many = report.files.filter((file) => file.command === "search").length > 1;
  const rows = report
    .rows("search")
    .filter((row) => typeof row.search === "string")
    .map((row) => ({ ...row, name: searchName(row), shown_file: many ? row.file_name : null }));
  if (!rows.length)
    return [
      missing(
        "times of searches: no rows of `search`",
        "photonbench search --case box,square,caustic,volume --k 8,50,500 --search all --json search.json",
      ),
    ];
  const order = distinct(rows, "name");
  const index = (name) => order.indexOf(name);
  const warnings = [...new Set(rows.map((row) => row.warning).filter(Boolean))];
  return [
    warnings.length
      ? h("p.warning", { role: "note" }, h("b", {}, "Warning of the run: "), warnings.join("; "))
      : null,
    timeFigure(rows, index),
    ratioFigure(rows, index),
    buildFigure(rows, index),
  ];
}

const columns = [
  { key: "name", csv: "search", label: "Search" },
  { key: "case", label: "Photons of" },
  { key: "photons", label: "Photons", format: group },
  { key: "lookup_of", csv: "lookup", label: "Lookup", value: lookupOf },
  { key: "order", label: "Order" },
  { key: "ns_per_query", label: "Time of a query", format: nanoseconds },
  {
    key: "ns_per_query_ci95",
    csv: "ns_per_query",
    label: "95 % interval",
    interval: true,
    format: (v) => interval(v, nanoseconds),
  },
  { key: "ratio", label: "Speed over baseline", format: times },
  { key: "ratio_ci95", csv: "ratio", label: "95 % interval", interval: true, format: (v) => interval(v) },
  { key: "baseline", label: "Baseline" },
  { key: "samples", label: "Samples" },
  { key: "build_ms", label: "Build", format: milliseconds },
  { key: "bytes_per_photon", label: "Bytes a photon" },
  { key: "exact", label: "Exact" },
  { key: "status", label: "Status" },
];

function legend(rows, index) {
  return distinct(rows, "name").map((name) => ({ name, label: name, index: index(name) }));
}

function timeFigure(rows, index) {
  const filters = [...new Set(rows.map(filterOf))];
  const of = (state) => rows.filter((row) => filterOf(row) === state.filter);
  return figure({
    id: "search-time",
    title: "Time of a query by k and by number of photons",
    controls: [{ key: "filter", label: "Photons of, order, filter", options: filters, value: filters[0] }],
    legend: (state) => legend(of(state), index),
    draw: (width, state) =>
      drawTimes(
        width,
        of(state).filter((row) => !state.hidden.has(row.name)),
        index,
      ),
    rows: of,
    columns,
    summary: (state) => fastest(of(state), state.filter),
    formula:
      "median time of one query on one thread (ns_per_query): the search alone, no estimate. “×16”: sixteen " +
      "queries handed over at once, time of each.",
    plusminus: intervals,
  });
}

function fastest(rows, where) {
  const parts = [...groupBy(rows, comparisonOf).values()]
    .map((members) => ({ members, best: least(members, (row) => row.ns_per_query) }))
    .filter((one) => one.best);
  if (!parts.length) return "No times here.";
  const some = parts.length > 3 ? [parts[0], parts[parts.length >> 1], parts[parts.length - 1]] : parts;
  const said = ({ best }) =>
    `${best.name} at ${lookupOf(best)}, ${group(best.photons)} photons (${nanoseconds(best.ns_per_query)})`;
  return `${where}: fastest is ${some.map(said).join("; ")}.`;
}

function points(rows, index, x) {
  return rows
    .map((row) => ({
      series: row.name,
      index: index(row.name),
      x: x(row),
      y: row.ns_per_query * 1e-9,
      interval: isInterval(row.ns_per_query_ci95) ? row.ns_per_query_ci95.map((v) => v * 1e-9) : null,
      title:
        `${row.name}, ${lookupOf(row)}, ${group(row.photons)} photons\n` +
        `${nanoseconds(row.ns_per_query)} ${interval(row.ns_per_query_ci95, nanoseconds)}`,
    }))
    .sort((a, b) => a.x - b.x);
}

function drawTimes(width, rows, index) {
  const charts = [];
  const add = (title, members, x, label, format) => {
    const list = points(members, index, x);
    if (!list.length) return;
    const values = list.map((point) => point.x);
    const axis = logAxis(label, values, { format, most: 6 });
    const own = [...new Set(values)].sort((a, b) => a - b);
    if (own.length < 7) axis.ticks = own;
    charts.push({ title, list, axis });
  };
  for (const [photons, members] of groupBy(
    rows.filter((row) => row.kind !== "radius"),
    (row) => row.photons,
  ))
    if (new Set(members.map((row) => row.k)).size > 1 || rows.length === members.length)
      add(`${group(photons)} photons, by k`, members, (row) => row.k, "k, nearest photons →", String);
  for (const [lookup, members] of groupBy(rows, lookupOf))
    if (new Set(members.map((row) => row.photons)).size > 1)
      add(
        `${lookup}, by number of photons`,
        members,
        (row) => row.photons,
        "photons in the map →",
        (v) => tick(v, 1),
      );
  const kinds = rows.filter((row) => row.kind === "radius");
  if (kinds.length && !charts.length)
    add(
      "by radius",
      kinds,
      (row) => row.radius,
      "radius, m →",
      (v) => tick(v, 2),
    );
  const each = charts.length > 1 && width >= 700 ? Math.floor((width - 16) / 2) : width;
  return charts.map(({ title, list, axis }) => ({
    title,
    node: lineChart(each, list, {
      x: axis,
      y: timeAxis("↑ time of a query", extent(list), { most: 8 }),
      height: 320,
    }),
  }));
}

function ratioFigure(rows, index) {
  const groups = [...groupBy(rows, comparisonOf).values()].filter((members) => members.length > 1);
  const label = (members) => `${filterOf(members[0])}, ${group(members[0].photons)} photons, ${lookupOf(members[0])}`;
  const options = groups.map((members, i) => ({ value: i, label: label(members) }));
  const of = (state) => groups[state.comparison] ?? rows;
  // First that of the most photons, at k = 50 if it is there.
  const weight = (members) => (members[0].photons ?? 0) * (members[0].k === 50 ? 2 : 1);
  const first = groups.reduce((best, members, i) => (weight(members) > weight(groups[best]) ? i : best), 0);
  return figure({
    id: "search-ratio",
    title: "Speed over the baseline",
    controls: [{ key: "comparison", label: "Comparison", options, value: first }],
    draw: (width, state) => drawRatios(width, of(state), index),
    rows: of,
    columns,
    summary: (state) => ratioSummary(of(state)),
    formula:
      "ratio = the baseline's time over a row's, of samples taken in turns, within rounds: above 1 is faster " +
      "than the baseline. The baseline against itself is the " +
      "control (aa_ratio): its interval should hold 1.",
    plusminus: intervals,
  });
}

function drawRatios(width, rows, index) {
  const items = rows
    .filter((row) => isNumber(row.ratio))
    .sort((a, b) => b.ratio - a.ratio)
    .map((row) => ({
      name: row.name,
      index: index(row.name),
      value: row.ratio,
      interval: row.ratio_ci95,
      title: `${row.name}: ${times(row.ratio)} ${interval(row.ratio_ci95)}`,
    }));
  if (!items.length) return [];
  const x = logAxis(
    `times as fast as ${rows[0].baseline ?? "the baseline"} →`,
    [1, ...items.flatMap((item) => [item.value, ...(item.interval ?? [])])],
    { most: width < 480 ? 4 : 8, format: (v) => tick(v, 1) },
  );
  return [{ node: rowChart(width, items, { x, rules: [1] }) }];
}

function ratioSummary(rows) {
  const of = (name) => rows.find((row) => row.search === name && !(row.batch > 1));
  const iterative = of("iterative");
  const parts = [];
  if (iterative && isNumber(iterative.ratio)) {
    const held = isInterval(iterative.ratio_ci95) && iterative.ratio_ci95[0] <= 1 && iterative.ratio_ci95[1] >= 1;
    parts.push(
      `iterative runs at ${times(iterative.ratio)} ${interval(iterative.ratio_ci95)} the speed of ` +
        `${iterative.baseline}` +
        (held
          ? ": they cannot be told apart"
          : iterative.ratio > 1
            ? ": iteration is faster"
            : ": recursion is faster"),
    );
  }
  const best = rows.filter((row) => isNumber(row.ratio)).sort((a, b) => b.ratio - a.ratio)[0];
  if (best) parts.push(`the fastest is ${best.name}, ${times(best.ratio)} ${interval(best.ratio_ci95)}`);
  const control = rows.find((row) => isInterval(row.aa_ratio_ci95));
  if (control) parts.push(`the control's interval is ${interval(control.aa_ratio_ci95)}`);
  const text = parts.join("; ");
  return text ? `${text[0].toUpperCase()}${text.slice(1)}.` : "No ratios here.";
}

function buildFigure(rows, index) {
  const groups = [...groupBy(rows, (row) => [row.case, row.photons, row.threads, row.file_name].join("|")).values()];
  const options = groups.map((members, i) => ({
    value: i,
    label:
      `${members[0].case}, ${group(members[0].photons)} photons, ${plural(members[0].threads ?? 1, "thread")}` +
      (members[0].shown_file ? `, ${members[0].shown_file}` : ""),
  }));
  const of = (state) =>
    [...groupBy(groups[state.map] ?? [], (row) => row.search).values()].map((members) => members[0]);
  const dot = (row) => index(searchName({ ...row, batch: 1 }));
  return figure({
    id: "search-build",
    title: "Time of a build, and memory",
    controls: [{ key: "map", label: "Map", options, value: 0 }],
    draw: (width, state) => drawBuilds(width, of(state), dot),
    rows: of,
    columns: [
      { key: "search", label: "Search" },
      { key: "photons", label: "Photons", format: group },
      { key: "build_ms", label: "Build", format: milliseconds },
      {
        key: "build_ms_ci95",
        csv: "build_ms",
        label: "95 % interval",
        interval: true,
        format: (v) => interval(v, milliseconds),
      },
      { key: "bytes_per_photon", label: "Bytes a photon" },
      { key: "threads", label: "Threads" },
      { key: "exact", label: "Exact" },
      { key: "status", label: "Status" },
    ],
    summary: (state) => {
      const members = of(state).filter((row) => row.search !== "brute");
      const quick = least(members, (row) => row.build_ms);
      const small = least(members, (row) => row.bytes_per_photon);
      return quick && small
        ? `Of ${members.length} structures (brute force has none) ${quick.search} is built fastest ` +
            `(${milliseconds(quick.build_ms)}), ${small.search} is the smallest ` +
            `(${significant(small.bytes_per_photon)} bytes a photon).`
        : "No builds here.";
    },
    formula:
      "build_ms: of our own searches photons are also checked, directions and powers arranged; peers index " +
      "positions alone, which they are handed packed. " +
      "bytes_per_photon: the structure with its ids, and the positions where queries read them.",
    plusminus:
      "the 95 % interval of five builds (or of as many as there were samples), in turns with the others. " +
      "Bytes are counted, not sampled.",
  });
}

function drawBuilds(width, rows, index) {
  const each = width >= 700 ? Math.floor((width - 16) / 2) : width;
  const items = (field, ci, format, scale = 1) =>
    rows
      .filter((row) => isNumber(row[field]))
      .map((row) => ({
        name: row.search,
        index: index(row),
        value: row[field] * scale,
        interval: ci && isInterval(row[ci]) ? row[ci].map((v) => v * scale) : null,
        title: `${row.search}: ${format(row[field])}`,
      }));
  const builds = items("build_ms", "build_ms_ci95", milliseconds, 1e-3);
  const sizes = items("bytes_per_photon", null, (v) => `${significant(v)} bytes a photon`);
  const charts = [];
  if (builds.length)
    charts.push({
      title: "Build",
      node: rowChart(each, builds, {
        bars: true,
        x: timeAxis(
          "time of a build →",
          builds.flatMap((b) => [b.value, ...(b.interval ?? [])]),
          { most: 4 },
        ),
      }),
    });
  if (sizes.length) {
    const most = Math.max(...sizes.map((item) => item.value));
    charts.push({
      title: "Memory",
      node: rowChart(each, sizes, {
        bars: true,
        x: { label: "bytes a photon →", domain: [0, most * 1.05], labelArrow: "none", ticks: 5 },
      }),
    });
  }
  return charts;
}
