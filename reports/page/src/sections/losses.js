// Where we lose: found by the page in the rows, not chosen by hand.
import {
  group,
  interval,
  isNumber,
  isInterval,
  nanoseconds,
  milliseconds,
  percent,
  percentInterval,
  plural,
  significant,
  signedPercent,
  times,
} from "../base/format.js";
import { groupBy } from "../base/data.js";
import { below, least, outside, ratio } from "../base/compare.js";
import { figure } from "../figure.js";
import { parse } from "../base/names.js";
import { caseKeys, isOracle, lookupOf, settingOf } from "./accuracy_model.js";
import { missedPredictions } from "./accuracy_cases.js";
import { seriesNamer } from "./converge.js";
import { comparisonOf, isPeer, searchName } from "./search.js";
import { failed } from "./stress.js";

const loss = (kind, who, where, what, size = null, to = null) => ({ kind, who, where, what, size, to });

/** Many lines of one kind, loser and winner become one, which holds the worst of them. */
function collapse(found) {
  return [...groupBy(found, (one) => (one.to === null ? one : `${one.kind}|${one.who}|${one.to}`)).values()].map(
    (same) => {
      if (same.length === 1) return same[0];
      const worst = same.reduce((a, b) => (b.size > a.size ? b : a));
      return { ...worst, where: `${same.length} comparisons; worst: ${worst.where}` };
    },
  );
}

/** Estimators against the plain disc: clearly more error at the same k. One line an estimator, its worst place. */
function againstDisc(rows, names) {
  const keyOf = caseKeys(rows, names.case);
  const found = new Map();
  let compared = 0;
  for (const members of groupBy(rows, (row) =>
    [keyOf(row), row.region, lookupOf(row), settingOf(row)].join("|"),
  ).values()) {
    const disc = members.find((row) => parse(row.estimator).base === "disc");
    if (!disc || !isInterval(disc.rel_rmse_ci95)) continue;
    compared++;
    for (const row of members) {
      if (row === disc || isOracle(row) || !below(disc.rel_rmse_ci95, row.rel_rmse_ci95)) continue;
      const list = found.get(row.estimator) ?? [];
      list.push({ row, disc, ...ratio(row.rel_rmse, row.rel_rmse_ci95, disc.rel_rmse, disc.rel_rmse_ci95) });
      found.set(row.estimator, list);
    }
  }
  return [...found].map(([estimator, list]) => {
    const worst = list.reduce((a, b) => (b.value > a.value ? b : a));
    return loss(
      "simpler is better",
      names.estimator.short(estimator),
      `${list.length} of ${compared} lookups and regions; worst: ${keyOf(worst.row)}, ${worst.row.region}, ` +
        `${lookupOf(worst.row)}`,
      `RMSE ${percent(worst.row.rel_rmse)} against ${percent(worst.disc.rel_rmse)} of the plain disc: ` +
        `${times(worst.value)} ${interval(worst.interval)}`,
      worst.value,
    );
  });
}

function missed(rows, names) {
  const { all, missed: list } = missedPredictions(rows);
  if (!list.length) return [];
  const keyOf = caseKeys(rows, names.case);
  const head = loss(
    "prediction missed",
    "all estimators",
    `${plural(all, "prediction")} of bias and noise`,
    `${group(list.length)} lie outside the 95 % interval (${percent(list.length / all)}; 5 % are expected by chance)`,
    list.length / all / 0.05,
  );
  return [
    head,
    ...list
      .slice(0, 10)
      .map((one) =>
        loss(
          "prediction missed",
          names.estimator.short(one.row.estimator),
          `${keyOf(one.row)}, ${one.row.region}, ${lookupOf(one.row)}`,
          `${one.quantity === "rel_bias" ? "bias" : "noise"} ${signedPercent(one.measured)} ` +
            `${percentInterval(one.interval)}, predicted ${signedPercent(one.predicted)}: ` +
            `${significant(Math.abs(one.off))} half-widths off`,
          Math.abs(one.off),
        ),
      ),
  ];
}

function searches(rows) {
  const found = [];
  for (const members of groupBy(rows, comparisonOf).values()) {
    const where =
      `${members[0].case}, ${group(members[0].photons)} photons, ${lookupOf(members[0])}, ` +
      `${members[0].order ?? ""}`;
    const own = members.filter((row) => !isPeer(row) && row.search !== "brute");
    const peers = members.filter(isPeer);
    const best = least(own, (row) => row.ns_per_query);
    const single = least(
      own.filter((row) => !(row.batch > 1)),
      (row) => row.ns_per_query,
    );
    for (const peer of peers)
      if (best && peer.ns_per_query < best.ns_per_query)
        found.push(
          loss(
            "peer is faster",
            searchName(best),
            where,
            `${nanoseconds(best.ns_per_query)} against ${nanoseconds(peer.ns_per_query)} of ${peer.search}` +
              (below(peer.ns_per_query_ci95, best.ns_per_query_ci95) ? "" : " (intervals overlap)"),
            best.ns_per_query / peer.ns_per_query,
            peer.search,
          ),
        );
    const wide = members.find((row) => row.search === "wide" && !(row.batch > 1));
    if (wide && single && wide !== single)
      found.push(
        loss(
          "simpler is better",
          "wide",
          where,
          `${nanoseconds(wide.ns_per_query)} a query alone against ${nanoseconds(single.ns_per_query)} of ` +
            `${single.search}` +
            (below(single.ns_per_query_ci95, wide.ns_per_query_ci95) ? "" : " (intervals overlap)"),
          wide.ns_per_query / single.ns_per_query,
          single.search,
        ),
      );
    for (const row of members)
      if (row.exact === false || row.status === "inexact" || row.status === "failed")
        found.push(loss("inexact", searchName(row), where, row.detail ?? row.status));
  }
  return collapse([...found, ...builds(rows)]);
}

function builds(rows) {
  const found = [];
  for (const members of groupBy(rows, (row) =>
    [row.case, row.photons, row.threads, row.file_name].join("|"),
  ).values()) {
    const wide = members.find((row) => row.search === "wide");
    if (!wide) continue;
    const where = `${wide.case}, ${group(wide.photons)} photons`;
    const others = members.filter((row) => row.search !== "wide" && row.search !== "brute" && row.search !== "grid");
    const quick = least(others, (row) => row.build_ms);
    const small = least(others, (row) => row.bytes_per_photon);
    if (quick && quick.build_ms < wide.build_ms)
      found.push(
        loss(
          "build is slower",
          "wide",
          where,
          `${milliseconds(wide.build_ms)} against ${milliseconds(quick.build_ms)} of ${quick.search}` +
            (below(quick.build_ms_ci95, wide.build_ms_ci95) ? "" : " (intervals overlap)"),
          wide.build_ms / quick.build_ms,
          quick.search,
        ),
      );
    if (small && small.bytes_per_photon < wide.bytes_per_photon)
      found.push(
        loss(
          "memory is larger",
          "wide",
          where,
          `${significant(wide.bytes_per_photon)} bytes a photon against ` +
            `${significant(small.bytes_per_photon)} of ${small.search}`,
          wide.bytes_per_photon / small.bytes_per_photon,
          small.search,
        ),
      );
  }
  return found;
}

function storage(fronts, names) {
  const found = [];
  for (const front of fronts.filter((one) => one.policy !== "all")) {
    const where = `${names.scene.short(front.scene)}, ${front.map} map`;
    const who = names.policy.short(front.policy);
    if (front.status && front.status !== "ok")
      found.push(loss("incomparable", who, where, front.detail ?? front.status));
    for (const [what, label] of [
      ["time", "time in all"],
      ["stored", "photons stored"],
    ]) {
      const [value, ci] = [front[`${what}_ratio`], front[`${what}_ratio_ci95`]];
      if (isNumber(value) && isInterval(ci) && ci[1] < 1)
        found.push(
          loss(
            "policy costs more",
            who,
            where,
            `${times(1 / value)} ${interval([1 / ci[1], 1 / ci[0]])} the ${label} of \`all\` at an error of ` +
              `${percent(front.rel_error)}`,
            1 / value,
          ),
        );
    }
  }
  return found;
}

function converge(report) {
  const fits = report.rows("converge", "fits");
  const namer = seriesNamer(report.rows("converge"), report.names);
  const found = [];
  for (const fit of fits)
    if (isNumber(fit.predicted) && outside(fit.predicted, fit.slope_ci95))
      found.push(
        loss(
          "prediction missed",
          namer(fit),
          `${report.names.scene.short(fit.scene)}, slope of the ${fit.quantity}`,
          `${significant(fit.slope)} ${interval(fit.slope_ci95)}, predicted ${significant(fit.predicted)}`,
        ),
      );
  for (const row of report.rows("converge"))
    if (row.status && row.status !== "ok")
      found.push(loss(row.status, namer(row), report.names.scene.short(row.scene), row.detail ?? row.status));
  return found;
}

function statuses(rows, names) {
  const keyOf = caseKeys(rows, names.case);
  const odd = rows.filter((row) => row.status && row.status !== "ok");
  return [...groupBy(odd, (row) => `${row.status}|${row.estimator}|${row.detail}`).values()].map((members) =>
    loss(
      members[0].status,
      names.estimator.short(members[0].estimator),
      [...new Set(members.map(keyOf))].join(", "),
      `${plural(members.length, "row")}: ${members[0].detail ?? "no reason given"}`,
    ),
  );
}

export function losses(report) {
  const accuracy = report.rows("accuracy");
  return [
    ...report
      .rows("stress")
      .filter(failed)
      .map((row) =>
        loss(
          "verdict failed",
          row.subject,
          `stress, ${row.test}`,
          `${significant(row.measured)} of ${significant(row.bound)} ${row.unit ?? ""}: ${row.detail ?? ""}`,
        ),
      ),
    ...searches(report.rows("search")),
    ...againstDisc(accuracy, report.names),
    ...storage(report.rows("storage", "fronts"), report.names),
    ...missed(accuracy, report.names),
    ...converge(report),
    ...statuses(accuracy, report.names),
  ];
}

export function lossesSection(report) {
  const all = losses(report);
  const kinds = [...groupBy(all, (one) => one.kind)];
  const options = [
    { value: "", label: `all (${all.length})` },
    ...kinds.map(([kind, members]) => ({ value: kind, label: `${kind} (${members.length})` })),
  ];
  const of = (state) => all.filter((one) => !state.kind || one.kind === state.kind);
  return [
    figure({
      id: "losses",
      title: "Where we lose",
      controls: [{ key: "kind", label: "Kind", options, value: "" }],
      rows: of,
      columns: [
        { key: "kind", label: "Kind" },
        { key: "who", label: "Who" },
        { key: "where", label: "Where" },
        { key: "what", label: "What" },
        { key: "size", label: "By a factor, or half-widths" },
      ],
      summary: () =>
        all.length
          ? `${plural(all.length, "line")}: ${kinds.map(([kind, members]) => `${kind} ${members.length}`).join(", ")}.`
          : "Nothing found in the rows of this report.",
      formula:
        "found in the rows by this page: peers or simpler searches with less time than our best, other " +
        "estimators with more error than the plain disc at the same k (intervals apart), slower " +
        "builds and larger maps than another structure's, policies that cost more than `all` at equal error " +
        "(intervals below 1), fronts without a common error, predictions outside the interval " +
        "(the ten worst), slopes without their prediction, failed verdicts, rows that are not ok.",
      plusminus:
        "95 % intervals as in the sections above; where they overlap the line says so. Of many predictions " +
        "one in twenty is missed by chance.",
      open: true,
    }),
  ];
}
