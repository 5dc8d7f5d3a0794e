// Images by scene, decoded when wanted; signed errors against the scene's truth; what number keys switch between.
import { decodeExr, fromBase64 } from "./exr.js";
import { groupBy } from "../base/data.js";

const pending = new Map(); // file -> what to do when its script beside the page has come

if (typeof window !== "undefined") {
  window.pmImage = (file, base64) => {
    pending.get(file)?.(base64);
    pending.delete(file);
  };
}

/** The image's pixels; rejects with the reason where there are none. */
export async function loadPixels(image) {
  if (image.pixels) return image.pixels;
  const base64 = image.exr ?? (image.href ? await loadScript(image) : null);
  if (!base64) throw new Error("the page holds no pixels of it");
  image.pixels = decodeExr(fromBase64(base64));
  return image.pixels;
}

function loadScript(image) {
  return new Promise((resolve, reject) => {
    pending.set(image.file, resolve);
    const script = document.createElement("script");
    script.src = image.href;
    script.onerror = () => reject(new Error(`${image.href} is not beside the page`));
    script.onload = () => pending.has(image.file) && reject(new Error(`${image.href} holds another image`));
    document.head.append(script);
  });
}

/** Scenes that have an image or a truth: [{scene, images, truth}]; images in the order of the file. */
export function scenesOf(images) {
  return [
    ...groupBy(
      images.filter((image) => image.kind),
      (image) => image.scene ?? "images",
    ),
  ]
    .map(([scene, members]) => ({
      scene,
      truth: members.find((image) => image.kind === "truth") ?? null,
      images: members.filter((image) => image.kind === "image"),
      others: members.filter((image) => !["image", "truth"].includes(image.kind)),
    }))
    .filter((one) => one.images.length + one.others.length + (one.truth ? 1 : 0));
}

/** Mean over pixels and bands that are known. */
function meanOf(pixels) {
  let sum = 0;
  let count = 0;
  for (const value of pixels.data)
    if (Number.isFinite(value)) {
      sum += value;
      count++;
    }
  return count ? sum / count : NaN;
}

/** (image - truth) / mean truth, band by band; NaN where the truth is not known. With its mean and root mean square. */
export function signedError(image, truth) {
  if (image.width !== truth.width || image.height !== truth.height || image.channels !== truth.channels) return null;
  const mean = meanOf(truth);
  if (!(mean > 0)) return null;
  const data = new Float32Array(image.data.length);
  let [sum, squares, count] = [0, 0, 0];
  for (let i = 0; i < data.length; i++) {
    const off = (image.data[i] - truth.data[i]) / mean;
    data[i] = off;
    if (!Number.isFinite(off)) continue;
    sum += off;
    squares += off * off;
    count++;
  }
  return {
    width: image.width,
    height: image.height,
    channels: image.channels,
    data,
    mean: count ? sum / count : null,
    rms: count ? Math.sqrt(squares / count) : null,
  };
}

export const shows = {
  image: "radiance",
  truth: "radiance",
  error: "signed",
  bias: "signed",
  noise: "positive",
  radius: "positive",
  count: "positive",
  other: "radiance",
};

/** Views of a scene: its images, the truth, the signed error of each, then whatever else there is. */
export async function viewsOf(scene) {
  const views = [];
  const problems = [];
  const add = async (image, show, label) => {
    try {
      views.push({ kind: image.kind, label, show, image, pixels: await loadPixels(image) });
    } catch (error) {
      problems.push(`${label}: ${error.message}`);
    }
  };
  for (const image of scene.images) await add(image, "radiance", image.label ?? image.name);
  const shown = [...views];
  if (scene.truth) await add(scene.truth, "radiance", String(scene.truth.label ?? "truth"));
  const truth = views.find((view) => view.kind === "truth");
  for (const view of shown) {
    const error = truth && signedError(view.pixels, truth.pixels);
    view.error = error;
    if (error)
      views.push({ kind: "error", label: `error of ${view.label}`, show: "signed", pixels: error, of: view });
    else if (truth) problems.push(`${view.label}: no signed error, the truth has another size`);
  }
  for (const image of scene.others)
    await add(
      image,
      shows[image.kind] ?? "radiance",
      `${image.kind === "other" ? "" : `${image.kind} of `}${image.label ?? image.name}`,
    );
  if (!scene.truth) problems.push("no truth of this scene, so no signed errors");
  return { views, truth, problems, ...ranges(views) };
}

const luminanceAt = (pixels, i) => {
  const { data, channels } = pixels;
  return channels === 3 ? 0.2126 * data[3 * i] + 0.7152 * data[3 * i + 1] + 0.0722 * data[3 * i + 2] : data[i];
};
/** Signed quantities are shown by the mean of the bands, as the error's mean is taken. */
export const scalarAt = (view, i) => {
  const { data, channels } = view.pixels;
  if (view.show === "radiance" || channels === 1) return luminanceAt(view.pixels, i);
  return (data[3 * i] + data[3 * i + 1] + data[3 * i + 2]) / 3;
};

function percentile(view, share) {
  const values = [];
  for (let i = 0; i < view.pixels.width * view.pixels.height; i++) {
    const value = Math.abs(scalarAt(view, i));
    if (Number.isFinite(value)) values.push(value);
  }
  values.sort((a, b) => a - b);
  return values.length ? values[Math.min(values.length - 1, Math.floor(share * values.length))] : 0;
}

/** The next of 1, 2, 5 times a power of ten. */
export function rounded(value) {
  if (!(value > 0)) return 1;
  const power = 10 ** Math.floor(Math.log10(value));
  return [1, 2, 5, 10].find((step) => step * power >= value * 0.999) * power;
}

/** What white is, and the ends of the scales, for all views of a scene alike; positive ones each have their own. */
function ranges(views) {
  const reference = views.find((view) => view.kind === "truth") ?? views.find((view) => view.show === "radiance");
  const errors = views
    .filter((view) => view.show === "signed")
    .map((view) => percentile(view, 0.98))
    .sort((a, b) => a - b);
  for (const view of views) if (view.show === "positive") view.most = rounded(percentile(view, 0.99));
  return {
    white: rounded(reference ? percentile(reference, 0.97) * 1.2 : 1),
    signed: rounded(errors.length ? errors[errors.length >> 1] : 1),
  };
}
