// The equations of motion and their derivation, each equation with the lines of the spec that it depends on.

class Equations {
  constructor(choose) {
    this.panel = at("equations");
    /** The newest text of each section. */
    this.texts = new Map();
    this.chosen = { lines: new Set(), only: null };
    const chosen = ({ target }) => {
      const row = target.closest("[data-lines]");
      if (row) choose(linesOf(row), row);
    };
    this.panel.addEventListener("click", chosen);
    this.panel.addEventListener("keydown", (event) => {
      if (event.key !== "Enter" && event.key !== " ") return;
      event.preventDefault();
      chosen(event);
    });
    at("section").addEventListener("change", ({ target }) => {
      this.headings()[target.value]?.scrollIntoView({ block: "start" });
    });
  }

  headings() {
    return [...this.panel.querySelectorAll("h2")];
  }

  /** What a spec is written for comes first and at once. */
  show({ sections }) {
    this.place("motion", sections);
    this.list();
  }

  /** The rest is long; it comes while nothing else is to be done. */
  derive({ sections, version }) {
    this.version = version;
    const motion = this.texts.get("motion-0")?.split("</h2>")[0];
    const rest = sections.filter((section) => section.split("</h2>")[0] !== motion);
    const next = (index) => {
      if (this.version !== version) return;
      if (index < rest.length) {
        this.put(`derivation-${index}`, rest[index]);
        requestIdleCallback(() => next(index + 1), { timeout: 500 });
        return;
      }
      this.drop("derivation", rest.length);
      this.list();
    };
    requestIdleCallback(() => next(0), { timeout: 500 });
  }

  place(name, sections) {
    sections.forEach((section, index) => this.put(`${name}-${index}`, section));
    this.drop(name, sections.length);
  }

  /** A section that says the same stays as it is. */
  put(id, text) {
    if (this.texts.get(id) === text) return;
    this.texts.set(id, text);
    const section = at(id) ?? Object.assign(element(this.panel, "section"), { id });
    section.innerHTML = text;
    for (const row of section.querySelectorAll("[data-lines]")) {
      // An equation of several lines is one stop of the keyboard.
      if (row.matches("tr, .first")) row.tabIndex = 0;
    }
    this.mark(this.chosen.lines, { within: section });
  }

  drop(name, count) {
    for (let index = count; at(`${name}-${index}`); index += 1) {
      at(`${name}-${index}`).remove();
      this.texts.delete(`${name}-${index}`);
    }
  }

  list() {
    const { value } = at("section");
    const options = this.headings().map((heading, index) => new Option(heading.textContent, index));
    at("section").replaceChildren(...options);
    at("section").value = at("section").options[value] ? value : 0;
  }

  /** Marks the equations that depend on one of these lines, or one with all its lines. */
  mark(lines, { only = null, scroll = false, within = this.panel } = {}) {
    this.chosen.lines = only ? new Set() : lines;
    const depends = (row) => linesOf(row).some((line) => lines.has(line));
    const own = only && sameAs(only);
    const chosen = [];
    for (const row of within.querySelectorAll("[data-lines]")) {
      const is = own ? own.includes(row) : depends(row);
      row.classList.toggle("chosen", is);
      if (is) chosen.push(row);
    }
    if (scroll && !chosen.some((row) => isSeen(row, this.panel))) chosen[0]?.scrollIntoView({ block: "nearest" });
    return chosen.filter((row) => row.matches("mtr.first")).length;
  }
}

const linesOf = (row) => row.dataset.lines.split(" ").map(Number);

/** All lines of an equation. */
function sameAs(row) {
  const all = [row];
  for (let first = row; !first.matches("tr, .first") && first.previousElementSibling; ) {
    first = first.previousElementSibling;
    all.push(first);
  }
  for (let next = row.nextElementSibling; next && !next.matches("tr, .first"); next = next.nextElementSibling) {
    all.push(next);
  }
  return all;
}

function isSeen(row, panel) {
  const [inner, outer] = [row.getBoundingClientRect(), panel.getBoundingClientRect()];
  return inner.top >= outer.top && inner.bottom <= outer.bottom;
}
