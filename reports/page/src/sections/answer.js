// The answer in three sentences, computed from the rows: who has the least error at what cost, by how much, who loses.
import { h } from "../base/dom.js";
import {
  interval,
  isNumber,
  list,
  percent,
  percentInterval,
  plural,
  seconds,
  shortList,
  times,
} from "../base/format.js";
import { greatest, least } from "../base/compare.js";
import { overall, ranking } from "./accuracy_model.js";

/** {sentences: [3 strings], best, ties, next, losers}; null where no estimator can be ranked. */
export function answer(model, names, setting) {
  const view = model.views.has(overall) ? overall : [...model.views.keys()][0];
  if (!view) return null;
  const ranks = ranking(model.views.get(view)).filter((entry) => !entry.oracle);
  if (!ranks.length) return null;
  const name = (entry) => names.estimator.short(entry.estimator);
  const [best] = ranks;
  const ties = ranks.filter((entry) => entry.tie);
  const next = ranks.find((entry) => entry !== best && !entry.tie) ?? null;
  const where = view === overall ? `Over ${plural(model.common.length, "case")} (geometric mean)` : `On ${view}`;
  const mark = ties.length ? "shares the least error" : "has the least error";
  const first =
    `${where} with ${setting}, ${name(best)} at ${best.lookup} ${mark}: RMSE ${percent(best.rmse)} ` +
    `${percentInterval(best.interval)} of the mean truth, at a cost of ${seconds(best.cost)} for a map and ` +
    `its queries.`;
  return {
    sentences: [first, ahead(best, ties, next, name), losing(model, ranks, best, ties, name)],
    best,
    ties,
    next,
    view,
  };
}

function ahead(best, ties, next, name) {
  const cheapest = least([best, ...ties], (entry) => entry.cost);
  const tie = ties.length
    ? `It ties with ${shortList(
        ties.map((entry) => `${name(entry)} (${percent(entry.rmse)})`),
        4,
      )}, whose intervals overlap its own` +
      (cheapest ? `; the cheapest of them is ${name(cheapest)} (${seconds(cheapest.cost)}); ` : "; ")
    : "";
  if (!next) return `${tie || "No other estimator was measured"}${tie ? "no estimator lies apart." : "."}`;
  const lead =
    `the next, ${name(next)} at ${next.lookup} (${percent(next.rmse)} ${percentInterval(next.interval)}), has ` +
    `${times(next.ratio)} ${interval(next.ratio_ci95)} its error`;
  const cost = `${costBeside(next, best)}.`;
  return tie ? `${tie}${lead}${cost}` : `${lead[0].toUpperCase()}${lead.slice(1)}${cost}`;
}

function costBeside(entry, best) {
  if (!isNumber(entry.cost) || !isNumber(best.cost)) return "";
  const over = entry.cost / best.cost;
  return over > 0.98 && over < 1.02 ? " at the same cost (within 2 %)" : ` at ${times(over)} its cost`;
}

function losing(model, ranks, best, ties, name) {
  const worst = greatest(
    ranks.filter((entry) => !entry.tie && entry !== best),
    (entry) => entry.rmse,
  );
  const dearest = greatest(ranks, (entry) => entry.cost);
  const parts = [];
  if (worst) parts.push(`${name(worst)} in error (${percent(worst.rmse)}, ${times(worst.ratio)} the least)`);
  if (dearest && isNumber(best.cost) && dearest !== best && dearest.cost > 1.1 * best.cost)
    parts.push(`${name(dearest)} in cost (${seconds(dearest.cost)}, ${times(dearest.cost / best.cost)})`);
  const lost = casesLost(model, best);
  if (lost.total > 1) {
    const who = lost.beaten.length
      ? `${name(best)} itself is beaten in ${lost.beaten.length} of ${lost.total} cases (${shortList(
          lost.beaten.map((one) => `${one.case} by ${name(one.by)}`),
          3,
        )})`
      : `no estimator beats ${name(best)} clearly in any of ${lost.total} cases`;
    parts.push(who);
  }
  if (!parts.length) return "Nothing loses clearly: all that was measured ties.";
  return `${worst ? "What loses most: " : "What loses: "}${list(parts)}.`;
}

/** Cases in which another estimator, at its best k, is clearly better than the winner at its own. */
export function casesLost(model, best) {
  const beaten = [];
  let total = 0;
  for (const [name, entries] of model.views) {
    if (name === overall) continue;
    total++;
    const ranks = ranking(entries).filter((entry) => !entry.oracle);
    const own = ranks.find((entry) => entry.estimator === best.estimator);
    if (own && !own.leader && !own.tie) beaten.push({ case: name, by: ranks.find((entry) => entry.leader), own });
  }
  return { beaten, total };
}

export function answerElement(result) {
  if (!result) return h("p.missing", {}, "No answer: there are no rows of accuracy in region `all` to compare.");
  return h(
    "div.answer",
    {
      id: "answer",
      "data-best": result.best.estimator,
      "data-rmse": result.best.rmse,
      "data-cost": result.best.cost,
    },
    result.sentences.map((sentence) => h("p", {}, sentence)),
  );
}
