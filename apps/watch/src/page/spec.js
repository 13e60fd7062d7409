// The text of the spec, with findings at their positions and the selected lines.

const at = (id) => document.getElementById(id);

function element(parent, tag, text = "", name = "") {
  const made = document.createElement(tag);
  made.textContent = text;
  if (name) made.className = name;
  parent.append(made);
  return made;
}

/** Limit on the lines shown. */
const MOST_LINES = 5000;

class Spec {
  constructor(choose) {
    this.list = at("lines");
    this.rows = [];
    this.texts = [];
    this.items = new Map();
    this.version = 0;
    this.current = 0;
    this.list.addEventListener("click", ({ target }) => {
      const row = target.closest("li");
      if (row) choose(this.rows.indexOf(row) + 1);
    });
    this.list.addEventListener("keydown", (event) => {
      const steps = { ArrowUp: -1, ArrowDown: 1, PageUp: -20, PageDown: 20 };
      const step = steps[event.key];
      if (!step || event.altKey || event.ctrlKey || event.metaKey) return;
      event.preventDefault();
      choose(Math.min(Math.max(this.current + step, 1), this.rows.length));
    });
  }

  show({ text, items, version }) {
    this.version = version;
    this.items = new Map(Object.entries(items).map(([first, last]) => [Number(first), last]));
    const lines = text.replace(/\n$/, "").split("\n");
    this.texts = lines.slice(0, MOST_LINES);
    const place = this.list.scrollTop;
    this.list.replaceChildren();
    this.rows = this.texts.map((line, index) => {
      const row = element(this.list, "li");
      row.setAttribute("role", "option");
      row.id = `line-${index + 1}`;
      row.append(written(line, []));
      return row;
    });
    if (lines.length > MOST_LINES) element(this.list, "p", `${lines.length - MOST_LINES} more lines`, "soft");
    this.list.scrollTop = place;
  }

  /** Errors, warnings and notes: in a list above the text with links to the lines, and each below its line. */
  find(list) {
    at("findings").replaceChildren();
    const marks = new Map();
    const notes = new Map();
    for (const finding of list) {
      finding.places.forEach(({ at: [from, to], words }, index) => {
        const title = words || finding.message;
        const mark = { severity: index ? "aside" : finding.severity, title };
        for (let line = from[0]; line <= Math.min(to[0], this.rows.length); line += 1) {
          const start = line === from[0] ? from[1] : 0;
          const end = line === to[0] ? to[1] : this.texts[line - 1].length;
          marks.set(line, [...(marks.get(line) ?? []), { ...mark, start, end }]);
        }
      });
      const line = finding.places[0]?.at[0][0];
      const place = this.rows[line - 1] && line;
      if (place) notes.set(place, [...(notes.get(place) ?? []), finding]);
      this.entry(finding, place);
    }
    this.rows.forEach((row, index) => {
      const line = index + 1;
      if (!marks.has(line) && !row.dataset.marked) return;
      row.replaceChildren(written(this.texts[index], marks.get(line) ?? []));
      for (const finding of notes.get(line) ?? []) told(row, "div", finding);
      row.toggleAttribute("data-marked", marks.has(line));
    });
  }

  /** An entry of the list; a click scrolls to its line. */
  entry(finding, line) {
    const entry = element(at("findings"), "li");
    if (!line) {
      told(entry, "div", finding);
      return;
    }
    const { severity, message } = finding;
    const button = element(entry, "button", "", `finding ${severity}`);
    button.type = "button";
    element(button, "b", `${severity} in line ${line} `);
    button.append(message);
    button.addEventListener("click", () => this.lead(line));
  }

  /** Scrolls to a line and the findings below it. */
  lead(line) {
    const row = this.rows[line - 1];
    if (!row) return;
    this.mark([line], { current: line });
    row.scrollIntoView({ block: "center" });
    this.list.focus({ preventScroll: true });
  }

  /** All lines of the items that begin at these lines. */
  whole(lines) {
    return new Set(lines.flatMap((first) => {
      const last = this.items.get(first) ?? first;
      return Array.from({ length: last - first + 1 }, (_, k) => first + k);
    }));
  }

  mark(lines, { current = 0, scroll = false } = {}) {
    const chosen = this.whole(lines);
    this.current = current;
    this.rows.forEach((row, index) => {
      row.classList.toggle("chosen", chosen.has(index + 1));
      row.setAttribute("aria-selected", String(index + 1 === current));
    });
    const shown = this.rows[(current || Math.min(...chosen)) - 1];
    if (current && shown) this.list.setAttribute("aria-activedescendant", shown.id);
    else this.list.removeAttribute("aria-activedescendant");
    if (!scroll || !shown) return;
    this.rows[Math.max(...chosen) - 1]?.scrollIntoView({ block: "nearest" });
    shown.scrollIntoView({ block: "nearest" });
  }
}

/** A finding in words. */
function told(parent, tag, { severity, code, message, help }) {
  const note = element(parent, tag, "", `finding ${severity}`);
  element(note, "b", code ? `${severity}[${code}] ` : `${severity} `);
  note.append(message);
  if (help) element(note, "i", help);
}

/** A line with its header, comment and marks. */
function written(line, marks) {
  const code = document.createElement("code");
  const comment = commentOf(line);
  const cuts = new Set([0, line.length, comment]);
  for (const { start, end } of marks) cuts.add(Math.min(start, line.length)).add(Math.min(end, line.length));
  const places = [...cuts].sort((a, b) => a - b);
  places.slice(0, -1).forEach((from, k) => {
    const mark = marks.find(({ start, end }) => start <= from && places[k + 1] <= end);
    const part = element(code, mark ? "mark" : "span", line.slice(from, places[k + 1]));
    if (mark) Object.assign(part, { className: mark.severity, title: mark.title });
    if (from >= comment) part.classList.add("comment");
    else if (/^\s*\[/.test(line)) part.classList.add("heading");
  });
  // A finding at the end of the line has no character to mark: a blank is added.
  if (marks.length && !code.querySelector("mark")) element(code, "mark", " ", marks[0].severity);
  return code;
}

/** Column at which the comment of a line begins. */
function commentOf(line) {
  const found = /^(?:[^"'#]|"(?:[^"\\]|\\.)*"|'[^']*')*#/.exec(line);
  return found ? found[0].length - 1 : line.length;
}
