// Builds the page from its data. A section that fails says so in its place, and the others stand.
import { h } from "./base/dom.js";
import { readReport } from "./base/data.js";
import { missing } from "./figure.js";
import { comparerSection } from "./comparer/comparer.js";
import { frontModel, settings } from "./sections/accuracy_model.js";
import { accuracySection } from "./sections/accuracy.js";
import { answer, answerElement } from "./sections/answer.js";
import { convergeSection } from "./sections/converge.js";
import { budgetFigure, frontFigure } from "./sections/front.js";
import { lossesSection } from "./sections/losses.js";
import { missingSection, otherSection, renderFigure, runsSection } from "./sections/runs.js";
import { searchSection } from "./sections/search.js";
import { storageSection } from "./sections/storage.js";
import { errataSection, stressSection } from "./sections/stress.js";

function guarded(build) {
  try {
    return build();
  } catch (error) {
    return [h("p.missing", { role: "note" }, `This part cannot be shown from these data: ${error.message}`)];
  }
}

const section = (id, title, lead, build) =>
  h(
    "section",
    { id, "aria-labelledby": `${id}-title` },
    h("h2", { id: `${id}-title` }, title),
    lead ? h("p.lead", {}, lead) : null,
    guarded(build),
  );

function firstScreen(report, choices) {
  const head = [
    h("p.kicker", {}, "photonbench report"),
    h("h1", {}, "Which radiance estimator gives this error at least cost?"),
    report.problem ? h("p.missing", { role: "alert" }, report.problem) : null,
  ];
  const rows = guarded(() => {
    if (!choices.length)
      return [
        missing(
          "the answer and the front: no rows of `accuracy`",
          "photonbench accuracy --profile full --json accuracy.json",
        ),
      ];
    const model = frontModel(choices[0].rows, report.names);
    return [answerElement(answer(model, report.names, choices[0].label)), frontFigure(choices, report.names)];
  });
  return h("header", { id: "top" }, head, rows, missingList(report));
}

function missingList(report) {
  const items = missingSection(report);
  return items.length
    ? h(
        "details.missing-list",
        { open: true },
        h("summary", {}, `${items.length} of this report's parts are missing`),
        items,
      )
    : null;
}

function sections(report, choices) {
  const other = report.files.length ? guarded(() => otherSection(report)) : [];
  return [
    section(
      "images",
      "Images",
      "Switch, wipe and zoom: the same pixels of every estimator, the truth, and the signed error.",
      () => [comparerSection(report), renderFigure(report)],
    ),
    section(
      "accuracy",
      "Bias, noise and error",
      "Every estimator against exact truth, by k, by region and by case, beside what theory predicts.",
      () => [choices.length ? budgetFigure(choices, report.names) : null, ...accuracySection(report, choices)],
    ),
    section("search", "Searches", "Recursive against iterative against the rest, checked against brute force.", () =>
      searchSection(report),
    ),
    section("storage", "Storage", "What each storage policy costs, and what it is worth.", () =>
      storageSection(report),
    ),
    section(
      "convergence",
      "Convergence",
      "How fast progressive methods approach the truth, and how fast theory says they should.",
      () => convergeSection(report),
    ),
    section("edges", "Numbers at the edges", "Hard inputs against a computation in extended precision.", () =>
      stressSection(report),
    ),
    section("wrong", "Errata", "What the papers print wrong, and how much it matters.", () => errataSection(report)),
    section("lose", "Where we lose", null, () => lossesSection(report)),
    other.length ? section("other", "Other results", null, () => other) : null,
  ].filter(Boolean);
}

function start() {
  const began = performance.now();
  const report = readReport();
  const choices = guarded(() => settings(report.rows("accuracy"))).filter((choice) => choice.rows);
  const parts = sections(report, choices);
  const links = parts.map((part) =>
    h("li", {}, h("a", { href: `#${part.id}` }, part.querySelector("h2").textContent)),
  );
  document.getElementById("page").replaceChildren(
    h("nav", { "aria-label": "Sections" }, h("ul", {}, links, h("li", {}, h("a", { href: "#about" }, "Runs")))),
    h("main", { id: "main", tabindex: -1 }, firstScreen(report, choices), parts),
    h(
      "footer",
      { id: "about" },
      h("h2", {}, "Runs"),
      guarded(() => runsSection(report)),
    ),
  );
  document.documentElement.dataset.ready = String(Math.round(performance.now() - began));
}

// The data stand before this script, so they are there already; a page cut short is shown as far as it came.
start();
