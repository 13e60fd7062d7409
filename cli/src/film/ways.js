// The pass that draws the ways of points: bands that face the eye and never get thinner than a pixel.

const WAY_CORNERS = `
layout(location = 0) in vec3 place;
layout(location = 1) in vec3 along;
uniform mat4 clip;
uniform vec3 eye;
uniform float radius;
/** The width of a pixel one metre before the eye. */
uniform float pixel;
void main() {
  vec3 from = place - eye;
  float distance = length(from);
  float broad = max(radius, 0.5 * pixel * distance);
  vec3 aside = cross(along, from);
  float apart = length(aside);
  if (apart > 0.0) from += ((gl_VertexID & 1) == 0 ? broad : -broad) / apart * aside;
  // As near as the side of a tube that the eye sees.
  if (distance > 4.0 * broad) from *= 1.0 - broad / distance;
  gl_Position = clip * vec4(from, 1);
}`;

const WAY_COLOURS = `
uniform vec3 colour;
out vec4 shown;
void main() {
  shown = vec4(colour, 1);
}`;

class Ways {
  /** Bytes of a place and the direction there. */
  static STRIDE = 24;

  constructor(gl) {
    this.gl = gl;
    this.program = new Program(gl, WAY_CORNERS, WAY_COLOURS);
    this.array = gl.createVertexArray();
    this.buffers = new Map();
  }

  /** Buffers for these ways and for no others. */
  keep(ways) {
    const { gl, buffers } = this;
    for (const [old, buffer] of buffers) {
      if (ways.includes(old)) continue;
      gl.deleteBuffer(buffer);
      buffers.delete(old);
    }
    for (const way of ways) {
      if (!buffers.has(way)) buffers.set(way, filled(gl, gl.ARRAY_BUFFER, way.corners));
    }
  }

  draw(ways, eye, radius, colour) {
    const { gl } = this;
    this.keep(ways);
    this.program.use({ clip: eye.clip, eye: eye.place, radius, pixel: eye.pixel, colour: channels(colour) });
    gl.bindVertexArray(this.array);
    for (const way of ways) {
      gl.bindBuffer(gl.ARRAY_BUFFER, this.buffers.get(way));
      attribute(gl, 0, 3, { stride: Ways.STRIDE });
      attribute(gl, 1, 3, { stride: Ways.STRIDE, offset: Ways.STRIDE / 2 });
      gl.drawArrays(gl.TRIANGLE_STRIP, 0, 2 * way.rows);
    }
  }
}
