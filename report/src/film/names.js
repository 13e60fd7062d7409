// Labels of points over the picture; coincident points share a label.

/** Names closer than this are written together, in pixels. */
const CLOSE = 9;

class Names {
  constructor(stage) {
    this.points = stage.own;
    this.labels = this.points.map((point) => element(at("names"), "span", this.name([point])));
    this.told = this.points.map((point) => `${point}`);
  }

  name(points) {
    const told = ({ name, body }) => (body ? `${name} (${body})` : name);
    return points.map((point) => told(film.points[point])).join(", ");
  }

  /** The visible points, coincident ones together. */
  groups(instant, eye, width, height) {
    const groups = [];
    for (const point of this.points) {
      const seen = eye.sees(placeAt(point, instant));
      if (!seen) continue;
      const [x, y] = [seen[0] * width, seen[1] * height];
      const near = groups.find((group) => Math.hypot(group.x - x, group.y - y) < CLOSE);
      if (near) near.points.push(point);
      else groups.push({ x, y, points: [point] });
    }
    return groups;
  }

  show(instant, eye, width, height, visible) {
    const groups = visible ? this.groups(instant, eye, width, height) : [];
    this.labels.forEach((label, k) => {
      label.hidden = k >= groups.length;
      if (label.hidden) return;
      const { x, y, points } = groups[k];
      const key = points.join();
      if (this.told[k] !== key) {
        this.told[k] = key;
        label.textContent = this.name(points);
      }
      label.style.transform = `translate(${(x + 9).toFixed(1)}px,${(y + 4).toFixed(1)}px)`;
    });
  }
}
