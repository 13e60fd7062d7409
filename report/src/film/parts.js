// Parts of the mechanism, made of shapes: rods, wheels, balls, springs, arrows, axes.

/** A shape in the colour of a role, placed in its part by a map. */
const piece = (shape, role, map = SAME, opacity = 1) => ({ shape, role, map, opacity });

/** Pieces that move together. */
const part = (...pieces) => ({ pieces, map: SAME, shown: true });

/** Maps a shape made from 0 to 1 along y onto a unit vector, with this thickness and length. */
const bar = (direction, thick, long, from = ZERO) => stretched(upright(direction, from), [thick, long, thick]);

const ball = (radius) => stretched(SAME, [radius, radius, radius]);

/** Places a part made along y between two points; hides it if they coincide. */
function span(part, from, to) {
  const step = minus(to, from);
  const length = lengthOf(step);
  part.shown = Number.isFinite(length) && length > 0;
  if (part.shown) part.map = bar(scaled(step, 1 / length), 1, length, from);
}

const rod = (size) => part(piece("cylinder", "rod", bar(SAME.y, 0.011 * size, 1)));

const spring = (size) => part(piece("coil", "spring", bar(SAME.y, size, 1 / COIL)));

/** A cylinder over half of its length, a rod over all of it. */
function damper(size) {
  const inside = piece("cylinder", "spring", bar(SAME.y, 0.008 * size, 1));
  return part(inside, piece("cylinder", "spring", bar(SAME.y, 0.022 * size, 0.5)));
}

/** A body of small size at a point. */
const dotOf = (role, radius) => part(piece("dot", role, ball(radius)));

/** A disc with a tyre and spokes, one of them marked to make rotation visible. */
function wheel({ hub, axis, radius }) {
  const seat = upright(axis, hub);
  const rim = radius / (1 + TYRE);
  const width = 0.12 * radius;
  const spokes = Array.from({ length: 8 }, (_, k) => {
    const [role, thick] = k ? ["spoke", 0.012] : ["mark", 0.024];
    return piece("cylinder", role, composed(seat, bar(circle(k / 8 - 1 / 4), thick * radius, rim)));
  });
  return part(
    piece("ring", "tyre", composed(seat, ball(rim))),
    piece("disc", "disc", composed(seat, ball(rim)), 0.16),
    piece("cylinder", "spoke", composed(seat, bar(SAME.y, 0.07 * radius, width, [0, -width / 2, 0]))),
    ...spokes,
  );
}

/** A ball with stripes to make rotation visible. */
function stripedBall({ radius }) {
  return part(...Array.from({ length: 8 }, (_, k) => {
    const [x, z] = [circle(k / 8), circle(k / 8 + 1 / 4)];
    const sector = stretched({ x, y: SAME.y, z, at: ZERO }, [radius, radius, radius]);
    return piece("sector", ["disc", "spoke", "mark"][k ? k % 2 : 2], sector);
  }));
}

/** The image of the unit ball under a linear map. */
function ellipsoid({ map: rows }) {
  const [x, y, z] = [0, 1, 2].map((column) => rows.map((row) => row[column]));
  return part(piece("ball", "body", { x, y, z, at: ZERO }, 0.36));
}

const BODIES = { wheel, ball: stripedBall, ellipsoid };
const LINKS = { rod, spring, damper };

const arrow = (role) => part(piece("cylinder", role), piece("cone", role));

/** Places an arrow with its tail at a point; hides it if it is too short to be seen. */
function aim(arrow, from, vector, size) {
  const length = lengthOf(vector);
  arrow.shown = isFiniteVector(from) && Number.isFinite(length) && length > 0.02 * size;
  if (!arrow.shown) return;
  const head = Math.min(0.09 * size, length);
  const [shaft, tip] = arrow.pieces;
  arrow.map = upright(scaled(vector, 1 / length), from);
  shaft.map = bar(SAME.y, 0.009 * size, Math.max(length - head / 2, 1e-6 * size));
  tip.map = { ...ball(head), at: [0, length, 0] };
}

/** The axes of a frame. */
const triad = (size) =>
  part(...["x", "y", "z"].map((axis) => piece("cylinder", axis, bar(SAME[axis], 0.007 * size, 0.28 * size))));

/**
 * The trace of a point, row by row: two corners of a band, each a position and the direction there. A row without
 * a position repeats the previous one, at the start the next one.
 */
function trace(point, size) {
  const places = Array.from({ length: film.rows }, (_, row) => placeAt(point, { low: row, high: row, part: 0 }));
  let last = places.find(isFiniteVector) ?? ZERO;
  const known = places.map((place) => (last = isFiniteVector(place) ? place : last));
  const corners = new Float32Array(12 * film.rows);
  let along = SAME.x;
  known.forEach((place, row) => {
    const step = minus(known[row + 1] ?? place, known[row - 1] ?? place);
    if (lengthOf(step) > 1e-5 * size) along = unit(step);
    for (const corner of [0, 6]) corners.set([...place, ...along], 12 * row + corner);
  });
  return { corners, rows: 0 };
}
