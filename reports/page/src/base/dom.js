// Elements: h("p.note", {id: "x"}, "text", element, ...). No markup is ever parsed, so data cannot inject any.

export function h(spec, attributes, ...children) {
  const [tag, ...classes] = spec.split(".");
  const element = document.createElement(tag);
  if (classes.length) element.className = classes.join(" ");
  for (const [name, value] of Object.entries(attributes ?? {})) {
    if (value === null || value === undefined || value === false) continue;
    if (name.startsWith("on")) element.addEventListener(name.slice(2), value);
    else element.setAttribute(name, value === true ? "" : String(value));
  }
  append(element, children);
  return element;
}

export function append(element, children) {
  for (const child of children.flat(3)) {
    if (child === null || child === undefined || child === false) continue;
    element.append(child instanceof Node ? child : String(child));
  }
}

export function svg(tag, attributes, ...children) {
  const element = document.createElementNS("http://www.w3.org/2000/svg", tag);
  for (const [name, value] of Object.entries(attributes ?? {})) element.setAttribute(name, value);
  append(element, children);
  return element;
}

/** A <select> with its label. options: [{value, label}] or plain values; onchange gets the chosen value itself. */
export function select(label, options, value, onchange) {
  const items = options.map((option) =>
    option && typeof option === "object" ? option : { value: option, label: option },
  );
  const list = h(
    "select",
    { "aria-label": label, onchange: () => onchange(items[list.selectedIndex].value) },
    items.map((item) => h("option", { selected: item.value === value }, String(item.label))),
  );
  return h("label.control", {}, h("span", {}, label), list);
}

/** Text in which `names` between backticks are code. */
export const rich = (text) =>
  String(text)
    .split("`")
    .map((part, i) => (i % 2 ? h("code", {}, part) : part));

let serial = 0;
export const uniqueId = (prefix) => `${prefix}-${++serial}`;
