// Draws the stage with WebGL 2, pass by pass.

class Painter {
  /** Name of the WebGL renderer; nothing without one. */
  static name() {
    const gl = document.createElement("canvas").getContext("webgl2");
    const names = gl?.getExtension("WEBGL_debug_renderer_info");
    const name = gl && String(gl.getParameter(names?.UNMASKED_RENDERER_WEBGL ?? gl.RENDERER));
    gl?.getExtension("WEBGL_lose_context")?.loseContext();
    return name;
  }

  constructor(canvas, name, { lost, restored }) {
    this.canvas = canvas;
    // Antialiasing needs a graphics processor.
    const antialias = !/swiftshader|llvmpipe|software|basic render/i.test(name);
    this.gl = canvas.getContext("webgl2", { alpha: false, antialias, powerPreference: "high-performance" });
    this.prepare();
    canvas.addEventListener("webglcontextlost", (event) => {
      // Without this the context is never restored.
      event.preventDefault();
      lost();
    });
    canvas.addEventListener("webglcontextrestored", () => {
      this.prepare();
      restored();
    });
  }

  prepare() {
    const { gl } = this;
    this.solids = new Solids(gl);
    this.traces = new Traces(gl);
    this.ground = new Ground(gl);
    gl.enable(gl.DEPTH_TEST);
    gl.enable(gl.CULL_FACE);
    gl.blendFunc(gl.SRC_ALPHA, gl.ONE_MINUS_SRC_ALPHA);
  }

  /** Sets the size of the picture in page pixels, and the device pixels for each. */
  fit(width, height, ratio) {
    this.pixel = Math.max(1, 1 / ratio);
    [this.canvas.width, this.canvas.height] = [width, height].map((side) => Math.floor(side * ratio));
  }

  paint(stage, eye) {
    const { gl, canvas } = this;
    if (gl.isContextLost()) return;
    const palette = colours.now;
    gl.viewport(0, 0, canvas.width, canvas.height);
    gl.clearColor(...channels(palette.paper), 1);
    gl.depthMask(true);
    gl.clear(gl.COLOR_BUFFER_BIT | gl.DEPTH_BUFFER_BIT);

    gl.disable(gl.BLEND);
    this.solids.lay(stage.parts(), eye, palette);
    this.solids.draw(true, eye, stage.vertical);
    gl.disable(gl.CULL_FACE);
    this.traces.draw(stage.traces, eye, 0.0066 * stage.size, this.pixel * eye.pixel, palette.trace);

    // Transparent parts do not write depth.
    gl.enable(gl.BLEND);
    gl.depthMask(false);
    this.ground.draw(stage.ground, eye, palette);
    gl.enable(gl.CULL_FACE);
    this.solids.draw(false, eye, stage.vertical);
  }
}
