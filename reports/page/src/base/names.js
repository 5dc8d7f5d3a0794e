// Full names have every parameter spelt; on the page a name is as short as it can be and still be told from the others.

/** "scene:plate:ior=1.5,thickness=0.2" -> {base: "scene:plate", parameters: ["ior=1.5", "thickness=0.2"]} */
export function parse(name) {
  const parts = String(name).split(":");
  const last = parts[parts.length - 1];
  if (parts.length > 1 && last.includes("="))
    return { base: parts.slice(0, -1).join(":"), parameters: last.split(",") };
  return { base: parts.join(":"), parameters: [] };
}

/** Map from full name to short: the base, and those parameters in which names of one base differ. */
export function shorten(names) {
  const bases = new Map();
  for (const name of names) {
    const parsed = parse(name);
    if (!bases.has(parsed.base)) bases.set(parsed.base, new Map());
    bases.get(parsed.base).set(name, parsed.parameters);
  }
  const short = new Map();
  for (const [base, members] of bases) {
    const lists = [...members.values()];
    const common = (parameter) => lists.every((parameters) => parameters.includes(parameter));
    for (const [name, parameters] of members) {
      const own = lists.length > 1 ? parameters.filter((parameter) => !common(parameter)) : [];
      short.set(name, own.length ? `${base}:${own.join(",")}` : base);
    }
  }
  return short;
}

/** The names of one kind in a report: short, and each with a number that gives it its colour and symbol. */
export class Names {
  constructor(names) {
    this.full = [...new Set(names.filter((name) => typeof name === "string" && name))];
    this.map = shorten(this.full);
  }

  short(name) {
    return name === null || name === undefined ? "–" : (this.map.get(name) ?? String(name));
  }

  index(name) {
    return this.full.indexOf(name);
  }
}
