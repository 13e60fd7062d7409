// The shapes of which parts are composed, in unit dimensions: triangles with normals.

/** Thickness of a tyre, relative to its mean radius. */
const TYRE = 0.047;
/** Length of a spring, in the units of its other dimensions. */
const COIL = 0.5;

/**
 * A surface over a grid: `point` gives position and normal for both parameters from 0 to 1.
 * Triangles face the normals.
 */
function sheet(columns, rows, point) {
  const places = [];
  const normals = [];
  for (let j = 0; j <= rows; j += 1) {
    for (let i = 0; i <= columns; i += 1) {
      const [place, normal] = point(i / columns, j / rows);
      places.push(place);
      normals.push(normal);
    }
  }
  const faces = [];
  const face = (a, b, c) => {
    const front = cross(minus(places[b], places[a]), minus(places[c], places[a]));
    const side = dot(front, plus(plus(normals[a], normals[b]), normals[c]));
    if (side) faces.push(a, ...(side > 0 ? [b, c] : [c, b]));
  };
  for (let j = 0; j < rows; j += 1) {
    for (let i = 0; i < columns; i += 1) {
      const [a, b] = [j, j + 1].map((row) => row * (columns + 1) + i);
      face(a, a + 1, b);
      face(b, a + 1, b + 1);
    }
  }
  return { places, normals, faces };
}

function joined(...sheets) {
  const all = { places: [], normals: [], faces: [] };
  for (const { places, normals, faces } of sheets) {
    const before = all.places.length;
    all.places.push(...places);
    all.normals.push(...normals);
    all.faces.push(...faces.map((corner) => corner + before));
  }
  return all;
}

/** The point of the unit circle about y at a fraction of a turn. */
function circle(part) {
  const angle = 2 * Math.PI * part;
  return [Math.cos(angle), 0, Math.sin(angle)];
}

/** A disc about y, visible from one side. */
const plate = (sides, radius, height, normal) =>
  sheet(sides, 1, (u, v) => [plus([0, height, 0], circle(u), radius * v), normal]);

/** Part of the unit ball about the poles on y. */
function globe(sectors, rings, part) {
  return sheet(sectors, rings, (u, v) => {
    const place = plus([0, Math.cos(Math.PI * v), 0], circle(part * u), Math.sin(Math.PI * v));
    return [place, place];
  });
}

/** A ring about y, with middle at radius 1. */
function ring() {
  return sheet(56, 10, (u, v) => {
    const [out, , up] = circle(v);
    const normal = plus([0, up, 0], circle(u), out);
    return [plus(circle(u), normal, TYRE), normal];
  });
}

/** A wire wound about y, with straight ends. */
function coil() {
  const windings = 9;
  const [radius, wire] = [0.03, 0.006];
  const ramp = (s) => Math.min(Math.max((s - 0.05) / 0.03, 0), 1);
  const middle = (s) => plus([0, COIL * s, 0], circle(windings * s), radius * ramp(s) * ramp(1 - s));
  return sheet(5, 24 * windings, (u, s) => {
    const way = unit(minus(middle(s + 1e-4), middle(s - 1e-4)));
    const across = unit(cross(way, circle(windings * s)));
    const [a, , b] = circle(u);
    const normal = plus(scaled(across, a), cross(across, way), b);
    return [plus(middle(s), normal, wire), normal];
  });
}

const SHAPES = {
  /** Of radius 1, from the origin to 1 along y. */
  cylinder: joined(
    sheet(14, 1, (u, v) => [plus([0, v, 0], circle(u)), circle(u)]),
    plate(14, 1, 0, [0, -1, 0]),
    plate(14, 1, 1, [0, 1, 0]),
  ),
  /** With its tip at the origin, down to -1 along y, where its radius is 1/3. */
  cone: joined(
    sheet(16, 1, (u, v) => [plus([0, -v, 0], circle(u), v / 3), unit(plus([0, 1, 0], circle(u), 3))]),
    plate(16, 1 / 3, -1, [0, -1, 0]),
  ),
  ball: globe(32, 20, 1),
  /** A small ball with fewer triangles. */
  dot: globe(18, 12, 1),
  /** An eighth of a ball. */
  sector: globe(6, 24, 1 / 8),
  ring: ring(),
  disc: joined(plate(48, 1, 0, [0, 1, 0]), plate(48, 1, 0, [0, -1, 0])),
  coil: coil(),
};
