// The comparer's keys: one list, from which they are obeyed, shown, and tested.

export const keys = [
  { keys: ["1", "2", "3", "4", "5", "6", "7", "8", "9"], show: "1 … 9", what: "show that view" },
  { keys: ["t", "0"], show: "t or 0", what: "show the truth" },
  { keys: ["d"], show: "d", what: "signed error of what is shown, and back" },
  { keys: [".", ","], show: ". and ,", what: "next and previous view" },
  { keys: ["w"], show: "w", what: "wipe: two views side by side along a line" },
  { keys: ["x"], show: "x", what: "swap the two views" },
  { keys: ["+", "=", "-"], show: "+ and −", what: "zoom in and out (also the wheel)" },
  {
    keys: ["ArrowLeft", "ArrowRight", "ArrowUp", "ArrowDown"],
    show: "arrows",
    what: "pan, once zoomed in (also dragging)",
  },
  { keys: [], show: "Shift + ← →", what: "move the line of the wipe" },
  {
    keys: ["i", "j", "k", "l"],
    show: "i j k l",
    what: "move the pixel cursor up, left, down, right (with Shift by ten)",
  },
  {
    keys: ["e", "E", "]", "["],
    show: "e or ], E or [",
    what: "exposure up, down by half a stop; the range of signed colours follows",
  },
  { keys: ["f"], show: "f", what: "false colour with a logarithmic scale" },
  { keys: ["c"], show: "c", what: "crops of all views about the cursor" },
  { keys: ["r"], show: "r", what: "reset zoom, exposure, wipe" },
  { keys: ["?"], show: "?", what: "these keys" },
];

/** What a key asks of the comparer: the name of one of its actions and what goes with it; null: not ours. */
export function actionOf(event) {
  if (event.ctrlKey || event.metaKey || event.altKey) return null;
  const { key, shiftKey } = event;
  if (/^[1-9]$/.test(key)) return ["show", Number(key) - 1];
  const arrow = { ArrowLeft: [-1, 0], ArrowRight: [1, 0], ArrowUp: [0, -1], ArrowDown: [0, 1] }[key];
  if (arrow && shiftKey && arrow[0]) return ["moveWipe", arrow[0] * 0.05];
  if (arrow) return ["pan", arrow];
  const cursor = { i: [0, -1], j: [-1, 0], k: [0, 1], l: [1, 0] }[key.toLowerCase()];
  if (cursor) return ["moveCursor", cursor.map((step) => step * (shiftKey ? 10 : 1))];
  switch (key) {
    case "t":
    case "0":
      return ["showTruth"];
    case "d":
      return ["toggleError"];
    case ".":
      return ["step", 1];
    case ",":
      return ["step", -1];
    case "w":
      return ["toggleWipe"];
    case "x":
      return ["swap"];
    case "+":
    case "=":
      return ["zoomBy", 2];
    case "-":
    case "_":
      return ["zoomBy", 0.5];
    case "e":
    case "]":
      return ["expose", 0.5];
    case "E":
    case "[":
      return ["expose", -0.5];
    case "f":
      return ["toggleFalse"];
    case "c":
      return ["toggleCrops"];
    case "r":
      return ["reset"];
    case "?":
      return ["toggleKeys"];
    default:
      return null;
  }
}
