// Puts data into the page's template as `photonbench report` does: node assemble.mjs FOLDER OUT.html
// FOLDER holds result files (*.json), images (*.exr) with images.list.json (what they show), and errata.list.json.
import { readFile, readdir, writeFile } from "node:fs/promises";
import path from "node:path";

const template = new URL("../../reports/page/dist/page.html", import.meta.url);

async function optional(file, otherwise) {
  try {
    return JSON.parse(await readFile(file, "utf8"));
  } catch (error) {
    if (error.code === "ENOENT") return otherwise;
    throw error;
  }
}

export async function reportOf(folder, { only = null } = {}) {
  const names = (await readdir(folder)).filter((name) => name.endsWith(".json") && !name.endsWith(".list.json"));
  const files = [];
  for (const name of names.filter((one) => !only || only.includes(one)).sort())
    files.push({ name, result: JSON.parse(await readFile(path.join(folder, name), "utf8")) });
  const images = await optional(path.join(folder, "images.list.json"), []);
  for (const image of images) image.exr = (await readFile(path.join(folder, image.file))).toString("base64");
  return {
    schema: "photonbench-report/1",
    version: "0.1.0",
    commit: null,
    date: "2026-11-24T00:00:00Z",
    files,
    images,
    errata: await optional(path.join(folder, "errata.list.json"), []),
    missing: await optional(path.join(folder, "missing.list.json"), []),
  };
}

/** The template's one placeholder line becomes the data, in which no `<` is left. */
export async function assemble(report, out) {
  const page = await readFile(template, "utf8");
  const json = typeof report === "string" ? report : JSON.stringify(report);
  const element = `<script type="application/json" id="pm-report">${json.replaceAll("<", "\\u003c")}</script>`;
  const lines = page.split("\n");
  const place = lines.indexOf("<!--PM-DATA-->");
  if (place < 0 || lines.lastIndexOf("<!--PM-DATA-->") !== place)
    throw new Error("the template needs one line for the data");
  lines[place] = element;
  await writeFile(out, lines.join("\n"));
}

if (process.argv[1] === new URL(import.meta.url).pathname) {
  const [folder, out] = process.argv.slice(2);
  await assemble(await reportOf(folder), out);
}
