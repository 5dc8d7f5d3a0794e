// Errors of the images, computed in the page from the pixels that it shows.
import { isNumber, percent, plural, signedPercent } from "../base/format.js";
import { least } from "../base/compare.js";
import { linearAxis } from "../chart/plot.js";
import { rowChart } from "../chart/rows.js";
import { figure, missing } from "../figure.js";
import { signedError } from "./scenes.js";
import { decodeExr, fromBase64 } from "./exr.js";

function pixelsNow(image) {
  if (!image.pixels && image.exr) image.pixels = decodeExr(fromBase64(image.exr));
  return image.pixels ?? null;
}

function errorsOf(scene) {
  if (scene.rows) return scene.rows;
  const truth = scene.truth && pixelsNow(scene.truth);
  const rows = scene.images.map((image, index) => {
    const pixels = pixelsNow(image);
    const error = truth && pixels ? signedError(pixels, truth) : null;
    const why = !scene.truth
      ? "no truth of this scene"
      : !pixels
        ? "beside the page: choose the scene in the comparer first"
        : error
          ? null
          : "the truth has another size";
    return {
      index,
      label: image.label ?? image.name,
      mean: error?.mean ?? null,
      rms: error?.rms ?? null,
      width: image.width ?? null,
      height: image.height ?? null,
      file: image.file ?? null,
      why,
    };
  });
  if (rows.every((row) => isNumber(row.rms))) scene.rows = rows;
  return rows;
}

export function errorFigure(scenes, names) {
  const judged = scenes.filter((scene) => scene.truth && scene.images.length);
  if (!judged.length)
    return missing(
      "errors of images: no scene has both an image and a truth",
      "photonbench render cornell --size 128x128 --estimator disc,cone,hull --aov --half -o cornell.exr",
    );
  const options = judged.map((scene) => ({ value: scene, label: names.short(scene.scene) }));
  return figure({
    id: "image-errors",
    title: "Errors of the images",
    controls: [{ key: "scene", label: "Scene", options, value: judged[0] }],
    draw: (width, state) => {
      const items = errorsOf(state.scene)
        .filter((row) => isNumber(row.rms))
        .map((row) => ({
          name: row.label,
          index: row.index,
          value: row.rms,
          title: `${row.label}: RMS ${percent(row.rms)}, mean ${signedPercent(row.mean)}`,
        }));
      return items.length
        ? [
            {
              node: rowChart(width, items, {
                bars: true,
                x: linearAxis(
                  "RMS error, % of mean truth →",
                  items.map((item) => 100 * item.value),
                ),
                scale: 100,
              }),
            },
          ]
        : [];
    },
    rows: (state) => errorsOf(state.scene),
    columns: [
      { key: "label", label: "Image" },
      { key: "mean", label: "Mean error", format: signedPercent },
      { key: "rms", label: "RMS error", format: percent },
      { key: "width", label: "Width" },
      { key: "height", label: "Height" },
      { key: "file", label: "File" },
      { key: "why", label: "Why not" },
    ],
    summary: (state) => {
      const rows = errorsOf(state.scene);
      const best = least(rows, (row) => row.rms);
      return best
        ? `${names.short(state.scene.scene)}: of ${plural(rows.length, "image")} ${best.label} is nearest to ` +
            `the truth, RMS ${percent(best.rms)}, mean ${signedPercent(best.mean)}.`
        : `${names.short(state.scene.scene)}: no errors: ${rows[0]?.why ?? "no images"}.`;
    },
    formula:
      "signed error = (image − truth) / mean of truth, pixel by pixel and band by band; here its mean and " +
      "the root of its mean square over all pixels and bands that are known, computed by this page from " +
      "the pixels that it holds (half precision).",
    plusminus:
      "none: one photon map a picture. The next map gives another picture; the sections below have intervals.",
  });
}
