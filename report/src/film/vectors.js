// Vectors are arrays of three numbers; an affine map is three axes and an origin.

const plus = (a, b, times = 1) => [a[0] + times * b[0], a[1] + times * b[1], a[2] + times * b[2]];
const minus = (a, b) => plus(a, b, -1);
const scaled = (a, times) => [a[0] * times, a[1] * times, a[2] * times];
const dot = (a, b) => a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
const cross = (a, b) => [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]];
const lengthOf = (a) => Math.sqrt(dot(a, a));
const unit = (a) => scaled(a, 1 / (lengthOf(a) || 1));
const isFiniteVector = (a) => Number.isFinite(a[0] + a[1] + a[2]);

const ZERO = [0, 0, 0];
const SAME = { x: [1, 0, 0], y: [0, 1, 0], z: [0, 0, 1], at: ZERO };

const directed = ({ x, y, z }, v) => plus(plus(scaled(x, v[0]), y, v[1]), z, v[2]);

/** Composition: first the inner map, then the outer one. */
const composed = (outer, inner) => ({
  x: directed(outer, inner.x),
  y: directed(outer, inner.y),
  z: directed(outer, inner.z),
  at: plus(outer.at, directed(outer, inner.at)),
});

/** A map preceded by a scaling along its axes. */
const stretched = ({ x, y, z, at }, [a, b, c]) => ({ x: scaled(x, a), y: scaled(y, b), z: scaled(z, c), at });

/** The rotation by a unit quaternion x, y, z, w. */
function turned([x, y, z, w], at) {
  return {
    x: [1 - 2 * (y * y + z * z), 2 * (x * y + w * z), 2 * (x * z - w * y)],
    y: [2 * (x * y - w * z), 1 - 2 * (x * x + z * z), 2 * (y * z + w * x)],
    z: [2 * (x * z + w * y), 2 * (y * z - w * x), 1 - 2 * (x * x + y * y)],
    at,
  };
}

/** The shortest rotation that maps the y axis to a unit vector. */
function upright([a, b, c], at = ZERO) {
  // Straight down the shortest rotation is not unique: this one is about x.
  if (b < -0.999999) return { x: [1, 0, 0], y: [0, -1, 0], z: [0, 0, -1], at };
  const k = 1 / (1 + b);
  return { x: [1 - k * a * a, -a, -k * a * c], y: [a, b, c], z: [-k * a * c, -c, 1 - k * c * c], at };
}

/** The axis-aligned bounding box of points. */
class Box {
  constructor() {
    this.low = [Infinity, Infinity, Infinity];
    this.high = [-Infinity, -Infinity, -Infinity];
  }

  get empty() {
    return this.low[0] > this.high[0];
  }

  get middle() {
    return scaled(plus(this.low, this.high), 0.5);
  }

  get diagonal() {
    return this.empty ? 0 : lengthOf(minus(this.high, this.low));
  }

  add(place) {
    if (!isFiniteVector(place)) return;
    for (let k = 0; k < 3; k += 1) {
      this.low[k] = Math.min(this.low[k], place[k]);
      this.high[k] = Math.max(this.high[k], place[k]);
    }
  }

  widen(by) {
    this.low = this.low.map((low) => low - by);
    this.high = this.high.map((high) => high + by);
  }
}
