// The derivation, each equation with the lines of the spec that it depends on.

class Equations {
  constructor(choose) {
    this.panel = at("equations");
    this.rows = [];
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
      this.headings[target.value]?.scrollIntoView({ block: "start" });
    });
  }

  show({ html }) {
    const place = this.rows.length ? this.panel.scrollTop : null;
    const section = at("section").value;
    this.panel.innerHTML = html;
    this.rows = [...this.panel.querySelectorAll("[data-lines]")];
    for (const row of this.rows) {
      // An equation of several lines is one stop of the keyboard.
      if (row.matches("tr, .first")) row.tabIndex = 0;
    }
    this.headings = [...this.panel.querySelectorAll("h2")];
    const options = this.headings.map((heading, index) => new Option(heading.textContent, index));
    at("section").replaceChildren(...options);
    if (place === null) this.showFirst();
    else [this.panel.scrollTop, at("section").value] = [place, section];
  }

  /** What the derivation ends with is looked at first. */
  showFirst() {
    const first = this.headings.findIndex(({ textContent }) => textContent === "Equations of motion");
    at("section").value = Math.max(first, 0);
    this.headings[first]?.scrollIntoView({ block: "start" });
  }

  /** Marks the equations that depend on one of these lines, or one with all its lines. */
  mark(lines, { only = null, scroll = false } = {}) {
    const all = this.rows.filter((row) => linesOf(row).some((line) => lines.has(line)));
    const chosen = only ? this.sameAs(only) : all;
    for (const row of this.rows) row.classList.toggle("chosen", chosen.includes(row));
    if (scroll) chosen.at(0)?.scrollIntoView({ block: "nearest" });
    return chosen.length;
  }

  /** The lines of an equation that is written in several. */
  sameAs(row) {
    const all = [row];
    let first = row;
    while (!first.matches("tr, .first") && first.previousElementSibling) {
      first = first.previousElementSibling;
      all.push(first);
    }
    for (let next = row.nextElementSibling; next && !next.matches("tr, .first"); next = next.nextElementSibling) {
      all.push(next);
    }
    return all;
  }
}

const linesOf = (row) => row.dataset.lines.split(" ").map(Number);
