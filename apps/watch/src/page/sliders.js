// Sliders of parameters, initial state and inputs. Values that were not changed by hand follow the spec.

const GROUPS = { parameters: "parameters", initial: "initial state", inputs: "inputs" };
/** Digits of a value set by a slider. */
const DIGITS = 3;

class Sliders {
  constructor(changed) {
    this.changed = changed;
    this.own = new Map();
    this.knobs = [];
    at("reset").addEventListener("click", () => {
      this.own.clear();
      for (const knob of this.knobs) knob.put(knob.value);
      this.tell();
    });
    at("end").addEventListener("input", () => this.end() > 0 && this.changed());
  }

  end() {
    return at("end").valueAsNumber;
  }

  tell() {
    at("reset").disabled = this.own.size === 0;
    this.changed();
  }

  show(groups) {
    const known = new Set();
    const focused = document.activeElement?.id;
    at("knobs").replaceChildren();
    this.knobs = [];
    for (const [group, heading] of Object.entries(GROUPS)) {
      if (!groups[group].length) continue;
      const set = element(at("knobs"), "fieldset");
      element(set, "legend", heading);
      for (const quantity of groups[group]) {
        known.add(`${group}.${quantity.name}`);
        this.knobs.push(this.knob(set, group, quantity));
      }
    }
    for (const key of this.own.keys()) if (!known.has(key)) this.own.delete(key);
    at("reset").disabled = this.own.size === 0;
    at(focused)?.focus();
  }

  /** A slider with an input field; inputs also accept expressions in t, states and parameters. */
  knob(parent, group, { name, about, unit, value, low, high }) {
    const key = `${group}.${name}`;
    const row = element(parent, "div", "", "knob");
    row.title = about;
    const label = element(row, "label", name);
    const slider = element(row, "input");
    Object.assign(slider, { type: "range", min: low, max: high, step: "any", id: `${key}.slider` });
    const field = element(row, "input");
    Object.assign(field, { type: "text", id: key, spellcheck: false, autocomplete: "off" });
    label.htmlFor = key;
    slider.setAttribute("aria-label", `${name} ${unit}`);
    element(row, "small", unit);
    const put = (text) => {
      field.value = text;
      if (Number.isFinite(Number(text))) slider.value = text;
      row.classList.toggle("own", this.own.has(key));
    };
    const take = (text) => {
      if (text.trim() === "" || text === String(value)) this.own.delete(key);
      else this.own.set(key, text);
      row.classList.toggle("own", this.own.has(key));
      this.tell();
    };
    slider.addEventListener("input", () => {
      field.value = String(Number(slider.valueAsNumber.toPrecision(DIGITS)));
      take(field.value);
    });
    field.addEventListener("change", () => {
      put(field.value.trim() || String(value));
      take(field.value);
    });
    row.addEventListener("dblclick", () => {
      this.own.delete(key);
      put(String(value));
      this.tell();
    });
    put(this.own.get(key) ?? String(value));
    return { put, value: String(value) };
  }

  /** Values that differ from the spec, by group. */
  values() {
    const values = { parameters: {}, initial: {}, inputs: {} };
    for (const [key, text] of this.own) {
      const dot = key.indexOf(".");
      values[key.slice(0, dot)][key.slice(dot + 1)] = text;
    }
    return values;
  }
}
