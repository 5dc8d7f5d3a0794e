// What intervals say: ratios of errors, and whether two of them can be told apart.
import { isInterval, isNumber } from "./format.js";

/** Half the width of a 95 % interval in the logarithm; null where there is none above 0. */
export function logHalfWidth(interval) {
  if (!isInterval(interval) || !(interval[0] > 0)) return null;
  return (Math.log(interval[1]) - Math.log(interval[0])) / 2;
}

/** a over b with its interval, widths added as if a and b were independent: wide where they share photons. */
export function ratio(a, aInterval, b, bInterval) {
  if (!isNumber(a) || !isNumber(b) || !(b > 0) || !(a > 0)) return { value: null, interval: null };
  const value = a / b;
  const widths = [logHalfWidth(aInterval), logHalfWidth(bInterval)];
  if (widths.includes(null)) return { value, interval: null };
  const half = Math.hypot(...widths);
  return { value, interval: [value * Math.exp(-half), value * Math.exp(half)] };
}

/** Two intervals that overlap are a tie; one that is absent can be told from nothing. */
export function overlap(a, b) {
  if (!isInterval(a) || !isInterval(b)) return true;
  return a[0] <= b[1] && b[0] <= a[1];
}

/** Interval a lies wholly below b. */
export const below = (a, b) => isInterval(a) && isInterval(b) && a[1] < b[0];
export const outside = (value, interval) =>
  isNumber(value) && isInterval(interval) && (value < interval[0] || value > interval[1]);

export function least(items, value) {
  let best = null;
  for (const item of items) {
    const v = value(item);
    if (isNumber(v) && (best === null || v < value(best))) best = item;
  }
  return best;
}

export const greatest = (items, value) => least(items, (item) => (isNumber(value(item)) ? -value(item) : null));
