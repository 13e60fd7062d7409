// The mechanism in space: every part of the film, laid where it is at an instant.

/** Points that belong to the mechanism, not only to its description. */
function ownPoints() {
  const linked = film.links.filter(({ kind }) => kind !== "way").flatMap(({ ends }) => ends);
  const centres = film.points.flatMap((point, id) => (point.body ? [id] : []));
  const own = [...new Set([...linked, ...centres, ...film.contacts])];
  return own.length ? own : film.points.map((_, id) => id);
}

/** The smallest box about points over rows. */
function boxOf(points, rows) {
  const box = new THREE.Box3();
  const place = new THREE.Vector3();
  for (const row of rows) {
    for (const point of points) {
      placeAt(point, { low: row, high: row, part: 0 }, place);
      if (isFiniteVector(place)) box.expandByPoint(place);
    }
  }
  return box;
}

/** How long a force of 1 N is drawn, in m: the largest but a few as long as the mechanism. */
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
    this.scene = new THREE.Scene();
    this.scene.background = new THREE.Color();
    this.scene.fog = new THREE.Fog(0, 1, 2);
    colours.follow(({ paper }) => {
      this.scene.background.set(paper);
      this.scene.fog.color.set(paper);
    });
    this.vertical = new THREE.Vector3(...film.view.vertical);
    const side = new THREE.Vector3(...film.view.floor);
    this.floor = [side, new THREE.Vector3().crossVectors(this.vertical, side)];
    this.measure();
    this.light();
    this.build();
  }

  /** How large the mechanism is, and how far it goes. */
  measure() {
    this.own = ownPoints();
    this.tracked = film.points.flatMap((point, id) => (point.body ? [id] : []));
    if (!this.tracked.length) this.tracked = this.own;
    const radii = film.bodies.map(({ shape }) => shape.radius ?? 0);
    const first = boxOf(this.own, [0]);
    const across = first.isEmpty() ? 0 : first.getSize(new THREE.Vector3()).length();
    this.size = Math.max(across, 2 * Math.max(0, ...radii)) || 1;
    const rows = Array.from(film.times.keys());
    this.whole = boxOf(this.own, rows);
    if (this.whole.isEmpty()) this.whole.expandByPoint(new THREE.Vector3());
    this.whole.expandByScalar(Math.max(0.1 * this.size, ...radii));
    const travel = boxOf(this.tracked, rows);
    this.travels = !travel.isEmpty() && travel.getSize(new THREE.Vector3()).length() > 2.5 * this.size;
    this.level = this.groundLevel(rows);
    this.step = roundNumber(this.size / 2.5);
    this.force = forceScale(this.size);
  }

  /** The height of the ground: that of the contacts, else below everything. */
  groundLevel(rows) {
    const touching = film.contacts.length > 0;
    const box = touching ? boxOf(film.contacts, [0]) : boxOf(this.own, rows);
    if (box.isEmpty()) return 0;
    const lowest = Math.min(box.min.dot(this.vertical), box.max.dot(this.vertical));
    return touching ? lowest : lowest - 0.1 * this.size;
  }

  light() {
    const sky = new THREE.HemisphereLight(0xffffff, 0xb8bcc4, 2.2);
    sky.position.copy(this.vertical);
    const sun = new THREE.DirectionalLight(0xffffff, 1.4);
    sun.position.set(1, -2, 3);
    this.scene.add(sky, sun);
  }

  build() {
    const { scene, size } = this;
    this.ground = ground(this.step, this.floor);
    scene.add(this.ground);
    this.frames = film.bodies.map((body) => {
      const part = new THREE.Group();
      part.add(SHAPES[body.shape.kind](body.shape));
      scene.add(part);
      return { part, point: body.centre, frame: body.frame };
    });
    const makers = { rod, spring: coil, damper };
    const drawn = film.links.filter(({ kind }) => kind in makers);
    this.links = drawn.map(({ kind, ends }) => ({ part: makers[kind](size), ends }));
    this.dots = this.own.map((point) => {
      const { mass } = film.points[point];
      const radius = (mass ? 0.042 : 0.018) * size;
      return { part: mesh(new THREE.SphereGeometry(radius, 18, 12), surface(mass ? "mass" : "point")), point };
    });
    this.arrows = film.forces.map(({ kind, at }, force) => ({ part: arrow(kind, size), at, force }));
    const seated = film.frames.flatMap(({ at }, frame) => (at === null ? [] : [{ point: at, frame }]));
    this.axes = seated.map(({ point, frame }) => ({ part: triad(size), point, frame }));
    for (const { part } of [...this.links, ...this.dots, ...this.arrows, ...this.axes]) scene.add(part);
    this.traces = [];
  }

  /** Draws the ways of these points from now on. */
  draw(points) {
    for (const part of this.traces) {
      this.scene.remove(part);
      for (const { geometry } of part.children) geometry.dispose();
    }
    this.traces = points.map((point) => trace(point, this.size));
    this.scene.add(...this.traces);
  }

  /** The middle of the bodies. */
  middle(instant, out) {
    const place = new THREE.Vector3();
    let count = 0;
    out.set(0, 0, 0);
    for (const point of this.tracked) {
      placeAt(point, instant, place);
      if (!isFiniteVector(place)) continue;
      out.add(place);
      count += 1;
    }
    return out.divideScalar(count || 1);
  }

  /** Lays every part where it is. */
  show(instant, { forces, axes }) {
    const [a, b] = [new THREE.Vector3(), new THREE.Vector3()];
    for (const { part, point, frame } of this.frames) {
      placeAt(point, instant, part.position);
      turnAt(frame, instant, part.quaternion);
      part.visible = isFiniteVector(part.position) && Number.isFinite(part.quaternion.w);
    }
    for (const { part, ends } of this.links) span(part, placeAt(ends[0], instant, a), placeAt(ends[1], instant, b));
    for (const { part, point } of this.dots) {
      placeAt(point, instant, part.position);
      part.visible = isFiniteVector(part.position);
    }
    for (const { part, at, force } of this.arrows) {
      part.visible = false;
      if (!forces || !this.force) continue;
      part.aim(placeAt(at, instant, a), arrowAt(force, instant, b).divideScalar(this.force.metre));
    }
    for (const { part, point, frame } of this.axes) {
      placeAt(point, instant, part.position);
      turnAt(frame, instant, part.quaternion);
      part.visible = axes && isFiniteVector(part.position) && Number.isFinite(part.quaternion.w);
    }
    for (const part of this.traces) part.upTo(instant.part > 0.5 ? instant.high : instant.low);
  }

  /** Keeps the squares of the ground around a place, and lets them fade towards the horizon. */
  spread(around, distance) {
    const [a, b] = this.floor;
    const period = 5 * this.step;
    const snapped = (axis) => Math.round(around.dot(axis) / period) * period;
    this.ground.position
      .copy(this.vertical).multiplyScalar(this.level)
      .addScaledVector(a, snapped(a)).addScaledVector(b, snapped(b));
    this.scene.fog.near = distance;
    this.scene.fog.far = distance + 24 * this.step;
  }
}
