// The pass that draws solids: all instances of a shape at once, lit by sky and sun.

const SOLID_CORNERS = `
layout(location = 0) in vec3 place;
layout(location = 1) in vec3 normal;
layout(location = 2) in vec3 x;
layout(location = 3) in vec3 y;
layout(location = 4) in vec3 z;
layout(location = 5) in vec3 at;
layout(location = 6) in vec4 paint;
uniform mat4 clip;
out vec3 facing;
out vec4 colour;
void main() {
  // Normals transform by the cofactor matrix.
  facing = mat3(cross(y, z), cross(z, x), cross(x, y)) * normal;
  colour = paint;
  gl_Position = clip * vec4(mat3(x, y, z) * place + at, 1);
}`;

const SOLID_COLOURS = `
uniform vec3 vertical;
in vec3 facing;
in vec4 colour;
out vec4 shown;
const vec3 SUN = normalize(vec3(1, -2, 3));
const vec3 GROUND = vec3(0.479, 0.503, 0.552);
void main() {
  vec3 normal = normalize(facing);
  vec3 sky = 0.7 * mix(GROUND, vec3(1), 0.5 + 0.5 * dot(normal, vertical));
  float sun = 0.446 * max(dot(normal, SUN), 0.0);
  vec3 linear = colour.rgb * (sky + sun);
  // From linear light to sRGB.
  vec3 bright = 1.055 * pow(linear, vec3(1.0 / 2.4)) - 0.055;
  shown = vec4(mix(bright, 12.92 * linear, lessThan(linear, vec3(0.0031308))), colour.a);
}`;

/** Linear light of a colour 0xrrggbb given as sRGB. */
function lightOf(colour) {
  const light = (c) => (c < 0.04045 ? c / 12.92 : ((c + 0.055) / 1.055) ** 2.4);
  return channels(colour).map(light);
}

class Solids {
  /** Numbers of an instance: four vectors of its map, colour, opacity. */
  static WIDTH = 16;

  constructor(gl) {
    this.gl = gl;
    this.program = new Program(gl, SOLID_CORNERS, SOLID_COLOURS);
    this.shapes = Object.fromEntries(Object.entries(SHAPES).map(([name, shape]) => [name, this.stored(shape)]));
    this.pieces = gl.createBuffer();
  }

  stored({ places, normals, faces }) {
    const { gl } = this;
    const array = gl.createVertexArray();
    gl.bindVertexArray(array);
    [places, normals].forEach((vectors, location) => {
      filled(gl, gl.ARRAY_BUFFER, new Float32Array(vectors.flat()));
      attribute(gl, location, 3);
    });
    filled(gl, gl.ELEMENT_ARRAY_BUFFER, new Uint16Array(faces));
    return { array, count: faces.length };
  }

  /** Collects the instances of these parts: solid ones by shape, transparent ones from far to near. */
  lay(parts, eye, palette) {
    const solid = new Map();
    const glass = [];
    for (const part of parts) {
      if (!part.shown) continue;
      for (const { shape, role, opacity, map } of part.pieces) {
        const { x, y, z, at } = composed(part.map, map);
        // Relative to the camera single precision suffices, however far the mechanism travels.
        const from = minus(at, eye.place);
        const numbers = [...x, ...y, ...z, ...from, ...lightOf(palette[role]), opacity];
        if (opacity < 1) glass.push({ shape, numbers, distance: lengthOf(from) });
        else if (solid.has(shape)) solid.get(shape).push(numbers);
        else solid.set(shape, [numbers]);
      }
    }
    glass.sort((a, b) => b.distance - a.distance);
    const runs = [...solid].map(([shape, pieces]) => ({ shape, pieces, solid: true }));
    runs.push(...glass.map(({ shape, numbers }) => ({ shape, pieces: [numbers], solid: false })));
    this.runs = runs;
    const { gl } = this;
    gl.bindBuffer(gl.ARRAY_BUFFER, this.pieces);
    gl.bufferData(gl.ARRAY_BUFFER, new Float32Array(runs.flatMap(({ pieces }) => pieces.flat())), gl.STREAM_DRAW);
  }

  /** Draws the collected solid instances, or the transparent ones. */
  draw(solid, eye, vertical) {
    const { gl } = this;
    this.program.use({ clip: eye.clip, vertical });
    gl.bindBuffer(gl.ARRAY_BUFFER, this.pieces);
    const stride = 4 * Solids.WIDTH;
    let first = 0;
    for (const run of this.runs) {
      const { array, count } = this.shapes[run.shape];
      const start = first * stride;
      first += run.pieces.length;
      if (run.solid !== solid) continue;
      gl.bindVertexArray(array);
      for (let k = 0; k < 4; k += 1) {
        attribute(gl, 2 + k, 3, { stride, offset: start + 12 * k, perInstance: true });
      }
      attribute(gl, 6, 4, { stride, offset: start + 48, perInstance: true });
      gl.drawElementsInstanced(gl.TRIANGLES, count, gl.UNSIGNED_SHORT, 0, run.pieces.length);
    }
  }
}
