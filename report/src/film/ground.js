// The pass that draws the ground: squares that fade towards the horizon.

/** Lines on each side of the middle. */
const REACH = 30;
const LINES = 2 * REACH + 1;
/** Pieces of a line: some drivers lose one that begins behind the camera. */
const PIECES = 12;

const GROUND_CORNERS = `
uniform mat4 clip;
uniform vec3 middle;
uniform vec3 a;
uniform vec3 b;
uniform vec3 weak;
uniform vec3 strong;
out vec3 colour;
out float depth;
void main() {
  // Two corners make a piece; lines along b come after those along a.
  int piece = gl_VertexID / 2;
  int line = piece / ${PIECES};
  int number = line % ${LINES} - ${REACH};
  int end = (piece % ${PIECES} + gl_VertexID % 2) * ${(2 * REACH) / PIECES} - ${REACH};
  ivec2 corner = line < ${LINES} ? ivec2(end, number) : ivec2(number, end);
  colour = number % 5 == 0 ? strong : weak;
  gl_Position = clip * vec4(middle + float(corner.x) * a + float(corner.y) * b, 1);
  depth = gl_Position.w;
}`;

const GROUND_COLOURS = `
uniform float near;
uniform float far;
in vec3 colour;
in float depth;
out vec4 shown;
void main() {
  shown = vec4(colour, 1.0 - smoothstep(near, far, depth));
}`;

class Ground {
  constructor(gl) {
    this.gl = gl;
    this.program = new Program(gl, GROUND_CORNERS, GROUND_COLOURS);
  }

  draw({ middle, sides: [a, b], near, far }, eye, palette) {
    const { gl } = this;
    const [weak, strong] = [channels(palette.grid), channels(palette.line)];
    this.program.use({ clip: eye.clip, middle: minus(middle, eye.place), a, b, near, far, weak, strong });
    gl.bindVertexArray(null);
    gl.drawArrays(gl.LINES, 0, 2 * PIECES * 2 * LINES);
  }
}
