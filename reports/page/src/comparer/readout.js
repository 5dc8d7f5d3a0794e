// The values under the cursor: of the view that is shown, of the truth, and the signed error, in words and numbers.
import { h } from "../base/dom.js";
import { isNumber, none, percent, signedPercent, significant } from "../base/format.js";

const bands = (view, i) => {
  const { data, channels } = view.pixels;
  return channels === 3 ? [data[3 * i], data[3 * i + 1], data[3 * i + 2]] : [data[i]];
};
const known = (value) => (isNumber(value) ? value : null);
const value = (view, v) => {
  if (known(v) === null) return "unknown";
  if (view.show === "signed") return signedPercent(v);
  return view.kind === "noise" ? percent(v) : significant(v, 4);
};

function unitOf(view) {
  if (view.show === "signed" || view.kind === "noise") return "of mean truth";
  if (view.kind === "radius") return "m";
  if (view.kind === "count") return "photons";
  return "W/(m² sr)";
}

/** Rows of the read-out: [{what, values, unit}]. */
export function readings(views, current, cursor) {
  if (!current || !cursor) return [];
  const { width } = current.pixels;
  const i = cursor.y * width + cursor.x;
  const wanted = [current];
  const truth = views.find((view) => view.kind === "truth");
  const same = (view) => view && view.pixels.width === width && view.pixels.height === current.pixels.height;
  if (truth !== current && same(truth)) wanted.push(truth);
  const error = views.find((view) => view.kind === "error" && view.of === current);
  if (error) wanted.push(error);
  if (current.of) wanted.push(current.of);
  return wanted.map((view) => ({
    what: view.label,
    values: bands(view, i),
    text: bands(view, i).map((v) => value(view, v)),
    unit: unitOf(view),
  }));
}

export function readoutTable(rows, cursor) {
  if (!rows.length) return [h("p", {}, "Point at the picture, or move the cursor with i j k l.")];
  const three = rows.some((row) => row.values.length === 3);
  return [
    h(
      "table",
      {},
      h("caption", {}, `Pixel ${cursor.x}, ${cursor.y} from the top left`),
      h(
        "thead",
        {},
        h("tr", {}, [
          h("th", { scope: "col" }, "View"),
          ...(three ? ["R", "G", "B"] : ["Y"]).map((band) => h("th", { scope: "col" }, band)),
          h("th", { scope: "col" }, "Unit"),
        ]),
      ),
      h(
        "tbody",
        {},
        rows.map((row) =>
          h(
            "tr",
            {},
            h("th", { scope: "row" }, row.what),
            row.text.map((text, b) => h("td.number", { "data-value": known(row.values[b]) ?? "null" }, text)),
            three && row.values.length === 1 ? [h("td", {}, none), h("td", {}, none)] : null,
            h("td", {}, row.unit),
          ),
        ),
      ),
    ),
  ];
}

export const spoken = (rows, cursor) =>
  `Pixel ${cursor.x}, ${cursor.y}: ${rows.map((row) => `${row.what} ${row.text.join(" ")}`).join("; ")}`;
