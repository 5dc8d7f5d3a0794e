// Bundles src/ into dist/page.html: one file, script and style within it, one line that the program replaces by data.
import { build } from "esbuild";
import { mkdir, readdir, readFile, writeFile } from "node:fs/promises";

const here = new URL(".", import.meta.url);
const common = { bundle: true, minify: true, write: false, metafile: true, legalComments: "none", logLevel: "warning" };
const packages = new Set();

async function bundle(entry, options) {
  const result = await build({ ...common, ...options, entryPoints: [new URL(entry, here).pathname] });
  for (const input of Object.keys(result.metafile.inputs)) {
    const found = /node_modules\/((?:@[^/]+\/)?[^/]+)/.exec(input);
    if (found) packages.add(found[1]);
  }
  return result.outputFiles[0].text.trim();
}

// What is bundled asks that its licence goes along: each text once, after the names of the packages it is of.
async function licences() {
  const texts = new Map();
  for (const name of [...packages].sort()) {
    const folder = new URL(`node_modules/${name}/`, here);
    const file = (await readdir(folder)).find((one) => /^(licen[cs]e|copying)/i.test(one));
    if (!file) throw new Error(`${name} has no licence file`);
    const text = (await readFile(new URL(file, folder), "utf8")).trim().replaceAll("--", "- -");
    texts.set(text, [...(texts.get(text) || []), name]);
  }
  return [...texts].map(([text, names]) => `${names.join(", ")}:\n\n${text}`).join("\n\n");
}

const script = await bundle("src/main.js", { format: "iife", target: "es2020" });
const style = await bundle("src/style.css", {});
const template = await readFile(new URL("src/page.html", here), "utf8");
// Neither may end its own element early; functions, because `$` means something in a replacement text.
const safe = script.replaceAll("</script", "<\\/script").replaceAll("<!--", "<\\!--");
const page = template.replace("/*STYLE*/", () => style).replace("/*SCRIPT*/", () => safe)
  .trimEnd() + `\n<!--\nParts of the script are others' work.\n\n${await licences()}\n-->\n`;
const places = page.split("\n").filter((line) => line === "<!--PM-DATA-->").length;
if (places !== 1) throw new Error(`the page has ${places} lines for the data, not one`);
await mkdir(new URL("dist", here), { recursive: true });
await writeFile(new URL("dist/page.html", here), page);
console.log(`dist/page.html: ${Math.round(page.length / 1000)} kB`);
