// The side panel: legend, values, one quantity over time.

const at = (id) => document.getElementById(id);

function element(parent, tag, text = "") {
  const made = document.createElement(tag);
  made.textContent = text;
  parent.append(made);
  return made;
}

/** The meaning of the colours, and the scale of lengths. */
function fillLegend(stage) {
  const entry = (role, text) => {
    const row = document.createElement("li");
    const sample = document.createElement("i");
    if (role) sample.style.background = `var(--${role})`;
    row.append(...(role ? [sample] : []), text);
    at("legend").append(row);
  };
  entry(null, `squares of ${+stage.step.toPrecision(1)} m`);
  const kinds = new Set(film.bodies.map(({ shape }) => shape.kind));
  if (kinds.has("wheel") || kinds.has("ball")) entry("wheel", "rolling body through its contact");
  if (kinds.has("ellipsoid")) entry("body", "homogeneous ellipsoid of a body's inertia");
  if (film.links.some(({ kind }) => kind === "spring" || kind === "damper")) entry("spring", "spring, damper");
  entry("trace", "trace");
  const forces = { reaction: "constraint force", load: "applied force", weight: "weight" };
  if (!stage.force) return;
  for (const [kind, about] of Object.entries(forces)) {
    if (film.forces.some((force) => force.kind === kind)) entry(kind, about);
  }
  entry(null, `an arrow of 1 m is ${+stage.force.metre.toPrecision(1)} N`);
}

/** All columns with their present values; a click plots one over time. */
class Values {
  constructor(choose) {
    this.cells = [];
    this.buttons = film.columns.map((column, index) => {
      if (column.group !== film.columns[index - 1]?.group) element(at("values"), "h2", column.group);
      const button = element(at("values"), "button");
      button.type = "button";
      button.title = column.about;
      element(button, "span", column.name);
      this.cells.push(element(button, "b"));
      element(button, "small", column.unit);
      button.addEventListener("click", () => choose(index));
      return button;
    });
  }

  choose(chosen) {
    this.buttons.forEach((button, index) => button.setAttribute("aria-pressed", String(index === chosen)));
  }

  show(instant) {
    this.cells.forEach((cell, index) => {
      const text = shown(valueAt(index, instant));
      if (cell.textContent !== text) cell.textContent = text;
    });
  }
}

/** One quantity over time, with a mark at each event and a cursor at the time shown. */
class Strip {
  constructor(seek) {
    this.field = at("field");
    this.column = 0;
    const pointed = (event) => {
      const { left, width } = this.field.getBoundingClientRect();
      const part = Math.min(Math.max((event.clientX - left) / width, 0), 1);
      seek(film.start + part * (film.end - film.start));
    };
    this.field.addEventListener("pointerdown", (event) => {
      this.field.setPointerCapture(event.pointerId);
      pointed(event);
    });
    this.field.addEventListener("pointermove", (event) => event.buttons && pointed(event));
    new ResizeObserver(() => this.paint()).observe(this.field);
    colours.follow(() => this.paint());
  }

  choose(column) {
    this.column = column;
    this.paint();
  }

  position(t) {
    return (t - film.start) / (film.end - film.start || 1);
  }

  paint() {
    const { name, unit } = film.columns[this.column] ?? {};
    if (!name) return;
    const [width, height, ratio] = [this.field.clientWidth, this.field.clientHeight, devicePixelRatio];
    const canvas = at("plot");
    [canvas.width, canvas.height] = [width * ratio, height * ratio];
    const values = Array.from(film.times, (_, row) => film.values[row * film.columns.length + this.column]);
    const finite = values.filter(Number.isFinite);
    const [low, high] = [Math.min(...finite), Math.max(...finite)];
    at("quantity").textContent = unit ? `${name} / ${unit}` : name;
    at("top").textContent = shown(high);
    at("bottom").textContent = shown(low);
    const pen = canvas.getContext("2d");
    pen.scale(ratio, ratio);
    pen.strokeStyle = getComputedStyle(document.documentElement).getPropertyValue("--reaction");
    pen.setLineDash([3, 3]);
    pen.beginPath();
    for (const { t } of film.events) {
      const x = this.position(t) * width;
      pen.moveTo(x, 0);
      pen.lineTo(x, height);
    }
    pen.stroke();
    pen.setLineDash([]);
    pen.strokeStyle = colours.now.plot;
    pen.lineWidth = 1.6;
    pen.beginPath();
    let down = false;
    const margin = 4;
    values.forEach((value, row) => {
      const x = this.position(film.times[row]) * width;
      const part = high > low ? (value - low) / (high - low) : 0.5;
      const y = height - margin - part * (height - 2 * margin);
      if (Number.isFinite(y)) pen[down ? "lineTo" : "moveTo"](x, y);
      down = Number.isFinite(y);
    });
    pen.stroke();
  }

  show(t) {
    at("cursor").style.transform = `translateX(${(this.position(t) * this.field.clientWidth).toFixed(1)}px)`;
  }
}
