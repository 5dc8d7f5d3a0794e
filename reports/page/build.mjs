// Bundles src/ into dist/page.html: one file, script and style within it, one line that the program replaces by data.
import { build } from "esbuild";
import { mkdir, readFile, writeFile } from "node:fs/promises";

const here = new URL(".", import.meta.url);
const common = { bundle: true, minify: true, write: false, legalComments: "none", logLevel: "warning" };

async function bundle(entry, options) {
  const result = await build({ ...common, ...options, entryPoints: [new URL(entry, here).pathname] });
  return result.outputFiles[0].text.trim();
}

const script = await bundle("src/main.js", { format: "iife", target: "es2020" });
const style = await bundle("src/style.css", {});
const template = await readFile(new URL("src/page.html", here), "utf8");
// Neither may end its own element early; functions, because `$` means something in a replacement text.
const safe = script.replaceAll("</script", "<\\/script").replaceAll("<!--", "<\\!--");
const page = template.replace("/*STYLE*/", () => style).replace("/*SCRIPT*/", () => safe);
const places = page.split("\n").filter((line) => line === "<!--PM-DATA-->").length;
if (places !== 1) throw new Error(`the page has ${places} lines for the data, not one`);
await mkdir(new URL("dist", here), { recursive: true });
await writeFile(new URL("dist/page.html", here), page);
console.log(`dist/page.html: ${Math.round(page.length / 1000)} kB`);
