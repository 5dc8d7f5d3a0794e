// Tables of values: shown rounded, with the value itself in data-value; and the same as CSV.
import { h, rich } from "./base/dom.js";
import { group, isInterval, none, significant } from "./base/format.js";

/** columns: [{key, label, format?, value?}]; value(row) is the raw value, row[key] if absent. */
export const rawValue = (column, row) => (column.value ? column.value(row) : row[column.key]);

function shown(column, value, row) {
  if (column.format) return column.format(value, row);
  if (Number.isInteger(value)) return group(value);
  if (typeof value === "number") return significant(value, 4);
  if (isInterval(value)) return `[${significant(value[0])}, ${significant(value[1])}]`;
  if (typeof value === "boolean") return value ? "yes" : "no";
  return value === null || value === undefined || value === "" ? none : rich(value);
}

const isNumeric = (value) => typeof value === "number" || isInterval(value);
const most = 3000; // more rows are in the CSV: a table of more slows a browser down

export function makeTable(columns, rows, caption) {
  const body = rows.slice(0, most).map((row) =>
    h(
      "tr",
      { class: row.highlight ?? null },
      columns.map((column, i) => {
        const value = rawValue(column, row);
        const attributes = {
          "data-key": column.key,
          "data-value": value === undefined ? "null" : JSON.stringify(value),
        };
        const kind = i === 0 ? "th" : "td";
        if (i === 0) attributes.scope = "row";
        return h(isNumeric(value) ? `${kind}.number` : kind, attributes, shown(column, value, row));
      }),
    ),
  );
  return h(
    "div.scroll",
    { tabindex: 0, role: "region", "aria-label": caption },
    h(
      "table",
      {},
      h(
        "caption",
        {},
        caption,
        rows.length > most ? ` (the first ${most} of ${rows.length} rows; the CSV has all)` : "",
      ),
      h(
        "thead",
        {},
        h(
          "tr",
          {},
          columns.map((column) => h("th", { scope: "col" }, column.label)),
        ),
      ),
      h("tbody", {}, body),
    ),
  );
}

function csvField(value) {
  if (value === null || value === undefined) return "";
  const string = typeof value === "object" ? JSON.stringify(value) : String(value);
  return /[",\n\r]/.test(string) ? `"${string.replace(/"/g, '""')}"` : string;
}

/** Unrounded values; an interval has two columns, _low and _high. */
export function makeCsv(columns, rows) {
  const split = columns.map((column) => column.interval || rows.some((row) => isInterval(rawValue(column, row))));
  const head = columns.flatMap((column, i) => {
    const name = column.csv ?? column.key;
    return split[i] ? [`${name}_low`, `${name}_high`] : [name];
  });
  const lines = rows.map((row) =>
    columns
      .flatMap((column, i) => {
        const value = rawValue(column, row);
        if (!split[i]) return [csvField(value)];
        return isInterval(value) ? value.map(csvField) : ["", ""];
      })
      .join(","),
  );
  return `${[head.join(","), ...lines].join("\n")}\n`;
}

/** Button that copies CSV; where a page may not write the clipboard, the text is shown, selected. */
export function copyButton(getCsv, what) {
  const status = h("span.status", { role: "status" });
  const area = h("textarea.csv", { readonly: true, rows: 8, hidden: true, "aria-label": `CSV of ${what}` });
  const button = h("button", { type: "button", class: "copy", "aria-label": `Copy CSV of ${what}` }, "Copy CSV");
  button.addEventListener("click", async () => {
    const csv = getCsv();
    button.dataset.csv = String(csv.length);
    try {
      await navigator.clipboard.writeText(csv);
      area.hidden = true;
      status.textContent = `${csv.split("\n").length - 2} rows copied`;
    } catch {
      area.value = csv;
      area.hidden = false;
      area.focus();
      area.select();
      status.textContent = "The browser does not let this page copy: the text below is selected, press Ctrl+C.";
    }
  });
  return h("span.copying", {}, button, status, area);
}
