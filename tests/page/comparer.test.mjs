// The image comparer: every key does its work, numbers are those of the files, and it works beside the page too.
import assert from "node:assert/strict";
import { createHash } from "node:crypto";
import { readFileSync } from "node:fs";
import path from "node:path";
import { after, before, test } from "node:test";
import { decodeExr } from "../../reports/page/src/comparer/exr.js";
import { reportOf } from "./assemble.mjs";
import { fixture, launch, makeFrom, makePage, open, putBeside, tableOf } from "./browser.mjs";

const render = JSON.parse(readFileSync(path.join(fixture, "render.json"), "utf8")).rows;
let browser;
let page;
before(async () => {
  browser = await launch();
  page = await open(browser, await makePage(browser, "whole"));
  await enter(page);
  await chooseScene(page, "glass-sphere");
});
after(() => browser?.close());

async function enter(one) {
  await one.locator("#comparer").scrollIntoViewIfNeeded();
  await one.waitForSelector("#comparer[data-ready]");
}
async function chooseScene(one, name) {
  const list = one.locator('#comparer select[aria-label="Scene"]');
  const labels = await list.locator("option").allTextContents();
  await list.selectOption({ label: labels.find((label) => label.includes(name)) });
  await one.waitForFunction((scene) => document.querySelector("#comparer").dataset.scene.includes(scene), name);
  await one.locator("#comparer").focus();
}
const state = () => page.$eval("#comparer", (element) => ({ ...element.dataset }));
const picture = async () =>
  createHash("sha1")
    .update(await page.$eval("#comparer .picture > canvas", (canvas) => canvas.toDataURL()))
    .digest("hex");
const live = () => page.locator("#comparer .live").textContent();

/** Presses keys, and gives the states and pictures before and after. */
async function press(...keys) {
  const before = { ...(await state()), picture: await picture() };
  for (const key of keys) await page.keyboard.press(key);
  return { before, after: { ...(await state()), picture: await picture() } };
}
const changes = ({ before, after }, what) =>
  assert.notEqual(after.picture, before.picture, `${what}: the picture is the same`);

test("it is reached by the keyboard, named, and says its keys", async () => {
  const one = page.locator("#comparer");
  assert.equal(await one.getAttribute("tabindex"), "0");
  assert.match(await one.getAttribute("aria-label"), /Image comparer/);
  assert.equal(await page.evaluate(() => document.activeElement.id), "comparer");
  await press("?");
  assert.ok(await page.locator("#comparer .keys").isVisible());
  await press("?");
  assert.ok(!(await page.locator("#comparer .keys").isVisible()));
});

test("number keys show estimators, truth and signed errors; it is said aloud", async () => {
  const labels = await page.$$eval("#comparer .views button", (all) =>
    all.map((one) => one.textContent.replace(/^\d\s*/, "").trim()),
  );
  assert.ok(labels.length >= 7);
  const seen = new Set();
  for (let i = Math.min(9, labels.length); i >= 1; i--) {
    await page.keyboard.press(String(i));
    assert.equal((await state()).view, labels[i - 1]);
    assert.match(await live(), new RegExp(labels[i - 1].slice(0, 8).replace(/[()]/g, ".")));
    assert.match(await page.locator("#comparer canvas").first().getAttribute("aria-label"), /glass-sphere/);
    seen.add(await picture());
  }
  assert.equal(seen.size, Math.min(9, labels.length), "two views look the same");
});

test("t, d, full stop and comma", async () => {
  await press("1");
  const truth = await press("t");
  assert.equal(truth.after.kind, "truth");
  changes(truth, "t");
  await press("1");
  assert.equal((await press("0")).after.kind, "truth");
  await press("1");
  const error = await press("d");
  assert.equal(error.after.kind, "error");
  changes(error, "d");
  assert.equal((await press("d")).after.view, error.before.view);
  const next = await press(".");
  changes(next, ".");
  assert.equal((await press(",")).after.view, next.before.view);
});

test("wipe, its line, and swap", async () => {
  await press("r", "1", "t", "1");
  const wipe = await press("w");
  assert.equal(wipe.after.wipe, "true");
  changes(wipe, "w");
  const moved = await press("Shift+ArrowRight");
  assert.ok(Number(moved.after.wipeAt) > Number(moved.before.wipeAt));
  changes(moved, "Shift + right");
  assert.ok(Number((await press("Shift+ArrowLeft", "Shift+ArrowLeft")).after.wipeAt) < Number(moved.after.wipeAt));
  const swap = await press("x");
  assert.equal(swap.after.view, swap.before.other);
  assert.equal(swap.after.other, swap.before.view);
  changes(swap, "x");
  assert.equal((await press("w")).after.wipe, "false");
});

test("zoom and pan, the same for all views", async () => {
  await press("r", "1");
  const zoom = await press("+", "=");
  assert.equal(zoom.after.zoom, "4");
  changes(zoom, "+");
  for (const [key, field, sign] of [
    ["ArrowRight", "x", 1],
    ["ArrowLeft", "x", -1],
    ["ArrowDown", "y", 1],
    ["ArrowUp", "y", -1],
  ]) {
    const pan = await press(key);
    assert.ok(sign * (Number(pan.after[field]) - Number(pan.before[field])) > 0, key);
    changes(pan, key);
  }
  const other = await press("2");
  for (const field of ["zoom", "x", "y"]) assert.equal(other.after[field], other.before[field]);
  assert.equal((await press("-")).after.zoom, "2");
  const canvas = page.locator("#comparer .picture > canvas");
  await canvas.hover();
  const beforehand = await state();
  await page.mouse.wheel(0, -300);
  assert.ok(Number((await state()).zoom) > Number(beforehand.zoom));
  const box = await canvas.boundingBox();
  await page.mouse.move(box.x + box.width / 2, box.y + box.height / 2);
  await page.mouse.down();
  await page.mouse.move(box.x + box.width / 2 - 60, box.y + box.height / 2, { steps: 4 });
  await page.mouse.up();
  assert.ok(Number((await state()).x) > Number(beforehand.x), "dragging pans");
});

test("exposure, false colour and crops; scales follow", async () => {
  await press("r", "1");
  const ticks = () => page.locator("#comparer .ticks").textContent();
  const scale = await ticks();
  for (const [key, step] of [
    ["e", 0.5],
    ["]", 0.5],
    ["E", -0.5],
    ["[", -0.5],
  ]) {
    const done = await press(key);
    assert.equal(Number(done.after.exposure) - Number(done.before.exposure), step, key);
    changes(done, key);
  }
  assert.equal(await ticks(), scale);
  await press("e", "e");
  assert.notEqual(await ticks(), scale);
  const colours = await press("f");
  assert.equal(colours.after.falseColour, "true");
  changes(colours, "f");
  const crops = await press("c");
  assert.equal(crops.after.crops, "true");
  assert.equal(
    await page.locator("#comparer .crop canvas").count(),
    await page.locator("#comparer .views button").count(),
  );
  await press("c");
  assert.ok(!(await page.locator("#comparer .crops").isVisible()));
  const reset = await press("r");
  assert.deepEqual([reset.after.exposure, reset.after.falseColour, reset.after.zoom], ["0", "false", "1"]);
});

const readings = () =>
  page.$$eval("#comparer .readout tbody tr", (rows) =>
    rows.map((row) => ({
      what: row.children[0].textContent,
      values: [...row.querySelectorAll("[data-value]")].map((cell) => JSON.parse(cell.dataset.value)),
    })),
  );

test("the cursor reads pixels, which fit together", async () => {
  await press("r", "1", "l");
  const [x, y] = (await state()).cursor.split(",").map(Number);
  for (const [key, dx, dy] of [
    ["l", 1, 0],
    ["k", 0, 1],
    ["j", -1, 0],
    ["i", 0, -1],
    ["Shift+L", 10, 0],
    ["Shift+K", 0, 10],
  ]) {
    const { before, after } = await press(key);
    const [from, to] = [before, after].map((one) => one.cursor.split(",").map(Number));
    assert.deepEqual([to[0] - from[0], to[1] - from[1]], [dx, dy], key);
  }
  assert.ok(x >= 0 && y >= 0);
  assert.match(await live(), /^Pixel \d+, \d+: /);
  const [image, truth, error] = await readings();
  assert.ok(image.values.every((value) => value > 0) || truth.values.every((value) => value !== null));
  image.values.forEach((value, band) => {
    if (value === truth.values[band]) assert.equal(error.values[band], 0);
    else assert.equal(Math.sign(error.values[band]), Math.sign(value - truth.values[band]));
  });
});

test("the page's signed errors are those that `render` measured", async () => {
  await page.locator('[data-figure="image-errors"]').scrollIntoViewIfNeeded();
  const list = page.locator('[data-figure="image-errors"] select');
  if (await list.count())
    await list.selectOption({
      label: (await list.locator("option").allTextContents()).find((label) => label.includes("glass-sphere")),
    });
  const shown = await tableOf(page, "image-errors");
  const own = shown.filter((one) => one.rms.value !== null);
  assert.equal(own.length, render.length);
  for (const one of own) {
    const row = render.find((other) => one.label.text.startsWith(other.estimator.split(":")[0]));
    // Images are in half precision, 11 bits: 2^-12 of each value, relative to errors of a tenth or more.
    assert.ok(Math.abs(one.rms.value / row.rel_error_rms - 1) < 2e-3, `${one.rms.value} for ${row.rel_error_rms}`);
    assert.ok(Math.abs(one.mean.value - row.rel_error_mean) < 5e-4, `${one.mean.value} for ${row.rel_error_mean}`);
  }
  await page.locator("#comparer").focus();
});

test("and pixel by pixel, where the file of errors is given too", async (t) => {
  const labels = await page.$$eval("#comparer .views button", (all) =>
    all.map((one) => one.textContent.replace(/^\d\s*/, "").trim()),
  );
  const ours = labels.findIndex((label) => label.startsWith("error of disc"));
  const theirs = labels.findLastIndex((label) => label.startsWith("error of disc"));
  if (ours === theirs) return t.skip("the report leaves it out");
  await press("r", "1", "Shift+K", "Shift+K");
  const { data } = decodeExr(readFileSync(path.join(fixture, "glass.glass-sphere.disc.truth.exr")));
  const mean = data.reduce((sum, value) => sum + value, 0) / data.length;
  for (let i = 0; i < 5; i++) {
    await page.keyboard.press("j");
    const rows = [];
    for (const at of [ours, theirs]) {
      await page.locator("#comparer .views button").nth(at).click();
      rows.push(await readings());
    }
    const [[mine, truth, image], [file]] = rows.map((all) => all.map((row) => row.values));
    mine.forEach((value, band) => {
      // Each of the two pixels is off by 2^-12 of itself at most, and so is the file; over the mean truth.
      const bound = 2 ** -11 * ((image[band] + truth[band]) / mean + Math.abs(value));
      assert.ok(value === file[band] || Math.abs(value - file[band]) <= bound, JSON.stringify(rows));
    });
    await page.locator("#comparer").focus();
  }
  return undefined;
});

test("a scene without a truth says so", async () => {
  await chooseScene(page, "cornell");
  assert.match(await page.locator("#comparer .problems").textContent(), /no truth/);
  await press("1", "d");
  assert.match(await live(), /no signed error/);
  await press("t");
  assert.deepEqual(page.wrong, []);
});

test("every button does what its key does", async () => {
  await chooseScene(page, "glass-sphere");
  for (const tool of await page.locator("#comparer .tools button").all()) {
    await page.locator("#comparer").focus();
    const { after: before } = await press("1", "2");
    const keysWereShown = await page.locator("#comparer .keys").isVisible();
    await tool.click();
    const now = { ...(await state()), picture: await picture() };
    const name = await tool.getAttribute("data-tool");
    if (name === "Keys") assert.notEqual(await page.locator("#comparer .keys").isVisible(), keysWereShown);
    else assert.notDeepEqual(now, before, name);
  }
  assert.deepEqual(page.wrong, []);
});

test("images beside the page are loaded when their scene is chosen, and said where they are missing", async () => {
  const report = await reportOf(fixture, { only: [] });
  const folder = path.join(browser.folder, "beside");
  await makeFrom(browser, "beside", report);
  const [first, second] = [
    report.images.filter((image) => image.scene === "scene:glass-sphere"),
    report.images.filter((image) => image.scene === "scene:cornell"),
  ];
  const moved = [await putBeside(folder, second[0]), { ...second[1], exr: null, href: "images/not-there.js" }];
  const beside = await open(browser, await makeFrom(browser, "beside", { ...report, images: [...first, ...moved] }));
  await enter(beside);
  await chooseScene(beside, "cornell");
  await beside.waitForFunction(() => document.querySelector("#comparer").dataset.view);
  assert.equal(await beside.$eval("#comparer", (element) => element.dataset.view), second[0].label);
  assert.match(await beside.locator("#comparer .problems").textContent(), /not beside the page/);
  assert.deepEqual(
    beside.wrong.filter((line) => !line.includes("ERR_FILE_NOT_FOUND")),
    [],
  );
  await beside.close();
});
