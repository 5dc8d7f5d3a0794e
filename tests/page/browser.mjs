// The browser, and pages in it: what they print, ask for and draw.
import { execFileSync } from "node:child_process";
import { existsSync } from "node:fs";
import { mkdtemp, readdir, rm, mkdir, writeFile } from "node:fs/promises";
import { createRequire } from "node:module";
import { tmpdir } from "node:os";
import path from "node:path";
import { fileURLToPath, pathToFileURL } from "node:url";
import { assemble, reportOf } from "./assemble.mjs";

const require = createRequire(new URL("../../reports/page/package.json", import.meta.url));
const { chromium } = require("playwright-core");

export const fixture = fileURLToPath(new URL("fixture", import.meta.url));
const root = fileURLToPath(new URL("../..", import.meta.url));

export async function launch() {
  const folder = await mkdtemp(path.join(tmpdir(), "pm-page-"));
  const context = await chromium.launchPersistentContext(path.join(folder, "profile"), {
    executablePath: process.env.CHROMIUM ?? "/usr/bin/chromium",
    args: [
      "--headless",
      "--no-sandbox",
      "--disable-gpu",
      "--no-first-run",
      "--disable-background-networking",
      "--disable-component-update",
      "--disable-sync",
    ],
    viewport: { width: 1200, height: 900 },
  });
  return {
    context,
    folder,
    close: async () => {
      await context.close();
      await rm(folder, { recursive: true, force: true });
    },
  };
}

/** A page from file://, with all that went wrong in `page.wrong`. */
export async function open(browser, file, { width = 1200, scheme = "light", clipboard = "kept" } = {}) {
  const page = await browser.context.newPage();
  page.wrong = [];
  page.on(
    "console",
    (message) => ["error", "warning"].includes(message.type()) && page.wrong.push(`console: ${message.text()}`),
  );
  page.on("pageerror", (error) => page.wrong.push(`error: ${error.stack}`));
  page.on(
    "request",
    (request) => /^(file|data|blob):/.test(request.url()) || page.wrong.push(`request: ${request.url()}`),
  );
  await page.addInitScript((mode) => {
    window.copied = null;
    const kept = {
      writeText: async (text) => {
        window.copied = text;
      },
    };
    Object.defineProperty(navigator, "clipboard", { value: mode === "kept" ? kept : undefined, configurable: true });
  }, clipboard);
  await page.setViewportSize({ width, height: 900 });
  await page.emulateMedia({ colorScheme: scheme });
  await page.goto(pathToFileURL(file).href);
  await page.waitForSelector("html[data-ready]", { state: "attached" });
  return page;
}

/** Every chart is drawn once it has been near the screen. */
export async function drawAll(page) {
  for (const figure of await page.locator("[data-figure]").all()) {
    await figure.scrollIntoViewIfNeeded();
    await figure.evaluate((element) => element.querySelector(".charts")?.scrollIntoView());
    await page.waitForFunction(
      (id) => {
        const figure = document.querySelector(`[data-figure="${id}"]`);
        return !figure.querySelector(".charts") || figure.dataset.drawn;
      },
      await figure.getAttribute("data-figure"),
    );
  }
}

const bench = path.join(root, process.env.PM_BUILD ?? "build", "photonbench");
let known = null;
/** `photonbench report`, where the program that is built has it. */
export function hasReport() {
  known ??=
    existsSync(bench) &&
    execFileSync(bench, ["help"], { encoding: "utf8" })
      .split("\n")
      .some((line) => /^\s+report\b/.test(line));
  return known;
}

/** The fixture's page: by the program where it can, else put together here. only: the result files that it gets. */
export async function makePage(browser, name, { only = null, images = true } = {}) {
  const folder = path.join(browser.folder, name);
  await mkdir(folder, { recursive: true });
  const file = path.join(folder, "index.html");
  if (hasReport()) {
    const names = await readdir(fixture);
    const inputs = names.filter((one) =>
      one.endsWith(".exr")
        ? images
        : one.endsWith(".json") && !one.endsWith(".list.json") && (!only || only.includes(one)),
    );
    execFileSync(bench, ["report", ...inputs.map((one) => path.join(fixture, one)), "-o", folder, "--quiet"]);
    return file;
  }
  const report = await reportOf(fixture, { only });
  if (!images) report.images = [];
  await assemble(report, file);
  return file;
}

export async function makeFrom(browser, name, report) {
  const folder = path.join(browser.folder, name);
  await mkdir(folder, { recursive: true });
  await assemble(report, path.join(folder, "index.html"));
  return path.join(folder, "index.html");
}

/** Images of a scene beside the page, as scripts. */
export async function putBeside(folder, image) {
  await mkdir(path.join(folder, "images"), { recursive: true });
  const href = `images/${image.file}.js`;
  await writeFile(path.join(folder, href), `window.pmImage(${JSON.stringify(image.file)},"${image.exr}");\n`);
  return { ...image, exr: null, href };
}

/** Rows of a figure's table as it stands: [{key: {value, text}}]; a key that stands twice has its second as key_2. */
export async function tableOf(page, id) {
  const figure = page.locator(`[data-figure="${id}"]`);
  await figure.evaluate((element) => {
    element.querySelector("details.values").open = true;
  });
  await figure.locator("tbody").first().waitFor({ state: "attached" });
  return figure
    .locator("details.values")
    .evaluate((details) =>
      [...details.querySelectorAll("tbody tr")].map((row) =>
        Object.fromEntries(
          [...row.children].map((cell) => [
            cell.dataset.key,
            { value: JSON.parse(cell.dataset.value), text: cell.textContent },
          ]),
        ),
      ),
    );
}

export const choose = (page, id, label, option) =>
  page.locator(`[data-figure="${id}"] select[aria-label="${label}"]`).selectOption({ label: option });
