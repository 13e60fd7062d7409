// The film: the data of the animation, interpolated in time.

const film = {};

/** Replaces the data of the motion. */
function take(data) {
  Object.assign(film, data);
  for (const name of ["times", "positions", "turns", "arrows", "values"]) {
    const bytes = Uint8Array.from(atob(film[name]), (digit) => digit.charCodeAt(0));
    film[name] = new Float32Array(bytes.buffer);
  }
  film.rows = film.times.length;
  film.start = film.rows ? film.times[0] : 0;
  film.end = film.rows ? film.times[film.rows - 1] : 0;
}

/** The rows on both sides of a time, and the interpolation fraction. */
function instantAt(t) {
  let [low, high] = [0, film.rows - 1];
  while (high - low > 1) {
    const middle = (low + high) >> 1;
    if (film.times[middle] <= t) low = middle;
    else high = middle;
  }
  const span = film.times[high] - film.times[low];
  const part = span > 0 ? Math.min(Math.max((t - film.times[low]) / span, 0), 1) : 0;
  return { low, high, part };
}

/** Interpolates numbers between two rows; `width` numbers make a row. */
function numberAt(numbers, width, column, { low, high, part }) {
  const [a, b] = [numbers[low * width + column], numbers[high * width + column]];
  // At a row its value counts, even if the next one is not finite.
  return part === 0 ? a : a + part * (b - a);
}

function vectorAt(numbers, count, index, instant) {
  const component = (k) => numberAt(numbers, 3 * count, 3 * index + k, instant);
  return [component(0), component(1), component(2)];
}

const placeAt = (point, instant) => vectorAt(film.positions, film.points.length, point, instant);
const arrowAt = (force, instant) => vectorAt(film.arrows, film.forces.length, force, instant);
const valueAt = (column, instant) => numberAt(film.values, film.columns.length, column, instant);

/** The rotation of a frame, a unit quaternion: along the shorter arc between two rows. */
function turnAt(frame, { low, high, part }) {
  const width = 4 * film.frames.length;
  const of = (row, k) => film.turns[row * width + 4 * frame + k];
  const along = [0, 1, 2, 3].reduce((sum, k) => sum + of(low, k) * of(high, k), 0);
  const sign = along < 0 ? -1 : 1;
  const component = (k) => (part === 0 ? of(low, k) : of(low, k) * (1 - part) + sign * of(high, k) * part);
  const turn = [0, 1, 2, 3].map(component);
  const length = Math.hypot(...turn);
  return turn.map((number) => number / length);
}

/** The largest of 1, 2, 5, 10, … that is not larger. */
function roundNumber(value) {
  const power = 10 ** Math.floor(Math.log10(value));
  return [5, 2].map((step) => step * power).find((step) => step <= value) ?? power;
}

/** A number for display. */
function shown(value) {
  if (!Number.isFinite(value)) return "—";
  const size = Math.abs(value);
  if (size === 0) return "0";
  if (size >= 1e5 || size < 1e-4) return value.toExponential(3);
  return value.toPrecision(5);
}
