// One colour and one symbol for each name, the same in all figures: colour is never all that tells two apart.
import { symbolCircle, symbolCross, symbolDiamond, symbolSquare, symbolStar, symbolTriangle, symbolWye } from "d3";
import { svg } from "../base/dom.js";

const triangleDown = {
  draw(context, size) {
    const y = -Math.sqrt(size / (Math.sqrt(3) * 3));
    context.moveTo(0, -y * 2);
    context.lineTo(-Math.sqrt(3) * y, y);
    context.lineTo(Math.sqrt(3) * y, y);
    context.closePath();
  },
};
const hexagon = {
  draw(context, size) {
    const r = Math.sqrt(size / 2.598);
    for (let i = 0; i < 6; i++)
      context[i ? "lineTo" : "moveTo"](r * Math.cos((i * Math.PI) / 3), r * Math.sin((i * Math.PI) / 3));
    context.closePath();
  },
};
const bar = {
  draw(context, size) {
    const r = Math.sqrt(size) * 0.75;
    context.rect(-r, -r / 3, 2 * r, (2 * r) / 3);
  },
};
const post = {
  draw(context, size) {
    const r = Math.sqrt(size) * 0.75;
    context.rect(-r / 3, -r, (2 * r) / 3, 2 * r);
  },
};
const bowtie = {
  draw(context, size) {
    const r = Math.sqrt(size) * 0.65;
    context.moveTo(-r, -r);
    context.lineTo(r, r);
    context.lineTo(r, -r);
    context.lineTo(-r, r);
    context.closePath();
  },
};

const symbols = [
  symbolCircle,
  symbolSquare,
  symbolTriangle,
  symbolDiamond,
  triangleDown,
  symbolStar,
  symbolCross,
  hexagon,
  symbolWye,
  bar,
  post,
  bowtie,
];
const colours = 11;

/** Style of the index-th name: colour as a CSS variable (it follows dark mode), symbol for Plot. */
export function style(index) {
  const i = Math.max(0, index);
  return { colour: `var(--series-${i % colours})`, symbol: symbols[i % symbols.length] };
}

/** Path data of a symbol, for legends. */
export function symbolPath(symbol, size) {
  let path = "";
  const put =
    (command) =>
    (...numbers) =>
      (path += command + numbers.map((n) => n.toFixed(2)).join(","));
  symbol.draw(
    {
      moveTo: put("M"),
      lineTo: put("L"),
      closePath: () => (path += "Z"),
      rect: (x, y, w, h) => (path += `M${x},${y}h${w}v${h}h${-w}Z`),
      arc: (x, y, r) => (path += `M${x + r},${y}A${r},${r} 0 1 1 ${x - r},${y}A${r},${r} 0 1 1 ${x + r},${y}Z`),
    },
    size,
  );
  return path;
}

export function symbolIcon(index) {
  const { colour, symbol } = style(index);
  return svg(
    "svg",
    { viewBox: "-8 -8 16 16", width: 16, height: 16, "aria-hidden": "true" },
    svg("path", { d: symbolPath(symbol, 64), fill: colour }),
  );
}
