// From numbers to colours: radiance on a screen, logarithmic false colour, and diverging colours for signed values.
import { interpolateViridis, rgb } from "d3";
import { tick } from "../base/format.js";
import { scalarAt } from "./scenes.js";

const table = (pick) => Uint8Array.from({ length: 256 * 3 }, (_, i) => pick(Math.floor(i / 3) / 255)[i % 3]);
const stops = [
  [5, 48, 97],
  [33, 102, 172],
  [67, 147, 195],
  [146, 197, 222],
  [209, 229, 240],
  [247, 247, 247],
  [253, 219, 199],
  [244, 165, 130],
  [214, 96, 77],
  [178, 24, 43],
  [103, 0, 31],
];
const diverging = table((t) => {
  const at = Math.min(stops.length - 2, Math.floor(t * (stops.length - 1)));
  const f = t * (stops.length - 1) - at;
  return stops[at].map((value, i) => Math.round(value + f * (stops[at + 1][i] - value)));
});
const sequential = table((t) => {
  const { r, g, b } = rgb(interpolateViridis(t));
  return [r, g, b];
});
export const decades = 3; // of the false colour of radiance

const srgb = Uint8Array.from({ length: 4097 }, (_, i) => {
  const v = i / 4096;
  return Math.round(255 * (v <= 0.0031308 ? 12.92 * v : 1.055 * v ** (1 / 2.4) - 0.055));
});
const screen = (value) => srgb[Math.max(0, Math.min(4096, Math.round(value * 4096)))];

/**
 * What a view looks like: {kind: "screen"|"log"|"linear"|"signed", most}.
 * settings: {exposure, falseColour, white, signed}.
 */
export function scaleOf(view, settings) {
  const gain = 2 ** settings.exposure;
  if (view.show === "signed") return { kind: "signed", most: settings.signed / gain, unit: "of mean truth" };
  if (view.show === "positive") return { kind: "linear", most: (view.most ?? 1) / gain, unit: unitOf(view) };
  return { kind: settings.falseColour ? "log" : "screen", most: settings.white / gain, unit: "W/(m² sr)" };
}

function unitOf(view) {
  if (view.kind === "radius") return "m";
  if (view.kind === "count") return "photons";
  return view.kind === "noise" ? "of mean truth" : "";
}

function colourIndex(scale, value) {
  if (scale.kind === "signed") return Math.round(127.5 * (1 + Math.max(-1, Math.min(1, value / scale.most))));
  const t = scale.kind === "log" ? 1 + Math.log10(Math.max(value, 1e-30) / scale.most) / decades : value / scale.most;
  return Math.round(255 * Math.max(0, Math.min(1, t)));
}

/** Colours all pixels of a view. What is not known is a checkerboard of two greys. */
export function paint(view, settings) {
  const { width, height, data, channels } = view.pixels;
  const image = new ImageData(width, height);
  const scale = scaleOf(view, settings);
  const colours = scale.kind === "signed" ? diverging : sequential;
  for (let i = 0; i < width * height; i++) {
    const to = 4 * i;
    const value = scalarAt(view, i);
    image.data[to + 3] = 255;
    if (!Number.isFinite(value)) {
      const grey = (((i % width) >> 2) + (Math.floor(i / width) >> 2)) % 2 ? 110 : 140;
      image.data[to] = image.data[to + 1] = image.data[to + 2] = grey;
    } else if (scale.kind === "screen") {
      for (let c = 0; c < 3; c++)
        image.data[to + c] = screen(data[channels * i + (channels === 3 ? c : 0)] / scale.most);
    } else {
      const from = 3 * colourIndex(scale, value);
      for (let c = 0; c < 3; c++) image.data[to + c] = colours[from + c];
    }
  }
  return image;
}

/** Ticks of a scale: [{at: 0..1, text}]. */
export function scaleTicks(scale) {
  const { most } = scale;
  if (scale.kind === "signed")
    return [-1, -0.5, 0, 0.5, 1].map((t) => ({
      at: (t + 1) / 2,
      text: `${t > 0 ? "+" : ""}${tick(100 * t * most)} %`,
    }));
  if (scale.kind === "log")
    return [0, 1, 2, 3].map((d) => ({ at: d / decades, text: tick(most * 10 ** (d - decades)) }));
  const text = scale.unit === "of mean truth" ? (v) => `${tick(100 * v)} %` : (v) => tick(v);
  return [0, 0.5, 1].map((t) => ({ at: t, text: text(t * most) }));
}

export function paintScale(canvas, scale) {
  const context = canvas.getContext("2d");
  for (let x = 0; x < canvas.width; x++) {
    const t = x / (canvas.width - 1);
    const i = 3 * Math.round(255 * t);
    const colours = scale.kind === "signed" ? diverging : sequential;
    const level = screen(t);
    context.fillStyle =
      scale.kind === "screen"
        ? `rgb(${level},${level},${level})`
        : `rgb(${colours[i]},${colours[i + 1]},${colours[i + 2]})`;
    context.fillRect(x, 0, 1, canvas.height);
  }
}
