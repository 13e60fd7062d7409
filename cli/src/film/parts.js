// Parts of a picture in space: rods, wheels, balls, springs, arrows, axes, traces, the ground.

const UP = new THREE.Vector3(0, 1, 0);

/** A lit surface in the colour of a role. */
function surface(role, options = {}) {
  const material = new THREE.MeshLambertMaterial({ fog: false, ...options });
  colours.follow((palette) => material.color.set(palette[role]));
  return material;
}

function glass(role, opacity, side = THREE.FrontSide) {
  return surface(role, { transparent: true, opacity, depthWrite: false, side });
}

/** A thin line, which no distance makes vanish. */
function stroke(role, fog = false) {
  const material = new THREE.LineBasicMaterial({ fog });
  colours.follow((palette) => material.color.set(palette[role]));
  return material;
}

function mesh(geometry, material, parent) {
  const made = new THREE.Mesh(geometry, material);
  parent?.add(made);
  return made;
}

/** A cylinder of length 1 along y from the origin. */
function cylinder(radius, sides = 12) {
  return new THREE.CylinderGeometry(radius, radius, 1, sides).translate(0, 0.5, 0);
}

/** Lays a part that is made along y from one place to another; hides it where there is no way. */
function span(part, from, to) {
  const way = to.clone().sub(from);
  const length = way.length();
  part.visible = Number.isFinite(length) && length > 0;
  if (!part.visible) return;
  part.position.copy(from);
  part.quaternion.setFromUnitVectors(UP, way.divideScalar(length));
  part.scale.y = length;
}

function rod(size) {
  return mesh(cylinder(0.011 * size), surface("rod"));
}

/** A spring: a coil of length 1 along y. */
function coil(size) {
  const windings = 9;
  class Helix extends THREE.Curve {
    getPoint(s, out = new THREE.Vector3()) {
      const angle = 2 * Math.PI * windings * s;
      const radius = s > 0.06 && s < 0.94 ? 0.03 * size : 0;
      return out.set(radius * Math.cos(angle), s, radius * Math.sin(angle));
    }
  }
  return mesh(new THREE.TubeGeometry(new Helix(), 20 * windings, 0.006 * size, 5), surface("spring"));
}

/** A damper: a cylinder over half of its length, a rod over all of it. */
function damper(size) {
  const part = new THREE.Group();
  mesh(cylinder(0.008 * size), surface("spring"), part);
  mesh(cylinder(0.022 * size), surface("spring"), part).scale.y = 0.5;
  return part;
}

/** A disc with a tyre, and spokes of which one is marked so that its turning is seen. */
function wheel({ hub, axis, radius }) {
  const part = new THREE.Group();
  const tyre = 0.045 * radius;
  mesh(new THREE.TorusGeometry(radius - tyre, tyre, 10, 56), surface("tyre"), part);
  mesh(new THREE.CircleGeometry(radius - tyre, 48), glass("disc", 0.16, THREE.DoubleSide), part);
  const [plain, marked] = [surface("spoke"), surface("mark")];
  const spokes = 8;
  for (let k = 0; k < spokes; k += 1) {
    const spoke = mesh(cylinder((k ? 0.012 : 0.024) * radius, 6), k ? plain : marked, part);
    spoke.rotation.z = (2 * Math.PI * k) / spokes;
    spoke.scale.y = radius - tyre;
  }
  const axle = mesh(new THREE.CylinderGeometry(0.07 * radius, 0.07 * radius, 0.12 * radius, 20), plain, part);
  axle.rotation.x = Math.PI / 2;
  part.position.set(...hub);
  part.quaternion.setFromUnitVectors(new THREE.Vector3(0, 0, 1), new THREE.Vector3(...axis));
  return part;
}

/** A ball with stripes, so that its turning is seen. */
function ball({ radius }) {
  const part = new THREE.Group();
  const sectors = 8;
  const colourings = [surface("disc"), surface("spoke"), surface("mark")];
  for (let k = 0; k < sectors; k += 1) {
    const [from, width] = [(2 * Math.PI * k) / sectors, (2 * Math.PI) / sectors];
    mesh(new THREE.SphereGeometry(radius, 6, 24, from, width), colourings[k ? k % 2 : 2], part);
  }
  return part;
}

/** The image of the unit ball under a linear map. */
function ellipsoid({ map: [a, b, c] }) {
  const part = mesh(new THREE.SphereGeometry(1, 32, 20), glass("body", 0.36));
  part.matrixAutoUpdate = false;
  part.matrix.set(...a, 0, ...b, 0, ...c, 0, 0, 0, 0, 1);
  return part;
}

const SHAPES = { wheel, ball, ellipsoid };

/** An arrow; `aim` lays its tail at a place. */
function arrow(role, size) {
  const part = new THREE.Group();
  const [shaft, head] = [0.009 * size, 0.09 * size];
  const material = surface(role);
  const line = mesh(cylinder(shaft, 8), material, part);
  const tip = mesh(new THREE.ConeGeometry(0.03 * size, head, 14).translate(0, -head / 2, 0), material, part);
  part.aim = (from, force) => {
    const length = force.length();
    part.visible = Number.isFinite(length + from.x + from.y + from.z) && length > 0.02 * size;
    if (!part.visible) return;
    part.position.copy(from);
    part.quaternion.setFromUnitVectors(UP, force.clone().divideScalar(length));
    line.scale.y = Math.max(length - head / 2, 1e-6 * size);
    tip.position.y = length;
    tip.scale.setScalar(Math.min(1, length / head));
  };
  return part;
}

/** Three axes of a frame. */
function triad(size) {
  const part = new THREE.Group();
  const axes = { x: [1, 0, 0], y: [0, 1, 0], z: [0, 0, 1] };
  for (const [name, axis] of Object.entries(axes)) {
    const line = mesh(cylinder(0.007 * size, 6), surface(name), part);
    line.quaternion.setFromUnitVectors(UP, new THREE.Vector3(...axis));
    line.scale.y = 0.28 * size;
  }
  return part;
}

/** The way of a point: a line and around it a thin tube with three sides, row by row. */
function trace(point, size) {
  const sides = 3;
  const radius = 0.008 * size;
  const centres = new Float32Array(3 * film.rows);
  const corners = new Float32Array(3 * sides * film.rows);
  const faces = [];
  const [place, last, way] = [new THREE.Vector3(), new THREE.Vector3(), new THREE.Vector3(1, 0, 0)];
  const [normal, aside] = [new THREE.Vector3(), new THREE.Vector3()];
  const any = new THREE.Vector3(0.36, 0.48, 0.8);
  for (let row = 0; row < film.rows; row += 1) {
    placeAt(point, { low: row, high: row, part: 0 }, place);
    if (!isFiniteVector(place)) place.copy(last);
    if (row && place.distanceTo(last) > 1e-4 * size) way.subVectors(place, last).normalize();
    last.copy(place);
    place.toArray(centres, 3 * row);
    normal.crossVectors(way, any).normalize();
    aside.crossVectors(way, normal);
    for (let k = 0; k < sides; k += 1) {
      const angle = (2 * Math.PI * k) / sides;
      const [cos, sin] = [radius * Math.cos(angle), radius * Math.sin(angle)];
      const corner = place.clone().addScaledVector(normal, cos).addScaledVector(aside, sin);
      corner.toArray(corners, 3 * (sides * row + k));
      if (!row) continue;
      const [a, b] = [sides * (row - 1) + k, sides * (row - 1) + ((k + 1) % sides)];
      faces.push(a, a + sides, b, b, a + sides, b + sides);
    }
  }
  const line = new THREE.BufferGeometry();
  line.setAttribute("position", new THREE.BufferAttribute(centres, 3));
  const tube = new THREE.BufferGeometry();
  tube.setAttribute("position", new THREE.BufferAttribute(corners, 3));
  tube.setIndex(faces);
  const material = new THREE.MeshBasicMaterial({ fog: false, side: THREE.DoubleSide });
  colours.follow((palette) => material.color.set(palette.trace));
  const part = new THREE.Group();
  part.add(new THREE.Line(line, stroke("trace")), mesh(tube, material));
  for (const child of part.children) child.frustumCulled = false;
  part.upTo = (row) => {
    line.setDrawRange(0, row + 1);
    tube.setDrawRange(0, 6 * sides * row);
  };
  return part;
}

/** Squares of the ground about its middle, every fifth line stronger. */
function ground(step, [a, b]) {
  const part = new THREE.Group();
  const [far, piece] = [30, 10];
  const lines = { grid: [], line: [] };
  for (let k = -far; k <= far; k += 1) {
    for (const [along, across] of [[a, b], [b, a]]) {
      // In pieces, because the fading of a line is that of its ends.
      for (let from = -far; from < far; from += piece) {
        for (const end of [from, from + piece]) {
          const corner = along.clone().multiplyScalar(k * step).addScaledVector(across, end * step);
          lines[k % 5 ? "grid" : "line"].push(...corner.toArray());
        }
      }
    }
  }
  for (const [role, places] of Object.entries(lines)) {
    const geometry = new THREE.BufferGeometry();
    geometry.setAttribute("position", new THREE.BufferAttribute(new Float32Array(places), 3));
    part.add(new THREE.LineSegments(geometry, stroke(role, true)));
  }
  return part;
}
