// Numbers at the edges: a verdict a row, and how near each test comes to its bound.
import { rich } from "../base/dom.js";
import { group, isNumber, plural, shortList, significant, tick } from "../base/format.js";
import { groupBy } from "../base/data.js";
import { greatest } from "../base/compare.js";
import { logAxis, nameMargin, plot, Plot, rowHeight, tip } from "../chart/plot.js";
import { figure, missing } from "../figure.js";

const share = (row) => {
  if (!isNumber(row.measured) || !isNumber(row.bound)) return null;
  if (row.bound === 0) return row.measured === 0 ? 0 : null;
  return row.measured / row.bound;
};
export const failed = (row) => row.status === "fail" || row.status === "failed";

export function stressSection(report) {
  const rows = report.rows("stress");
  if (!rows.length)
    return [
      missing(
        "verdicts at the edges of numbers: no rows of `stress`",
        "photonbench stress --profile full --json stress.json",
      ),
    ];
  const left = report.files.filter((file) => file.command === "stress" && file.left_out);
  const tests = [...groupBy(rows, (row) => row.test)].map(([test, members]) => summarize(test, members));
  const failures = rows.filter(failed);
  return [verdictFigure(tests, rows, left), failures.length ? failureFigure(failures) : null];
}

function summarize(test, members) {
  const worst = greatest(members, share);
  return {
    test,
    passed: members.filter((row) => row.status === "pass").length,
    failed: members.filter(failed).length,
    rows: members.length,
    share: worst ? share(worst) : null,
    measured: worst?.measured ?? null,
    bound: worst?.bound ?? null,
    unit: worst?.unit ?? null,
    subject: worst?.subject ?? null,
    detail: worst?.detail ?? null,
  };
}

function verdictFigure(tests, rows, left) {
  const leftOut = left.length
    ? `Of ${left.map((file) => `${file.name} ${countOf(file.left_out)}`).join(", ")} rows are left out of ` +
      `this page: all of them passed, and further from their bound than those shown.`
    : null;
  return figure({
    id: "stress",
    title: "Verdicts, and how near each test comes to its bound",
    draw: (width) => drawTests(width, tests, left.length > 0),
    rows: () => tests,
    columns: [
      { key: "test", label: "Test" },
      { key: "passed", label: "Passed", format: group },
      { key: "failed", label: "Failed", format: group },
      { key: "share", label: "Worst, of its bound" },
      { key: "measured", label: "Measured" },
      { key: "bound", label: "Bound" },
      { key: "unit", label: "Unit" },
      { key: "subject", label: "By" },
      { key: "detail", label: "Of" },
    ],
    summary: () => stressSummary(tests, rows) + (leftOut ? ` ${leftOut}` : ""),
    formula:
      "measured / bound of the row nearest to its bound in each test; measured: distance from a computation " +
      "in extended precision, in units in the last place of the sum of " +
      "magnitudes (double, or float where squared distances round); bound: derived, not fitted. 0: exact to " +
      "the last bit. Beyond 1 a row fails.",
    plusminus: "none: every lookup is checked, nothing is sampled from a larger set.",
  });
}

const countOf = (left) => (isNumber(left) ? group(left) : Array.isArray(left) ? group(left.length) : "some");

function drawTests(width, tests, condensed) {
  const least = 1e-5;
  const items = tests.map((one) => ({
    ...one,
    x: isNumber(one.share) ? Math.max(least, one.share) : 1,
    bad: one.failed > 0,
  }));
  const margin = nameMargin(
    tests.map((one) => one.test),
    width,
  );
  const x = logAxis("worst row, measured / bound →", [least, 2, ...items.map((one) => one.x)], {
    most: width < 480 ? 4 : 7,
    format: (v) => (v <= least ? "0" : tick(v, 1)),
  });
  const counts = (one) =>
    one.failed
      ? `${group(one.failed)} FAILED of ${group(one.rows)}`
      : `${group(one.rows)} ${condensed ? "shown, pass" : "pass"}`;
  return [
    {
      node: plot(width, {
        height: rowHeight(tests.length),
        marginLeft: margin,
        marginRight: 110,
        x,
        y: { type: "band", domain: tests.map((one) => one.test), label: null, tickSize: 0, padding: 0.3 },
        marks: [
          Plot.ruleX([1], { stroke: "var(--bad)", strokeWidth: 1.5 }),
          Plot.barX(items, {
            y: "test",
            x1: () => x.domain[0],
            x2: "x",
            fill: (one) => (one.bad ? "var(--bad)" : "var(--series-0)"),
            fillOpacity: 0.45,
          }),
          Plot.dot(items, {
            y: "test",
            x: "x",
            symbol: (one) => (one.bad ? "times" : "circle"),
            stroke: (one) => (one.bad ? "var(--bad)" : "var(--series-0)"),
            strokeWidth: 2,
            r: 4,
          }),
          Plot.text(items, {
            y: "test",
            x: () => x.domain[1],
            text: counts,
            textAnchor: "start",
            dx: 8,
            fill: "var(--ink)",
            fontWeight: (one) => (one.bad ? 700 : 400),
          }),
          tip(items, {
            y: "test",
            x: "x",
            title: (one) =>
              `${one.test}: ${counts(one)}\nworst ${significant(one.measured)} of ` +
              `${significant(one.bound)} ${one.unit ?? ""}\n${one.subject ?? ""}`,
          }),
        ],
      }),
    },
  ];
}

function stressSummary(tests, rows) {
  const bad = tests.filter((one) => one.failed);
  const near = greatest(tests, (one) => one.share);
  const verdict = bad.length
    ? `${group(bad.reduce((sum, one) => sum + one.failed, 0))} of ${plural(rows.length, "row")} fail, in ${shortList(
        bad.map((one) => one.test),
        5,
      )}`
    : `All ${plural(rows.length, "row")} shown pass`;
  if (!near) return `${verdict}.`;
  const worst = `${significant(near.measured)} of ${significant(near.bound)} ${near.unit ?? ""}`;
  return `${verdict}. Nearest to its bound is ${near.test}: ${worst} (${near.subject}).`;
}

function failureFigure(failures) {
  return figure({
    id: "stress-failed",
    title: "Rows that fail",
    rows: () => failures,
    columns: ["test", "subject", "status", "measured", "bound", "unit", "detail"].map((key) => ({
      key,
      label: key[0].toUpperCase() + key.slice(1),
    })),
    summary: () => `${plural(failures.length, "row")} fail.`,
    formula: "as above.",
    open: true,
  });
}

export function errataSection(report) {
  const rows = report.errata;
  if (!rows.length)
    return [missing("the table of errata", "photonbench report (a program built with reports/errata.json)")];
  const columns = [
    ["number", "No."],
    ["title", "What"],
    ["source", "Source"],
    ["printed", "Printed"],
    ["right", "Right"],
    ["size", "Size"],
    ["measured", "Measured"],
    ["test", "Test"],
  ]
    .filter(([key]) => rows.some((row) => row[key] !== undefined && row[key] !== null))
    .map(([key, label]) => ({
      key,
      label,
      format: (v) => (v === null || v === undefined ? "–" : rich(key === "test" ? String(v).split("/").pop() : v)),
    }));
  const frame = figure({
    id: "errata",
    title: "What the papers print wrong",
    rows: () => rows,
    columns,
    summary: () =>
      `${plural(rows.length, "entry", "entries")}: what is printed, what is right, the measured size of the ` +
      `difference, and the test that shows it. Derivations are in docs/errata.md.`,
    formula:
      "each entry's size is that of the difference between the printed form and the right one, as `make " +
      "check` measures it by the test named.",
    plusminus: "sizes measured by accuracy have intervals within 0.2 %; theorems are exact.",
    open: true,
  });
  frame.classList.add("errata");
  return [frame];
}
