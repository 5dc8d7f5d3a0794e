// The page of the fixture: it opens, every figure is drawn, and what it says is what the files say.
import assert from "node:assert/strict";
import { readFileSync } from "node:fs";
import path from "node:path";
import { after, before, test } from "node:test";
import { choose, drawAll, fixture, hasReport, launch, makePage, open, tableOf } from "./browser.mjs";

const json = (name) => JSON.parse(readFileSync(path.join(fixture, name), "utf8"));
const accuracy = json("accuracy.json").rows;
const figures = [
  "front",
  "image-errors",
  "rendered",
  "budget",
  "by-k",
  "by-region",
  "by-case",
  "predicted",
  "search-time",
  "search-ratio",
  "search-build",
  "storage-front",
  "storage-saving",
  "converge",
  "slopes",
  "stress",
  "errata",
  "losses",
  "runs",
];
const charts = figures.filter((id) => !["rendered", "budget", "errata", "losses", "runs"].includes(id));

let browser;
let file;
let page;
before(async () => {
  browser = await launch();
  file = await makePage(browser, "whole");
  console.log(`# page by ${hasReport() ? "photonbench report" : "assemble.mjs"}`);
  page = await open(browser, file);
});
after(() => browser?.close());

test("opens from a file within two seconds, without an error or a request", async () => {
  let best = Infinity;
  for (let i = 0; i < 3; i++) {
    const began = performance.now();
    const fresh = await open(browser, file);
    best = Math.min(best, performance.now() - began);
    assert.deepEqual(fresh.wrong, []);
    await fresh.close();
  }
  assert.ok(best < 2000, `${best} ms`);
});

test("every figure is there, drawn, not empty, and named", async () => {
  await drawAll(page);
  assert.deepEqual(
    (await page.$$eval("[data-figure]", (all) => all.map((one) => one.dataset.figure))).sort(),
    [...figures].sort(),
  );
  for (const id of charts) {
    const svgs = await page.$$eval(`[data-figure="${id}"] .charts svg`, (all) =>
      all.map((svg) => ({
        role: svg.getAttribute("role"),
        label: svg.getAttribute("aria-label"),
        width: svg.getBoundingClientRect().width,
        marks: [...svg.querySelectorAll("circle, path, rect, text, line")].filter((mark) => {
          const box = mark.getBoundingClientRect();
          return box.width + box.height > 1;
        }).length,
      })),
    );
    assert.ok(svgs.length, `${id} has no chart`);
    for (const svg of svgs) {
      assert.equal(svg.role, "img", id);
      assert.ok(svg.label.length > 30, `${id}: ${svg.label}`);
      assert.ok(svg.width > 150 && svg.marks > 5, `${id}: ${JSON.stringify(svg)}`);
    }
  }
  assert.deepEqual(await page.$$eval(".missing", (all) => all.map((one) => one.textContent)), []);
  assert.deepEqual(page.wrong, []);
});

test("marks stand for rows: as many as the file has", async () => {
  const rows = accuracy.filter((row) => row.case.startsWith("square") && row.region === "all");
  const whiskers = await page.$$eval(
    '[data-figure="by-k"] .panel:nth-child(3) g[aria-label="rule"] line',
    (all) => all.length,
  );
  assert.equal(whiskers, rows.filter((row) => row.rel_rmse_ci95).length);
});

test("every figure says its formula and what its intervals are", async () => {
  for (const id of figures) {
    const text = await page.locator(`[data-figure="${id}"] figcaption`).textContent();
    assert.match(text, /Shown: .{20}/, id);
    if (!["runs"].includes(id)) assert.match(text, /±: .{10}/, id);
  }
});

const same = (cell, value, what) => assert.deepEqual(cell.value, value ?? null, what);

test("accuracy: values and their rounding", async () => {
  await choose(page, "by-k", "Case", "edge");
  await choose(page, "by-k", "Region", "lit");
  const rows = accuracy.filter((row) => row.case.startsWith("edge") && row.region === "lit");
  const shown = await tableOf(page, "by-k");
  assert.equal(shown.length, rows.length);
  rows.forEach((row, i) => {
    for (const key of [
      "estimator",
      "rel_bias",
      "rel_bias_ci95",
      "predicted_rel_bias",
      "rel_noise",
      "rel_rmse",
      "rel_rmse_ci95",
      "ns_per_query",
      "cost_s",
    ])
      same(shown[i][key], row[key], `${key} of row ${i}`);
    const text = shown[i].rel_rmse.text.replace(/[, %]/g, "");
    assert.ok(Math.abs(Number(text) / 100 - row.rel_rmse) <= 0.006 * row.rel_rmse, `${text} for ${row.rel_rmse}`);
  });
});

/** The winner of the geometric mean over cases, found here in another way. */
function winner() {
  const groups = new Map();
  for (const row of accuracy.filter((one) => one.region === "all" && !one.estimator.startsWith("oracle"))) {
    const key = `${row.estimator} ${row.k}`;
    groups.set(key, [...(groups.get(key) ?? []), row]);
  }
  const means = [...groups.values()].map((rows) => ({
    rows,
    rmse: rows.reduce((product, row) => product * row.rel_rmse, 1) ** (1 / rows.length),
  }));
  return means.reduce((a, b) => (b.rmse < a.rmse ? b : a));
}

test("the answer names the winner of the rows", async () => {
  const { rows, rmse } = winner();
  const data = await page.$eval("#answer", (element) => ({
    ...element.dataset,
    text: element.textContent,
    sentences: element.children.length,
  }));
  assert.equal(data.best, rows[0].estimator);
  assert.ok(Math.abs(Number(data.rmse) / rmse - 1) < 1e-12);
  assert.equal(data.sentences, 3);
  assert.match(data.text, new RegExp(`${rows[0].estimator.split(":")[0]} at k = ${rows[0].k}`));
});

test("the front: each estimator at its best, ties where intervals overlap", async () => {
  await choose(page, "front", "Case", "square");
  const rows = accuracy.filter((row) => row.case.startsWith("square") && row.region === "all");
  const shown = await tableOf(page, "front");
  const own = shown.filter((one) => !one.estimator.value.startsWith("oracle"));
  assert.equal(shown.length, new Set(rows.map((row) => row.estimator)).size);
  for (const one of shown) {
    const best = rows
      .filter((row) => row.estimator === one.estimator.value)
      .reduce((a, b) => (b.rel_rmse < a.rel_rmse ? b : a));
    same(one.rmse, best.rel_rmse);
    if (!one.estimator.value.startsWith("oracle")) same(one.cost, best.cost_s);
  }
  const [first, ...rest] = own.sort((a, b) => a.rmse.value - b.rmse.value);
  const ends = (one) => rows.find((row) => row.rel_rmse === one.rmse.value).rel_rmse_ci95;
  assert.equal(first.verdict.value, "least");
  for (const one of rest)
    assert.equal(one.verdict.value, ends(one)[0] <= ends(first)[1] ? "tie with the least" : "behind");
});

test("searches, storage, convergence, slopes, verdicts, errata: values equal the files'", async () => {
  const search = json("search.json");
  const shownSearch = await tableOf(page, "search-time");
  assert.equal(shownSearch.length, search.rows.length);
  search.rows.forEach((row, i) =>
    ["ns_per_query", "ratio", "build_ms", "bytes_per_photon", "exact"].forEach((key) =>
      same(shownSearch[i][key], row[key], key),
    ),
  );
  const storage = json("storage.json");
  const place = storage.rows.filter((row) => row.map === storage.rows[0].map);
  const shownStorage = await tableOf(page, "storage-front");
  place.forEach((row, i) =>
    ["stored", "total_s", "rel_rmse", "rel_added", "flux_ratio"].forEach((key) =>
      same(shownStorage[i][key], row[key], key),
    ),
  );
  const savings = await tableOf(page, "storage-saving");
  storage.fronts
    .filter((front) => front.map === storage.rows[0].map)
    .forEach((front, i) =>
      ["stored_ratio", "time_ratio", "rel_error", "status"].forEach((key) => same(savings[i][key], front[key], key)),
    );
  const converge = json("converge.json");
  const shownConverge = await tableOf(page, "converge");
  converge.rows.forEach((row, i) =>
    ["pass", "rel_rmse", "rel_noise", "predicted_rel_noise", "seconds"].forEach((key) =>
      same(shownConverge[i][key], row[key], key),
    ),
  );
  const slopes = await tableOf(page, "slopes");
  converge.fits.forEach((fit, i) =>
    ["slope", "slope_ci95", "predicted", "asymptote", "status"].forEach((key) => same(slopes[i][key], fit[key], key)),
  );
  const stress = json("stress.json").rows;
  for (const one of await tableOf(page, "stress")) {
    const rows = stress.filter((row) => row.test === one.test.value);
    same(one.passed, rows.filter((row) => row.status === "pass").length);
    same(one.failed, rows.filter((row) => row.status === "fail").length);
    same(
      one.share,
      Math.max(
        ...rows
          .filter((row) => row.bound > 0 || row.measured === 0)
          .map((row) => (row.bound ? row.measured / row.bound : 0)),
      ),
    );
  }
  if (hasReport()) return; // the program brings its own list
  const errata = json("errata.list.json");
  (await tableOf(page, "errata")).forEach((one, i) => same(one.size, errata[i].size));
});

test("where we lose: what can be found by hand is listed", async () => {
  const lines = (await tableOf(page, "losses")).map((one) => `${one.kind.text} ${one.who.text} ${one.what.text}`);
  const disc = accuracy.find(
    (row) =>
      row.case.startsWith("square") && row.region === "all" && row.k === 50 && row.estimator.startsWith("disc"),
  );
  const gaussian = accuracy.find(
    (row) => row.case === disc.case && row.region === "all" && row.k === 50 && row.estimator.startsWith("gaussian"),
  );
  assert.ok(gaussian.rel_rmse_ci95[0] > disc.rel_rmse_ci95[1]);
  assert.ok(
    lines.some((line) => /^simpler is better gaussian/.test(line)),
    lines.join("\n"),
  );
  for (const front of json("storage.json").fronts.filter((one) => one.status !== "ok"))
    assert.ok(lines.some((line) => line.startsWith("incomparable") && line.includes(front.detail)));
});

test("runs: machine, seed, version, flags, options", async () => {
  const [run] = await tableOf(page, "runs");
  const result = json(run.name.value);
  for (const key of ["version", "seed", "wall_s"]) same(run[key], result[key]);
  for (const key of ["cpu", "cores", "simd", "compiler", "flags"]) same(run[key], result.machine[key]);
  assert.match(await page.locator("footer").textContent(), /photonbench \d/);
  assert.equal(await page.locator("footer dl.options").count(), 6);
});

test("CSV: copied whole and unrounded; shown and selected where the clipboard is not to be had", async () => {
  const rows = json("converge.json").rows;
  await page.locator('[data-figure="converge"] button.copy').click();
  const csv = await page.evaluate(() => window.copied);
  const [head, ...lines] = csv.trim().split("\n");
  assert.equal(lines.length, rows.length);
  const column = head.split(",").indexOf("rel_rmse_low");
  assert.ok(column > 0, head);
  const fields = lines[0].replace(/"[^"]*"/g, "quoted").split(",");
  assert.equal(Number(fields[column]), rows[0].rel_rmse_ci95[0]);
  const without = await open(browser, file, { clipboard: "none" });
  await without.locator('[data-figure="converge"] button.copy').click();
  const area = without.locator('[data-figure="converge"] textarea');
  assert.ok(await area.isVisible());
  assert.equal(
    await area.evaluate((element) => element.value.slice(element.selectionStart, element.selectionEnd)),
    csv,
  );
  await without.close();
});

test("a legend's button takes a series out of the chart, and back", async () => {
  const dots = () => page.locator('[data-figure="by-k"] .panel:nth-child(1) g[aria-label="dot"] > *').count();
  const button = page.locator('[data-figure="by-k"] .legend button').first();
  const beforehand = await dots();
  await button.click();
  assert.ok((await dots()) < beforehand);
  assert.equal(await button.getAttribute("aria-pressed"), "false");
  await button.click();
  assert.equal(await dots(), beforehand);
});
