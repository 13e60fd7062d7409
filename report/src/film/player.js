// The player: time, keys, buttons and the rendering loop.

const SPEEDS = [0.1, 0.25, 0.5, 1, 2, 4];
/** A longer interval between frames counts as a pause, in s. */
const LONGEST = 0.25;
/** Refresh interval of displayed numbers, in s. */
const READABLE = 0.1;
/** A lower frame rate looks jerky. */
const SLOW = 50;
/** Lower bound on the resolution relative to the screen. */
const COARSEST = 0.5;

class Player {
  constructor() {
    this.time = film.start;
    this.playing = false;
    this.changed = true;
    this.pictures = 0;
    this.fineness = 1;
    this.recent = [];
    at("title").textContent = film.title;
    at("source").textContent = film.source ?? "";
    at("space").setAttribute("aria-label", `${film.title}, moving in space`);
    if (film.ending) this.say(`The motion ends early: ${film.ending}`, 8000);
    this.values = new Values((column) => this.choose(column));
    this.strip = new Strip((t) => this.seek(t));
    this.prepareSpace();
    this.prepareControls();
    this.choose(mostCurious());
    colours.use(colours.theme);
  }

  /** The picture in space; without WebGL the rest of the page still works. */
  prepareSpace() {
    const without = "Values and plots are shown without it.";
    const name = Painter.name();
    if (!name) {
      this.say(`This browser offers no WebGL 2, which the picture in space needs. ${without}`);
      return;
    }
    const canvas = at("space");
    try {
      this.painter = new Painter(canvas, name, {
        lost: () => this.say("The browser has stopped drawing in space. The picture returns by itself or on reload."),
        restored: () => {
          at("message").hidden = true;
          this.changed = true;
        },
      });
    } catch (cause) {
      this.say(`The picture in space cannot be drawn: ${cause.message} ${without}`);
      return;
    }
    this.stage = new Stage();
    this.eye = new Eye(canvas, this.stage);
    this.names = new Names(this.stage);
    fillLegend(this.stage);
    new ResizeObserver(() => this.fit()).observe(at("stage"));
    this.fit();
    canvas.addEventListener("dblclick", () => this.eye.reset(at("follow").checked));
    colours.follow(() => (this.changed = true));
  }

  /** Shows another motion of the same parts with the same view and time. */
  renew() {
    if (!film.rows) return;
    if (this.stage) {
      this.stage = new Stage();
      this.eye.stage = this.stage;
      at("legend").replaceChildren();
      fillLegend(this.stage);
      this.trace();
    }
    const slider = at("slider");
    [slider.min, slider.max] = [film.start, film.end];
    this.strip.paint();
    this.seek(this.time);
  }

  prepareControls() {
    const choice = (list, text, value) => Object.assign(element(at(list), "option", text), { value });
    for (const speed of SPEEDS) choice("speed", `${speed} ×`, speed);
    at("speed").value = 1;
    if (film.contacts.length) choice("trace", "contacts", "contacts");
    choice("trace", "none", "none");
    film.points.forEach(({ name }, point) => choice("trace", name, point));
    // Without a contact, the trace is that of the last point of the description.
    if (!film.contacts.length) at("trace").value = film.points.length - 1;
    at("trace").addEventListener("change", () => this.trace());
    this.trace();
    at("follow").checked = Boolean(this.stage?.travels);
    at("follow").addEventListener("change", () => this.eye?.reset(at("follow").checked));
    for (const box of ["forces", "points", "axes", "follow"]) {
      at(box).addEventListener("change", () => (this.changed = true));
    }
    const slider = at("slider");
    [slider.min, slider.max] = [film.start, film.end];
    slider.addEventListener("input", () => this.seek(slider.valueAsNumber));
    at("play").addEventListener("click", () => this.play(!this.playing));
    at("theme").addEventListener("click", () => colours.use(colours.theme === "dark" ? "light" : "dark"));
    colours.follow(() => (at("theme").textContent = colours.theme === "dark" ? "light" : "dark"));
    addEventListener("keydown", (event) => this.key(event));
  }

  say(text, milliseconds) {
    at("message").textContent = text;
    at("message").hidden = false;
    if (milliseconds) setTimeout(() => (at("message").hidden = true), milliseconds);
  }

  trace() {
    const { value } = at("trace");
    const points = value === "contacts" ? film.contacts : value === "none" ? [] : [Number(value)];
    this.stage?.draw(points);
    this.changed = true;
  }

  choose(column) {
    this.values.choose(column);
    this.strip.choose(column);
  }

  play(playing) {
    if (playing && this.time >= film.end) this.time = film.start;
    this.playing = playing && film.end > film.start;
    at("play").textContent = this.playing ? "pause" : "play";
    if (this.stage && this.fineness < 1) this.fit();
    this.recent = [];
    at("rate").textContent = "";
    this.changed = true;
  }

  seek(t) {
    this.time = Math.min(Math.max(t, film.start), film.end);
    this.changed = true;
  }

  step(rows) {
    this.play(false);
    const { low, high, part } = instantAt(this.time);
    const row = (part > 0.5 ? high : low) + rows;
    this.seek(film.times[Math.min(Math.max(row, 0), film.rows - 1)]);
  }

  key(event) {
    const typing = event.target.closest?.("select");
    if (typing || event.ctrlKey || event.metaKey || event.altKey) return;
    const sign = { ArrowLeft: -1, ArrowRight: 1 }[event.key];
    const actions = {
      Home: () => this.seek(film.start),
      End: () => this.seek(film.end),
      "+": () => this.eye?.zoom(0.85),
      "-": () => this.eye?.zoom(1 / 0.85),
      f: () => at("follow").click(),
    };
    // A focused button or box handles the space bar itself.
    if (event.key === " " && event.target.closest?.("button, input[type=checkbox]") === null) {
      actions[" "] = () => this.play(!this.playing);
    }
    const action = sign
      ? () => (event.shiftKey ? this.seek(this.time + 0.1 * sign) : this.step(sign))
      : actions[event.key];
    if (!action) return;
    event.preventDefault();
    action();
  }

  fit() {
    [this.width, this.height] = [at("stage").clientWidth, at("stage").clientHeight];
    // A still picture is drawn at full resolution.
    const fineness = this.playing ? this.fineness : 1;
    this.painter.fit(this.width, this.height, Math.min(devicePixelRatio, 2) * fineness);
    this.changed = true;
  }

  /** Advances the time by the seconds since the last frame. */
  advance(seconds) {
    if (!this.playing) return;
    this.time += seconds * Number(at("speed").value);
    if (this.time > film.end) {
      const repeats = at("repeat").checked;
      this.time = repeats ? film.start : film.end;
      if (!repeats) this.play(false);
    }
    this.changed = true;
  }

  picture(now) {
    const seconds = this.last === undefined ? 0 : (now - this.last) / 1000;
    this.last = now;
    this.count(now);
    this.advance(Math.min(seconds, LONGEST));
    if (this.changed || this.eye?.changed) this.show();
  }

  show() {
    this.changed = false;
    const instant = instantAt(this.time);
    if (this.stage) {
      this.stage.show(instant, { forces: at("forces").checked, axes: at("axes").checked });
      this.eye.target = at("follow").checked ? this.stage.middle(instant) : this.stage.whole.middle;
      this.eye.look(this.width, this.height);
      this.painter.paint(this.stage, this.eye);
      this.names.show(instant, this.eye, this.width, this.height, at("points").checked);
    }
    this.strip.show(this.time);
    if (this.playing && this.last - this.told < 1000 * READABLE) return;
    this.told = this.last;
    this.values.show(instant);
    at("time").textContent = `t = ${this.time.toFixed(3)} s`;
    at("slider").value = this.time;
    at("slider").setAttribute("aria-valuetext", `${this.time.toFixed(2)} s`);
  }

  /** Measures the frame rate; a slow machine gets a coarser resolution. */
  count(now) {
    this.pictures += 1;
    this.recent.push(now);
    while (this.recent[0] < now - 1000) this.recent.shift();
    if (this.pictures % 30 || now - this.recent[0] < 900) return;
    const rate = this.recent.length - 1;
    at("rate").textContent = this.playing ? `${rate} pictures/s` : "";
    if (this.playing && this.stage && rate < SLOW && this.fineness > COARSEST) {
      this.fineness *= 0.8;
      this.fit();
    }
  }
}

/** The column plotted first: an input, else a coordinate that changes. */
function mostCurious() {
  const changes = (column) => {
    const value = (row) => film.values[row * film.columns.length + column];
    return film.times.some((_, row) => value(row) !== value(0));
  };
  const of = (wanted) => film.columns.findIndex(({ group }, column) => group === wanted && changes(column));
  return Math.max(0, ["inputs", "coordinates"].map(of).find((column) => column >= 0) ?? 0);
}

/** Shows the page, and gives scripts access to the time, the playing state, the frame rate and point positions. */
function start() {
  if (!film.rows) {
    colours.use(colours.theme);
    at("message").textContent = "The motion has no row.";
    at("message").hidden = false;
    return null;
  }
  const player = new Player();
  globalThis.appell = {
    get time() {
      return player.time;
    },
    get playing() {
      return player.playing;
    },
    get pictures() {
      return player.pictures;
    },
    /** Frames in the last second. */
    get rate() {
      return player.recent.length - 1;
    },
    place(name) {
      const point = film.points.findIndex((candidate) => candidate.name === name);
      return placeAt(point, instantAt(player.time));
    },
  };
  player.play(!matchMedia("(prefers-reduced-motion: reduce)").matches);
  const next = (now) => {
    player.picture(now);
    requestAnimationFrame(next);
  };
  requestAnimationFrame(next);
  return player;
}

const motion = JSON.parse(at("film").textContent);
if (motion) {
  take(motion);
  start();
} else {
  listen();
}
