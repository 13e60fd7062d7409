// The camera: looks at a target from a direction and a distance, moved by pointers.

/** Vertical field of view, in degrees. */
const FIELD = 35;
/** Half the height of the picture, one metre in front of the camera. */
const HALF = Math.tan((FIELD / 2) * (Math.PI / 180));

class Eye {
  constructor(canvas, stage) {
    this.canvas = canvas;
    this.stage = stage;
    this.target = ZERO;
    this.changed = true;
    this.pointers = new Map();
    this.reset(stage.travels);
    this.listen();
  }

  /** Resets the view; if the camera follows the mechanism, at a distance proportional to its size. */
  reset(follows) {
    const { right, up, flat } = film.view;
    const { vertical, floor: [a, b] } = this.stage;
    const towards = cross(right, up);
    this.elevation = Math.asin(Math.min(Math.max(dot(towards, vertical), -1), 1));
    this.azimuth = Math.atan2(dot(towards, a), -dot(towards, b));
    // A view normal to the plane would not show depth.
    if (flat) [this.azimuth, this.elevation] = [this.azimuth + 0.35, Math.min(this.elevation + 0.22, 0.9)];
    const radius = follows ? 0.9 * this.stage.size : this.stage.whole.diagonal / 2;
    this.distance = (0.95 * radius) / Math.sin(Math.atan(HALF));
    this.shift = ZERO;
    this.changed = true;
  }

  /** Updates position, directions and `clip` for a picture of this size in pixels. */
  look(width, height) {
    const { vertical, floor: [a, b], step } = this.stage;
    const level = Math.cos(this.elevation);
    const back = plus(
      plus(scaled(vertical, Math.sin(this.elevation)), a, level * Math.sin(this.azimuth)),
      b, -level * Math.cos(this.azimuth),
    );
    const right = unit(cross(vertical, back));
    const up = cross(back, right);
    const aspect = Math.max(width, 1) / Math.max(height, 1);
    // A portrait picture is seen from farther away.
    const distance = this.distance / Math.min(1, aspect);
    const middle = plus(this.target, this.shift);
    this.place = plus(middle, back, distance);
    Object.assign(this, { right, up, back, aspect, pixel: (2 * HALF) / Math.max(height, 1) });
    this.clip = this.projection(distance / 100, distance * 50 + 200 * step);
    this.stage.spread(middle, distance);
    this.changed = false;
  }

  /** View-projection matrix, column by column, from camera space to clip space. */
  projection(near, far) {
    const { right, up, back, aspect } = this;
    const deep = (far + near) / (near - far);
    const columns = [0, 1, 2].map((k) => [right[k] / (HALF * aspect), up[k] / HALF, deep * back[k], -back[k]]);
    return new Float32Array([...columns.flat(), 0, 0, (2 * far * near) / (near - far), 0]);
  }

  /** Position of a point in the picture, from 0 at the top left to 1; nothing if it is behind the camera. */
  sees(place) {
    const from = minus(place, this.place);
    const depth = -dot(from, this.back);
    if (!(depth > 0)) return null;
    const half = 2 * HALF * depth;
    return [0.5 + dot(from, this.right) / (half * this.aspect), 0.5 - dot(from, this.up) / half];
  }

  turn(right, up) {
    this.azimuth -= right;
    this.elevation = Math.min(Math.max(this.elevation + up, -1.5), 1.5);
    this.changed = true;
  }

  pan(right, up) {
    const metres = (2 * HALF * this.distance) / this.canvas.clientHeight;
    this.shift = plus(plus(this.shift, this.right, -right * metres), this.up, up * metres);
    this.changed = true;
  }

  zoom(factor) {
    const size = this.stage.size;
    this.distance = Math.min(Math.max(this.distance * factor, 0.05 * size), 1e4 * size);
    this.changed = true;
  }

  listen() {
    const { canvas, pointers } = this;
    canvas.addEventListener("pointerdown", (event) => {
      canvas.setPointerCapture(event.pointerId);
      pointers.set(event.pointerId, [event.clientX, event.clientY]);
    });
    for (const end of ["pointerup", "pointercancel", "lostpointercapture"]) {
      canvas.addEventListener(end, (event) => pointers.delete(event.pointerId));
    }
    canvas.addEventListener("pointermove", (event) => this.drag(event));
    canvas.addEventListener("contextmenu", (event) => event.preventDefault());
    canvas.addEventListener("wheel", (event) => {
      event.preventDefault();
      this.zoom(Math.exp(0.0012 * event.deltaY));
    }, { passive: false });
  }

  drag(event) {
    const { pointers } = this;
    const before = pointers.get(event.pointerId);
    if (!before) return;
    const now = [event.clientX, event.clientY];
    const [right, down] = [now[0] - before[0], now[1] - before[1]];
    const other = [...pointers].find(([id]) => id !== event.pointerId)?.[1];
    if (other) {
      const apart = (place) => Math.hypot(place[0] - other[0], place[1] - other[1]) || 1;
      this.zoom(apart(before) / apart(now));
      this.pan(right / 2, down / 2);
    } else if (event.shiftKey || event.buttons & 6) {
      this.pan(right, down);
    } else {
      this.turn(0.006 * right, 0.006 * down);
    }
    pointers.set(event.pointerId, now);
  }
}
