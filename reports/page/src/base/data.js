// The report's data: read once, never trusted. What is absent or of another type becomes an empty list or null.
import { Names } from "./names.js";

const list = (value) => (Array.isArray(value) ? value : []);
const object = (value) => (value && typeof value === "object" && !Array.isArray(value) ? value : {});
const objects = (value) => list(value).filter((item) => item && typeof item === "object" && !Array.isArray(item));

export function readReport() {
  const element = document.getElementById("pm-report");
  if (!element) return { ...makeReport({}), problem: "The page holds no data: `photonbench report` puts it in." };
  try {
    return makeReport(object(JSON.parse(element.textContent)));
  } catch (error) {
    return { ...makeReport({}), problem: `The page's data cannot be read: ${error.message}` };
  }
}

export function makeReport(source) {
  const files = objects(source.files).map((file, index) => {
    const result = object(file.result);
    return {
      name: String(file.name ?? `file ${index + 1}`),
      command: String(result.command ?? "unknown"),
      left_out: file.left_out ?? null,
      result,
      options: object(result.options),
      machine: object(result.machine),
    };
  });
  const report = {
    version: source.version ?? null,
    commit: source.commit ?? null,
    date: source.date ?? null,
    files,
    images: objects(source.images),
    errata: objects(source.errata),
    missing: objects(source.missing),
    problem: null,
  };
  report.rows = (command, part = "rows") => collect(files, command, part);
  report.names = collectNames(report);
  return report;
}

/** Rows of all files of a command, each with the name of its file in `file_name`. */
function collect(files, command, part) {
  const rows = [];
  for (const file of files) {
    if (file.command !== command) continue;
    for (const row of objects(file.result[part])) rows.push({ ...row, file_name: file.name });
  }
  return rows;
}

function collectNames(report) {
  const of = (field, ...commands) =>
    new Names(commands.flatMap((command) => report.rows(command).map((row) => row[field])));
  return {
    estimator: of("estimator", "accuracy", "converge", "render"),
    case: of("case", "accuracy"),
    scene: new Names([
      ...["storage", "converge", "render"].flatMap((command) => report.rows(command).map((row) => row.scene)),
      ...report.images.map((image) => image.scene),
    ]),
    policy: of("policy", "storage"),
    method: of("method", "converge"),
    search: of("search", "search"),
  };
}

export const distinct = (rows, field) => [...new Set(rows.map((row) => row[field]))].filter((v) => v !== undefined);

export function groupBy(rows, key) {
  const groups = new Map();
  for (const row of rows) {
    const name = key(row);
    if (!groups.has(name)) groups.set(name, []);
    groups.get(name).push(row);
  }
  return groups;
}
