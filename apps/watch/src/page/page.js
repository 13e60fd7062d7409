// The page: receives the events of the server and connects its parts.

/** Parts shown, for measurements: by part, its version and its time of arrival in ms since 1970. */
const seen = {};

function see(part, version) {
  seen[part] = { version, at: performance.timeOrigin + performance.now() };
}

const spec = new Spec(chooseLine);
const equations = new Equations(chooseEquation);
const sliders = new Sliders(() => motion.ask());
const motion = new Motion(
  () => ({ end: sliders.end(), ...sliders.values() }),
  ({ version, number }) => {
    see("motion", version);
    seen.motion.number = number;
  },
);
const state = { text: 0, model: 0, asked: 0, broken: false, errors: 0 };

function chooseLine(line) {
  const first = [...spec.items].find(([from, to]) => from <= line && line <= to)?.[0] ?? line;
  const count = equations.mark(new Set([first]), { scroll: true });
  spec.mark([first], { current: line, scroll: true });
  say(count ? `Line ${line}: ${count} equations depend on it.` : `No equation depends on line ${line}.`);
}

function chooseEquation(lines, row) {
  equations.mark(new Set(lines), { only: row });
  spec.mark(lines, { scroll: true });
  say(`The equation depends on ${lines.length} definitions.`);
}

function say(text) {
  at("status").textContent = text;
}

function tellState() {
  document.body.classList.toggle("broken", state.broken);
  const errors = state.errors === 1 ? "1 error" : `${state.errors} errors`;
  if (!state.broken) say(`version ${state.text}`);
  else if (state.model) say(`${errors}; equations and motion are those of the last good version`);
  else say(errors);
}

const shows = {
  text(part) {
    state.text = part.version;
    document.title = part.file;
    spec.show(part);
  },
  findings({ list, broken }) {
    state.broken = broken;
    state.errors = list.filter(({ severity }) => severity === "error").length;
    spec.find(list);
    tellState();
  },
  equations(part) {
    equations.show(part);
  },
  derivation(part) {
    equations.derive(part);
  },
  drawing({ svg }) {
    at("drawing").querySelector("img").src = imageOf(svg);
  },
  model({ title, version, knobs, note }) {
    state.model = version;
    read();
    at("title").textContent = title;
    at("title").title = note ?? "";
    sliders.show(knobs);
    motion.ask();
  },
};

/** Requests the derivation of the newest model when its panel is open; the other parts do not wait for it. */
function read() {
  if (at("derivation").hidden || state.asked === state.model) return;
  state.asked = state.model;
  fetch("derivation", { method: "POST" }).catch(() => (state.asked = 0));
}

/** Shows the panel of a tab. */
function open(name) {
  for (const tab of document.querySelectorAll("[role=tab]")) {
    const is = tab.id === `tab-${name}`;
    tab.setAttribute("aria-selected", String(is));
    tab.tabIndex = is ? 0 : -1;
    at(tab.getAttribute("aria-controls")).hidden = !is;
  }
  at("section").hidden = name !== "derivation";
  motion.plot();
  read();
}

at("tabs").addEventListener("click", ({ target }) => {
  const tab = target.closest("[role=tab]");
  if (tab) open(tab.getAttribute("aria-controls"));
});
at("tabs").addEventListener("keydown", ({ key, target }) => {
  const step = { ArrowLeft: -1, ArrowRight: 1 }[key];
  const tabs = [...document.querySelectorAll("[role=tab]")];
  const place = tabs.indexOf(target);
  if (!step || place < 0) return;
  const next = tabs[(place + step + tabs.length) % tabs.length];
  open(next.getAttribute("aria-controls"));
  next.focus();
});
open("equations");

const server = new EventSource("events");
for (const [part, show] of Object.entries(shows)) {
  server.addEventListener(part, ({ data }) => {
    const told = JSON.parse(data);
    show(told);
    see(part, told.version);
  });
}
server.addEventListener("error", () => {
  document.body.classList.add("lost");
  say("The server does not answer; the page goes on when it does.");
});
server.addEventListener("open", () => {
  document.body.classList.remove("lost");
  tellState();
});
globalThis.appell = { seen, spec, equations, sliders, motion };
