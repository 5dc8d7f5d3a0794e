// Pages with parts missing, with data that are wrong, of many rows, on a telephone, in the dark, and read aloud.
import assert from "node:assert/strict";
import { readFileSync } from "node:fs";
import { after, before, test } from "node:test";
import { reportOf } from "./assemble.mjs";
import { drawAll, fixture, hasReport, launch, makeFrom, makePage, open } from "./browser.mjs";

let browser;
before(async () => {
  browser = await launch();
});
after(() => browser?.close());
const missing = (page) => page.$$eval(".missing", (all) => all.map((one) => one.textContent));

test("what is missing is said, with the command that makes it", async () => {
  const page = await open(
    browser,
    await makePage(browser, "accuracy-only", { only: ["accuracy.json"], images: false }),
  );
  await drawAll(page);
  const said = (await missing(page)).join("\n");
  for (const command of ["search", "storage", "converge", "stress", "render"])
    assert.match(said, new RegExp(`To make it: .*photonbench ${command}`), said);
  assert.ok(!/photonbench accuracy/.test(said), said);
  if (hasReport()) assert.ok(await page.locator(".missing-list").count());
  assert.deepEqual(page.wrong, []);
  await page.close();
  const without = await open(
    browser,
    await makePage(browser, "stress-only", { only: ["stress.json"], images: false }),
  );
  assert.match((await missing(without)).join("\n"), /the answer and the front.*photonbench accuracy/);
  assert.deepEqual(without.wrong, []);
  await without.close();
});

test("a page without data, or with data cut short, says so", async () => {
  for (const [name, data, said] of [
    ["empty", "{}", /result files: there is not one/],
    ["cut", '{"files": [', /cannot be read/],
    ["list", "[]", /there is not one/],
  ]) {
    const page = await open(browser, await makeFrom(browser, name, data));
    assert.match((await missing(page)).join("\n"), said);
    assert.deepEqual(page.wrong, []);
    await page.close();
  }
});

/** Every field of every row, in turn, absent or null or of another type. */
function spoil(report) {
  const wrongs = [null, undefined, "text", -1, 0, [], {}, [null, 1], 1e300, "</script><b>"];
  let next = 0;
  for (const file of report.files)
    for (const part of ["rows", "fits", "fronts"])
      for (const row of file.result[part] ?? []) {
        const keys = Object.keys(row);
        row[keys[next % keys.length]] = wrongs[next % wrongs.length];
        next++;
      }
}

test("rows with wrong or missing fields, unknown commands, no machine: nothing throws", async () => {
  const report = await reportOf(fixture);
  spoil(report);
  report.files[0].result.machine = null;
  report.files[1].result.options = "none";
  report.files.push(
    { name: "x.json", result: { command: "levitate", rows: [{ height: 3, what: "<i>" }, null, 7] } },
    { name: "y.json" },
    null,
    { result: { command: "speed", rows: "none" } },
  );
  report.images.push(
    {},
    { kind: "image", scene: "odd", exr: "AAAA" },
    { kind: "image", scene: "odd", exr: "?" },
    { kind: "truth", scene: "odd" },
  );
  const page = await open(browser, await makeFrom(browser, "spoilt", report));
  await drawAll(page);
  assert.deepEqual(
    (await missing(page)).filter((line) => /cannot be/.test(line)),
    [],
  );
  assert.match(await page.locator("#other").textContent(), /levitate/);
  assert.equal(await page.locator("main b:has-text('</script>'), main i").count(), 0);
  assert.deepEqual(page.wrong, []);
  await page.close();
});

test("failures are shown: a failed verdict, an inexact search, a peer that is faster", async () => {
  const report = await reportOf(fixture);
  const rows = (command) => report.files.find((file) => file.result.command === command).result.rows;
  Object.assign(rows("stress")[0], { status: "fail", measured: 50, bound: 5 });
  Object.assign(rows("search")[0], { exact: false, status: "inexact", detail: "photon 7 is not photon 9" });
  rows("search").push({ ...rows("search")[1], search: "nanoflann", ns_per_query: 1, ns_per_query_ci95: [0.9, 1.1] });
  const page = await open(browser, await makeFrom(browser, "failing", report));
  await drawAll(page);
  const lost = await page.locator("#losses").textContent();
  for (const said of ["verdict failed", "photon 7 is not photon 9", "peer is faster", "of nanoflann"])
    assert.ok(lost.includes(said), said);
  assert.ok(await page.locator("#stress-failed").count());
  assert.match(await page.locator("#stress .charts svg").getAttribute("aria-label"), /1 of .* rows fail/);
  await page.close();
});

test("two files of one command are both shown, and told apart", async () => {
  const report = await reportOf(fixture, { only: ["accuracy.json", "search.json"] });
  for (const file of [...report.files])
    report.files.push({ name: `second-${file.name}`, result: structuredClone(file.result) });
  const page = await open(browser, await makeFrom(browser, "twice", report));
  await drawAll(page);
  const cases = await page.locator('[data-figure="by-k"] select[aria-label="Case"] option').allTextContents();
  assert.ok(
    cases.some((name) => name.includes("(second-accuracy.json)")),
    cases.join(),
  );
  assert.deepEqual(page.wrong, []);
  await page.close();
});

test("a full run's number of rows opens within two seconds", async () => {
  const report = await reportOf(fixture);
  const file = report.files.find((one) => one.result.command === "accuracy");
  const own = file.result.rows;
  for (let i = 0; i < 60; i++)
    file.result.rows = file.result.rows.concat(
      own.map((row) => ({ ...row, case: row.case.replace(/^\w+/, `$&-${i}`) })),
    );
  assert.ok(file.result.rows.length > 3000);
  const made = await makeFrom(browser, "large", report);
  let best = Infinity;
  for (let i = 0; i < 3; i++) {
    const began = performance.now();
    const page = await open(browser, made);
    best = Math.min(best, performance.now() - began);
    await page.close();
  }
  assert.ok(best < 2000, `${best} ms`);
});

test("at a telephone's width nothing scrolls sideways but tables in their frames", async () => {
  const page = await open(browser, await makePage(browser, "whole"), { width: 360 });
  await drawAll(page);
  for (const details of await page.locator("details").all())
    await details.evaluate((element) => {
      element.open = true;
    });
  await page.locator("#comparer").focus();
  for (const key of ["c", "?", "w"]) await page.keyboard.press(key);
  const widths = await page.evaluate(() => [document.documentElement.scrollWidth, document.body.scrollWidth]);
  assert.deepEqual(widths, [360, 360]);
  const labels = await page.$$eval("[data-figure='front'] .charts svg text", (all) =>
    all.filter((text) => text.getBoundingClientRect().right > 361).map((text) => text.textContent),
  );
  assert.deepEqual(labels, []);
  assert.deepEqual(page.wrong, []);
  await page.close();
});

const contrast = (a, b) => {
  const light = (text) => {
    const [r, g, b] = text
      .match(/[\d.]+/g)
      .map((v) => v / 255)
      .map((v) => (v <= 0.04045 ? v / 12.92 : ((v + 0.055) / 1.055) ** 2.4));
    return 0.2126 * r + 0.7152 * g + 0.0722 * b;
  };
  const [high, low] = [light(a), light(b)].sort((x, y) => y - x);
  return (high + 0.05) / (low + 0.05);
};

test("dark mode is another page, as readable", async () => {
  const file = await makePage(browser, "whole");
  const seen = {};
  for (const scheme of ["light", "dark"]) {
    const page = await open(browser, file, { scheme });
    await drawAll(page);
    seen[scheme] = await page.evaluate(() => {
      const style = (selector) => getComputedStyle(document.querySelector(selector));
      return {
        back: style("body").backgroundColor,
        ink: style("body").color,
        soft: style(".formula").color,
        mark: getComputedStyle(document.querySelector('#by-k g[aria-label="dot"] path')).fill,
      };
    });
    await page.close();
  }
  assert.notEqual(seen.light.back, seen.dark.back);
  assert.notEqual(seen.light.mark, seen.dark.mark);
  for (const { back, ink, soft, mark } of Object.values(seen)) {
    assert.ok(contrast(back, ink) > 7 && contrast(back, soft) > 4.5, `${back} ${ink} ${soft}`);
    assert.ok(contrast(back, mark) > 3, `${back} ${mark}`);
  }
});

test("read aloud: one h1, headings in order, names for all that can be operated", async () => {
  const page = await open(browser, await makePage(browser, "whole"));
  await drawAll(page);
  const levels = await page.$$eval("h1, h2, h3, h4", (all) => all.map((one) => Number(one.tagName[1])));
  assert.equal(levels.filter((level) => level === 1).length, 1);
  levels.forEach((level, i) => assert.ok(!i || level <= levels[i - 1] + 1, `heading ${i}`));
  const nameless = await page.$$eval(
    "button, select, input, textarea, [role=img], [role=region], [role=application]",
    (all) =>
      all
        .filter((one) => !(one.getAttribute("aria-label") || one.textContent.trim()))
        .map((one) => one.outerHTML.slice(0, 80)),
  );
  assert.deepEqual(nameless, []);
  const ids = await page.$$eval("[id]", (all) => all.map((one) => one.id));
  assert.equal(new Set(ids).size, ids.length, "an id stands twice");
  assert.ok((await page.locator("table caption").count()) > 3);
  await page.keyboard.press("Tab");
  assert.match(await page.evaluate(() => document.activeElement.textContent), /Skip/);
  await page.close();
});

test("the template is small and holds one line for the data", () => {
  const template = readFileSync(new URL("../../reports/page/dist/page.html", import.meta.url), "utf8");
  assert.equal(template.split("\n").filter((line) => line === "<!--PM-DATA-->").length, 1);
  assert.ok(template.length < 600e3, `${template.length} bytes`);
  assert.ok(!/https?:\/\/(?!www\.w3\.org)[^"'`\s]*\.(js|css|woff)/.test(template), "an address of something to load");
});
