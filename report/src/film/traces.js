// The pass that draws the traces of points: bands that face the camera, at least a pixel wide.

const TRACE_CORNERS = `
layout(location = 0) in vec3 place;
layout(location = 1) in vec3 along;
uniform mat4 clip;
uniform vec3 eye;
uniform float radius;
/** Minimum width, one metre in front of the camera. */
uniform float pixel;
void main() {
  vec3 from = place - eye;
  float distance = length(from);
  float broad = max(radius, 0.5 * pixel * distance);
  vec3 aside = cross(along, from);
  float apart = length(aside);
  if (apart > 0.0) from += ((gl_VertexID & 1) == 0 ? broad : -broad) / apart * aside;
  // At the depth of the visible side of a tube.
  if (distance > 4.0 * broad) from *= 1.0 - broad / distance;
  gl_Position = clip * vec4(from, 1);
}`;

const TRACE_COLOURS = `
uniform vec3 colour;
out vec4 shown;
void main() {
  shown = vec4(colour, 1);
}`;

class Traces {
  /** Bytes of a position and the direction there. */
  static STRIDE = 24;

  constructor(gl) {
    this.gl = gl;
    this.program = new Program(gl, TRACE_CORNERS, TRACE_COLOURS);
    this.array = gl.createVertexArray();
    this.buffers = new Map();
  }

  /** Replaces the buffers by those of these traces. */
  keep(traces) {
    const { gl, buffers } = this;
    for (const [old, buffer] of buffers) {
      if (traces.includes(old)) continue;
      gl.deleteBuffer(buffer);
      buffers.delete(old);
    }
    for (const trace of traces) {
      if (!buffers.has(trace)) buffers.set(trace, filled(gl, gl.ARRAY_BUFFER, trace.corners));
    }
  }

  draw(traces, eye, radius, pixel, colour) {
    const { gl } = this;
    this.keep(traces);
    this.program.use({ clip: eye.clip, eye: eye.place, radius, pixel, colour: channels(colour) });
    gl.bindVertexArray(this.array);
    for (const trace of traces) {
      gl.bindBuffer(gl.ARRAY_BUFFER, this.buffers.get(trace));
      attribute(gl, 0, 3, { stride: Traces.STRIDE });
      attribute(gl, 1, 3, { stride: Traces.STRIDE, offset: Traces.STRIDE / 2 });
      gl.drawArrays(gl.TRIANGLE_STRIP, 0, 2 * trace.rows);
    }
  }
}
