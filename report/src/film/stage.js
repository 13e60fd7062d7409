// The mechanism in space: the pose of every part at an instant.

/** Points of the mechanism, without construction points. */
function ownPoints() {
  const linked = film.links.filter(({ kind }) => kind !== "way").flatMap(({ ends }) => ends);
  const centres = film.points.flatMap((point, id) => (point.body ? [id] : []));
  const own = [...new Set([...linked, ...centres, ...film.contacts])];
  return own.length ? own : film.points.map((_, id) => id);
}

/** The smallest box about points over rows. */
function boxOf(points, rows) {
  const box = new Box();
  for (const row of rows) {
    for (const point of points) box.add(placeAt(point, { low: row, high: row, part: 0 }));
  }
  return box;
}

/** Newtons per metre of an arrow, from the 98 % quantile of the forces. */
function forceScale(size) {
  const forces = film.arrows.length / 3;
  const sizes = [];
  for (let k = 0; k < forces; k += 1) {
    const length = Math.hypot(...film.arrows.subarray(3 * k, 3 * k + 3));
    if (Number.isFinite(length) && length > 0) sizes.push(length);
  }
  sizes.sort((a, b) => a - b);
  const large = sizes[Math.floor(0.98 * (sizes.length - 1))];
  return large ? { metre: roundNumber((3 * large) / size) } : null;
}

class Stage {
  constructor() {
    this.vertical = film.view.vertical;
    this.floor = [film.view.floor, cross(this.vertical, film.view.floor)];
    this.measure();
    this.build();
  }

  /** Size of the mechanism, and the extent of its motion. */
  measure() {
    this.own = ownPoints();
    this.tracked = film.points.flatMap((point, id) => (point.body ? [id] : []));
    if (!this.tracked.length) this.tracked = this.own;
    const radii = film.bodies.map(({ shape }) => shape.radius ?? 0);
    const first = boxOf(this.own, [0]);
    this.size = Math.max(first.diagonal, 2 * Math.max(0, ...radii)) || 1;
    const rows = Array.from(film.times.keys());
    this.whole = boxOf(this.own, rows);
    if (this.whole.empty) this.whole.add(ZERO);
    this.whole.widen(Math.max(0.1 * this.size, ...radii));
    this.travels = boxOf(this.tracked, rows).diagonal > 2.5 * this.size;
    this.level = this.groundLevel(rows);
    this.step = roundNumber(this.size / 2.5);
    this.force = forceScale(this.size);
  }

  /** The height of the ground: that of the contacts, else the lowest point. */
  groundLevel(rows) {
    const touching = film.contacts.length > 0;
    const box = touching ? boxOf(film.contacts, [0]) : boxOf(this.own, rows);
    if (box.empty) return 0;
    const lowest = Math.min(dot(box.low, this.vertical), dot(box.high, this.vertical));
    return touching ? lowest : lowest - 0.1 * this.size;
  }

  build() {
    const { size } = this;
    this.bodies = film.bodies.map(({ shape, centre, frame }) => {
      return { part: BODIES[shape.kind](shape), at: centre, frame };
    });
    const links = film.links.filter(({ kind }) => kind in LINKS);
    this.links = links.map(({ kind, ends }) => ({ part: LINKS[kind](size), ends }));
    this.dots = this.own.map((point) => {
      const [role, radius] = film.points[point].mass ? ["mass", 0.042] : ["point", 0.018];
      return { part: dotOf(role, radius * size), at: point };
    });
    this.arrows = film.forces.map(({ kind, at }, force) => ({ part: arrow(kind), at, force }));
    const seated = film.frames.flatMap(({ at }, frame) => (at === null ? [] : [{ at, frame }]));
    this.axes = seated.map(({ at, frame }) => ({ part: triad(size), at, frame }));
    this.traces = [];
  }

  /** Everything with a surface. */
  parts() {
    const { bodies, links, dots, arrows, axes } = this;
    return [bodies, links, dots, arrows, axes].flat().map(({ part }) => part);
  }

  /** Selects the points whose traces are drawn. */
  draw(points) {
    this.traces = points.map((point) => trace(point, this.size));
  }

  /** The middle of the bodies. */
  middle(instant) {
    const places = this.tracked.map((point) => placeAt(point, instant)).filter(isFiniteVector);
    const sum = places.reduce((sum, place) => plus(sum, place), ZERO);
    return scaled(sum, 1 / (places.length || 1));
  }

  /** Poses every part. */
  show(instant, { forces, axes }) {
    for (const { part, at, frame } of [...this.bodies, ...this.axes]) {
      part.map = turned(turnAt(frame, instant), placeAt(at, instant));
      part.shown = isFiniteVector(part.map.at) && isFiniteVector(part.map.x);
    }
    for (const { part } of this.axes) part.shown &&= axes;
    for (const { part, ends } of this.links) span(part, ...ends.map((end) => placeAt(end, instant)));
    for (const { part, at } of this.dots) {
      part.map = { ...SAME, at: placeAt(at, instant) };
      part.shown = isFiniteVector(part.map.at);
    }
    for (const { part, at, force } of this.arrows) {
      part.shown = false;
      if (!forces || !this.force) continue;
      aim(part, placeAt(at, instant), scaled(arrowAt(force, instant), 1 / this.force.metre), this.size);
    }
    for (const trace of this.traces) trace.rows = 1 + (instant.part > 0.5 ? instant.high : instant.low);
  }

  /** Centres the squares of the ground at a point and lets them fade towards the horizon. */
  spread(around, distance) {
    const { floor: [a, b], step } = this;
    const period = 5 * step;
    const snapped = (axis) => Math.round(dot(around, axis) / period) * period;
    this.ground = {
      middle: plus(plus(scaled(this.vertical, this.level), a, snapped(a)), b, snapped(b)),
      sides: [scaled(a, step), scaled(b, step)],
      near: distance,
      far: distance + 24 * step,
    };
  }
}
