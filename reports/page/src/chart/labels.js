// Names at the right edge of a chart, joined to their marks by thin lines, never over one another.
import { svg } from "../base/dom.js";

/** marks: [{x, y, text, colour}] in pixels; they are put between top and bottom, `gap` apart at least. */
export function edgeLabels(chart, marks, { left, top, bottom, gap = 15 }) {
  const sorted = [...marks].sort((a, b) => a.y - b.y);
  const places = sorted.map((mark) => mark.y);
  for (let i = 0; i < places.length; i++) places[i] = Math.max(places[i], i ? places[i - 1] + gap : top);
  const over = places.length ? places[places.length - 1] - bottom : 0;
  if (over > 0) {
    places[places.length - 1] -= over;
    for (let i = places.length - 2; i >= 0; i--) places[i] = Math.min(places[i], places[i + 1] - gap);
  }
  const layer = svg("g", { "font-size": 12, "text-anchor": "start" });
  sorted.forEach((mark, i) => {
    layer.append(
      svg("path", {
        d: `M${mark.x + 6},${mark.y}L${left - 14},${places[i]}H${left - 4}`,
        fill: "none",
        stroke: mark.colour,
        "stroke-opacity": 0.55,
      }),
      svg("text", { x: left, y: places[i], dy: "0.32em", fill: "var(--ink)" }, mark.text),
    );
  });
  chart.append(layer);
}
