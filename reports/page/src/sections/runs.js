// Where the numbers come from: machine, versions, seeds, flags, options; and results that no section knows.
import { h } from "../base/dom.js";
import { group, isNumber, plural, seconds, significant, text } from "../base/format.js";
import { figure, missing } from "../figure.js";

const known = ["accuracy", "search", "storage", "converge", "stress", "render"];

export function runsSection(report) {
  const rows = report.files.map((file) => ({
    name: file.name,
    command: file.command,
    version: file.result.version ?? null,
    seed: file.result.seed ?? null,
    rows: Array.isArray(file.result.rows) ? file.result.rows.length : 0,
    left_out: isNumber(file.left_out) ? file.left_out : null,
    wall_s: file.result.wall_s ?? null,
    interrupted: file.result.interrupted ?? null,
    cpu: file.machine.cpu ?? null,
    cores: file.machine.cores ?? null,
    simd: file.machine.simd ?? null,
    governor: file.machine.governor ?? null,
    load: file.machine.load ?? null,
    compiler: file.machine.compiler ?? null,
    flags: file.machine.flags ?? null,
  }));
  const columns = [
    ["name", "File"],
    ["command", "Command"],
    ["version", "Version"],
    ["seed", "Seed"],
    ["rows", "Rows"],
    ["left_out", "Left out"],
    ["wall_s", "Took"],
    ["cpu", "Processor"],
    ["cores", "Cores"],
    ["simd", "SIMD"],
    ["governor", "Governor"],
    ["load", "Load"],
    ["compiler", "Compiler"],
    ["flags", "Flags"],
    ["interrupted", "Interrupted"],
  ].map(([key, label]) => ({ key, label }));
  columns.find((column) => column.key === "wall_s").format = seconds;
  columns.find((column) => column.key === "seed").format = text;
  return [
    h(
      "p",
      {},
      `Made by photonbench ${text(report.version)}, commit ${text(report.commit)}, on ${text(report.date)}.`,
    ),
    rows.length
      ? figure({
          id: "runs",
          title: "Files, machines and flags",
          rows: () => rows,
          columns,
          summary: () =>
            `${plural(rows.length, "result file")}, ${plural(report.images.length, "image")}, ` +
            `${group(rows.reduce((sum, row) => sum + row.rows, 0))} rows.`,
          formula:
            "as each file states it. Load: running processes when the run began; times of a loaded machine vary.",
          plusminus: null,
          open: true,
        })
      : missing(
          "result files: there is not one",
          "photonbench accuracy --json accuracy.json && photonbench report accuracy.json -o report",
        ),
    ...report.files.map((file) =>
      h(
        "details",
        {},
        h("summary", {}, `Options of ${file.name} (${file.command})`),
        h(
          "dl.options",
          {},
          Object.entries(file.options).map(([name, value]) => [h("dt", {}, name), h("dd", {}, optionText(value))]),
        ),
      ),
    ),
  ];
}

const optionText = (value) =>
  Array.isArray(value)
    ? value.map(optionText).join(", ") || "–"
    : value && typeof value === "object"
      ? JSON.stringify(value)
      : text(value);

/** Rows of commands without a section of their own, as they are. */
export function otherSection(report) {
  return report.files
    .filter((file) => !known.includes(file.command))
    .map((file, i) => {
      const rows = (Array.isArray(file.result.rows) ? file.result.rows : []).filter(
        (row) => row && typeof row === "object",
      );
      const keys = [...new Set(rows.flatMap(Object.keys))];
      if (!rows.length)
        return h(
          "p.missing",
          { role: "note" },
          `${file.name} (${file.command}) has no rows that this page can show.`,
        );
      return figure({
        id: `other-${i}`,
        title: `${file.name}: ${file.command}`,
        rows: () => rows,
        columns: keys.map((key) => ({ key, label: key })),
        summary: () => `${plural(rows.length, "row")} of ${file.command}.`,
        formula: `docs/${file.command}.md says what the fields are.`,
        plusminus: "fields that end in _ci95 are 95 % intervals.",
      });
    });
}

export function missingSection(report) {
  return report.missing.map((part) => missing(text(part.what ?? part.part), part.how));
}

/** Times and errors of rendered images, as `render` wrote them. */
export function renderFigure(report) {
  const rows = report.rows("render");
  if (!rows.length) return null;
  return figure({
    id: "rendered",
    title: "Images: error and time",
    rows: () => rows,
    columns: [
      { key: "scene", label: "Scene", format: (v) => report.names.scene.short(v) },
      { key: "estimator", label: "Estimator", format: (v) => report.names.estimator.short(v) },
      { key: "method", label: "Method" },
      { key: "k", label: "k" },
      { key: "photons", label: "Photons", format: group },
      { key: "spp", label: "Samples a pixel" },
      { key: "truth", label: "Truth" },
      {
        key: "rel_error_mean",
        label: "Mean error",
        format: (v) => (isNumber(v) ? `${significant(100 * v)} %` : "–"),
      },
      { key: "rel_error_rms", label: "RMS error", format: (v) => (isNumber(v) ? `${significant(100 * v)} %` : "–") },
      { key: "trace_s", label: "Photons", format: seconds },
      { key: "build_s", label: "Maps", format: seconds },
      { key: "image_s", label: "Pixels", format: seconds },
      { key: "status", label: "Status" },
    ],
    summary: () =>
      `${plural(rows.length, "image")} as \`render\` made them; estimators of a scene share their photons.`,
    formula:
      "error = (image − truth) / mean truth of the image, over pixels and bands whose truth is known: mean, " +
      "and root of the mean square.",
    plusminus: "none: one map a picture. RMS error holds the noise of this map and of the camera's samples.",
  });
}
