// Simulations: requested one at a time, shown as an animation and as plots.

/** A pending request is aborted after this time, in ms. */
const SLOW = 400;

class Motion {
  constructor(wanted, shown) {
    this.wanted = wanted;
    this.shown = shown;
    this.window = crypto.getRandomValues(new Uint32Array(1))[0];
    this.frame = at("film");
    this.parts = "";
    this.stamp = 0;
    this.load();
    addEventListener("message", ({ source, data }) => {
      if (source !== this.frame.contentWindow) return;
      if (data.ready) {
        this.ready = true;
        this.send();
      } else if (data.shown) this.shown(data.shown);
    });
  }

  /** Loads an empty frame, which signals when it is ready. */
  load() {
    this.ready = false;
    this.frame.src = "motion.html";
  }

  /** Requests the simulation with the present values; a pending request is aborted only if it is slow. */
  async ask() {
    if (this.asking && performance.now() - this.since < SLOW) {
      this.again = true;
      return;
    }
    this.asking?.abort();
    const asking = new AbortController();
    [this.asking, this.since, this.again] = [asking, performance.now(), false];
    const body = JSON.stringify({ window: this.window, ...this.wanted() });
    try {
      const answer = await fetch("motion", { method: "POST", body, signal: asking.signal });
      if (asking === this.asking) {
        if (answer.ok) this.show(await answer.json());
        else if (answer.status === 422) this.refuse(await answer.text());
        else if (answer.status !== 409) this.refuse(`The server answers ${answer.status}.`);
      }
    } catch (cause) {
      if (cause.name !== "AbortError") this.refuse("The server has ended.");
    }
    if (asking !== this.asking) return;
    this.asking = null;
    if (this.again) this.ask();
  }

  refuse(reason) {
    at("ending").textContent = reason;
    at("motion").classList.add("stale");
  }

  show({ version, ending, film, figure }) {
    // The final state is in the tooltip.
    at("ending").textContent = ending ? `The motion ends early: ${ending.split("; state:")[0]}` : "";
    at("ending").title = ending ?? "";
    at("motion").classList.remove("stale");
    this.stamp += 1;
    this.film = { ...film, stamp: { number: this.stamp, version } };
    const parts = partsOf(film);
    if (this.parts && parts !== this.parts) this.load();
    this.parts = parts;
    if (this.ready) this.send();
    this.figure = figure;
    this.plot();
  }

  /** Plots are drawn only while their panel is open. */
  plot() {
    if (this.figure && !at("plots").hidden) at("plots").querySelector("img").src = imageOf(this.figure);
  }

  send() {
    // The sandboxed frame has an opaque origin.
    if (this.film) this.frame.contentWindow.postMessage(this.film, "*");
  }
}

/** The structure that a frame is built for; sizes and positions may change in it. */
function partsOf({ title, points, frames, links, bodies, forces, contacts, columns, view }) {
  const kinds = bodies.map(({ name, centre, frame, shape }) => [name, centre, frame, shape.kind]);
  return JSON.stringify([title, points, frames, links, kinds, forces, contacts, columns, view.flat]);
}

const imageOf = (svg) => `data:image/svg+xml,${encodeURIComponent(svg)}`;
