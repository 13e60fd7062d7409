// The equations of motion and their derivation, each equation with the lines of the spec that it depends on.

class Equations {
  constructor(choose) {
    /** The newest text of each section. */
    this.texts = new Map();
    this.lines = new Set();
    this.panels = [at("equations"), at("derivation")];
    for (const panel of this.panels) this.listen(panel, choose);
    at("section").addEventListener("change", ({ target }) => {
      at(`derivation-${target.value}`)?.scrollIntoView({ block: "start" });
    });
  }

  listen(panel, choose) {
    const chosen = ({ target }) => {
      const row = target.closest("[data-lines]");
      if (row) choose(linesOf(row), row);
    };
    panel.addEventListener("click", chosen);
    panel.addEventListener("keydown", (event) => {
      if (event.key !== "Enter" && event.key !== " ") return;
      event.preventDefault();
      chosen(event);
    });
  }

  /** Shows the equations of motion at once. */
  show({ sections }) {
    sections.forEach((section, index) => this.put("equations", index, section));
  }

  /** Adds the sections of the derivation, which may be long, in idle time. */
  derive({ sections, version }) {
    this.version = version;
    const next = (index) => {
      if (this.version !== version) return;
      if (index === sections.length) this.list(index);
      else {
        this.put("derivation", index, sections[index]);
        requestIdleCallback(() => next(index + 1), { timeout: 500 });
      }
    };
    next(0);
  }

  /** An unchanged section is not replaced. */
  put(panel, index, text) {
    const id = `${panel}-${index}`;
    if (this.texts.get(id) === text) return;
    this.texts.set(id, text);
    const section = at(id) ?? Object.assign(element(at(panel), "section"), { id });
    section.innerHTML = text;
    for (const row of section.querySelectorAll("[data-lines]")) {
      // An equation of several lines is one tab stop.
      if (row.matches("tr, .first")) row.tabIndex = 0;
    }
    this.mark(this.lines, { within: section });
  }

  /** Lists the headings of the derivation and removes surplus sections. */
  list(count) {
    for (let index = count; at(`derivation-${index}`); index += 1) {
      at(`derivation-${index}`).remove();
      this.texts.delete(`derivation-${index}`);
    }
    const { value } = at("section");
    const headings = [...at("derivation").querySelectorAll("h2")];
    const options = headings.map((heading, index) => new Option(heading.textContent, index));
    at("section").replaceChildren(...options);
    at("section").value = options[value] ? value : 0;
  }

  /** Marks the equations that depend on one of these lines, or one with all its lines; returns their number. */
  mark(lines, { only = null, scroll = false, within = at("shown") } = {}) {
    this.lines = only ? new Set() : lines;
    const own = only && sameAs(only);
    const chosen = [];
    for (const row of within.querySelectorAll("[data-lines]")) {
      const is = own ? own.includes(row) : linesOf(row).some((line) => lines.has(line));
      row.classList.toggle("chosen", is);
      if (is) chosen.push(row);
    }
    if (scroll) this.scrollTo(chosen);
    return chosen.filter((row) => row.matches("mtr.first")).length;
  }

  /** Scrolls to one of these in the open panel, unless one is visible already. */
  scrollTo(rows) {
    const panel = this.panels.find(({ hidden }) => !hidden);
    const here = rows.filter((row) => panel?.contains(row));
    if (here.length && !here.some((row) => isSeen(row, panel))) here[0].scrollIntoView({ block: "nearest" });
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
