// The eye: it looks at a target from a direction and a distance, moved by pointers.

const FIELD = 35;

class Eye {
  constructor(canvas, stage) {
    this.camera = new THREE.PerspectiveCamera(FIELD, 1, 1, 2);
    this.camera.up.copy(stage.vertical);
    this.canvas = canvas;
    this.stage = stage;
    this.target = new THREE.Vector3();
    this.shift = new THREE.Vector3();
    this.changed = true;
    this.pointers = new Map();
    this.reset(stage.travels);
    this.listen();
  }

  /** Looks from the start; where it follows, as near as the mechanism is large. */
  reset(follows) {
    const { right, up, flat } = film.view;
    const { vertical, floor: [a, b] } = this.stage;
    const towards = new THREE.Vector3(...right).cross(new THREE.Vector3(...up));
    this.elevation = Math.asin(Math.min(Math.max(towards.dot(vertical), -1), 1));
    this.azimuth = Math.atan2(towards.dot(a), -towards.dot(b));
    // Straight at a plane nothing shows that this is space.
    if (flat) [this.azimuth, this.elevation] = [this.azimuth + 0.35, Math.min(this.elevation + 0.22, 0.9)];
    const radius = follows ? 0.9 * this.stage.size : this.stage.whole.getSize(new THREE.Vector3()).length() / 2;
    this.distance = (0.95 * radius) / Math.sin((FIELD / 2) * (Math.PI / 180));
    this.shift.set(0, 0, 0);
    this.changed = true;
  }

  /** Directions of the picture: to the right and up. */
  directions() {
    const { matrixWorld } = this.camera;
    return [0, 1].map((column) => new THREE.Vector3().setFromMatrixColumn(matrixWorld, column));
  }

  /** Places the camera for a picture so wide and high. */
  look(width, height) {
    const [a, b] = this.stage.floor;
    const level = Math.cos(this.elevation);
    const from = this.stage.vertical.clone().multiplyScalar(Math.sin(this.elevation))
      .addScaledVector(a, level * Math.sin(this.azimuth))
      .addScaledVector(b, -level * Math.cos(this.azimuth));
    const at = this.target.clone().add(this.shift);
    const { camera } = this;
    camera.aspect = width / Math.max(height, 1);
    // What is narrower than high is seen from farther away.
    const distance = this.distance / Math.min(1, camera.aspect);
    camera.near = distance / 100;
    camera.far = distance * 50 + 200 * this.stage.step;
    camera.position.copy(at).addScaledVector(from, distance);
    camera.lookAt(at);
    camera.updateProjectionMatrix();
    camera.updateMatrixWorld();
    this.stage.spread(at, distance);
    this.changed = false;
  }

  turn(right, up) {
    this.azimuth -= right;
    this.elevation = Math.min(Math.max(this.elevation + up, -1.5), 1.5);
    this.changed = true;
  }

  pan(right, up) {
    const metres = (2 * this.distance * Math.tan((FIELD / 2) * (Math.PI / 180))) / this.canvas.clientHeight;
    const [a, b] = this.directions();
    this.shift.addScaledVector(a, -right * metres).addScaledVector(b, up * metres);
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
