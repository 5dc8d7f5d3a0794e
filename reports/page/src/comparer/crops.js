// Crops: the same few pixels of every view beside each other.
import { h } from "../base/dom.js";
import { percent, significant } from "../base/format.js";
import { scalarAt } from "./scenes.js";

const across = 25;

/** Figures of every view about the cursor (or the middle). bitmapOf(view) is its picture as it is shown now. */
export function cropStrip(views, cursor, bitmapOf) {
  return views.map((view, i) => {
    const canvas = h("canvas", {
      width: across * 6,
      height: across * 6,
      role: "img",
      "aria-label": `Crop of ${view.label}`,
    });
    const { width, height } = view.pixels;
    const at = cursor ?? { x: width >> 1, y: height >> 1 };
    const left = Math.max(0, Math.min(width - across, at.x - (across >> 1)));
    const top = Math.max(0, Math.min(height - across, at.y - (across >> 1)));
    const context = canvas.getContext("2d");
    context.imageSmoothingEnabled = false;
    context.drawImage(bitmapOf(view), left, top, across, across, 0, 0, canvas.width, canvas.height);
    return h(
      "figure.crop",
      {},
      canvas,
      h("figcaption", {}, `${i + 1}. ${view.label}`, h("br"), meanText(view, left, top)),
    );
  });
}

function meanText(view, left, top) {
  let [sum, count] = [0, 0];
  for (let y = top; y < Math.min(view.pixels.height, top + across); y++)
    for (let x = left; x < Math.min(view.pixels.width, left + across); x++) {
      const value = scalarAt(view, y * view.pixels.width + x);
      if (!Number.isFinite(value)) continue;
      sum += value;
      count++;
    }
  if (!count) return "unknown";
  return `mean ${view.show === "signed" || view.kind === "noise" ? percent(sum / count) : significant(sum / count)}`;
}
