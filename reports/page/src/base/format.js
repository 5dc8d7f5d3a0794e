// Numbers as people read them: three digits, units, a true minus. What does not exist is a dash.

export const none = "–";
export const isNumber = (value) => typeof value === "number" && Number.isFinite(value);

/** `digits` significant digits, without an exponent between 1e-4 and 1e7. */
export function significant(value, digits = 3) {
  if (!isNumber(value)) return none;
  if (value === 0) return "0";
  const size = Math.abs(value);
  let text;
  if (size >= 1e7 || size < 1e-4) text = value.toExponential(digits - 1).replace("e+", "e");
  else if (size >= 10 ** (digits - 1)) text = group(Math.round(value));
  else text = value.toPrecision(digits);
  return text.replace(/-/g, "−");
}

/** A whole number with its thousands apart. */
export function group(value) {
  if (!isNumber(value)) return none;
  return Math.round(value)
    .toString()
    .replace("-", "−")
    .replace(/\B(?=(\d{3})+(?!\d))/g, ",");
}

/** For axes: no zeros at the end. */
export const tick = (value, digits = 2) => {
  const text = significant(value, digits);
  return text.includes(".") ? text.replace(/\.?0+(?=$|e)/, "") : text;
};

export const percent = (value) => (isNumber(value) ? `${significant(100 * value)} %` : none);
export const signedPercent = (value) => (isNumber(value) && value > 0 ? "+" : "") + percent(value);
export const times = (value) => (isNumber(value) ? `${significant(value)}×` : none);

export function seconds(value, format = significant) {
  if (!isNumber(value)) return none;
  const size = Math.abs(value);
  const show = (scaled, unit) => `${typeof format === "function" ? format(scaled) : significant(scaled)} ${unit}`;
  if (size === 0) return "0 s";
  if (size < 0.9995e-6) return show(value * 1e9, "ns");
  if (size < 0.9995e-3) return show(value * 1e6, "µs");
  if (size < 0.9995) return show(value * 1e3, "ms");
  return show(value, "s");
}
export const nanoseconds = (value) => seconds(isNumber(value) ? value * 1e-9 : null);
export const milliseconds = (value) => seconds(isNumber(value) ? value * 1e-3 : null);

export const isInterval = (value) => Array.isArray(value) && isNumber(value[0]) && isNumber(value[1]);
export const interval = (value, format = significant) =>
  isInterval(value) ? `[${format(value[0])}, ${format(value[1])}]` : none;

/** [8.9, 9.1] % rather than the unit twice. */
export function percentInterval(value) {
  return isInterval(value) ? `[${significant(100 * value[0])}, ${significant(100 * value[1])}] %` : none;
}

export const text = (value) => (value === null || value === undefined || value === "" ? none : String(value));
export const plural = (count, one, many = `${one}s`) => `${group(count)} ${count === 1 ? one : many}`;

/** "a", "a and b", "a, b and c". */
export function list(items) {
  if (items.length < 2) return items.join("");
  return `${items.slice(0, -1).join(", ")} and ${items[items.length - 1]}`;
}

/** As `list`, but no more than `most`, and how many are left. */
export function shortList(items, most = 4) {
  return items.length <= most ? list(items) : list([...items.slice(0, most - 1), `${items.length - most + 1} more`]);
}
