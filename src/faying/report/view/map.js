// An interface in its own plane: every pixel has a value, to be zoomed and read.

function uncut(triangles, flat, period) {
  const kept = [];
  for (let at = 0; at < triangles.length; at += 3) {
    const corners = triangles.subarray(at, at + 3);
    const arcs = [...corners].map((corner) => flat[2 * corner]);
    if (Math.max(...arcs) - Math.min(...arcs) < period / 2) kept.push(...corners);
  }
  return Int32Array.from(kept);
}

class FieldMap {
  // `flat` are the pairs in the plane, of a cylinder of circumference `period` unrolled; `told(value, x, y)` hears what the pointer is over, or
  // null; `chosen(pair)` which pair was clicked.
  constructor(canvas, { flat, triangles, period }, told, chosen) {
    this.canvas = canvas;
    this.flat = flat.values;
    // Triangles over the cut of a cylinder have no place in its map.
    this.triangles = period ? uncut(triangles.values, flat.values, period) : triangles.values;
    this.told = told;
    const low = [0, 0];
    const high = [0, 0];
    for (let axis = 0; axis < 2; axis++) {
      const along = this.flat.filter((_, at) => at % 2 === axis);
      low[axis] = along.reduce((a, b) => Math.min(a, b), Infinity);
      high[axis] = along.reduce((a, b) => Math.max(a, b), -Infinity);
    }
    this.low = low;
    this.high = high;
    this.zoom = 1;
    this.centre = low.map((end, axis) => (end + high[axis]) / 2);
    canvas.addEventListener("wheel", (event) => {
      event.preventDefault();
      this.#zoom(Math.exp(-event.deltaY / 400), event.offsetX, event.offsetY);
    }, { passive: false });
    canvas.addEventListener("keydown", (event) => this.#key(event));
    canvas.addEventListener("dblclick", () => this.#whole());
    let held = null;
    canvas.addEventListener("pointerdown", (event) => {
      held = { x: event.offsetX, y: event.offsetY, moved: false };
    });
    canvas.addEventListener("pointermove", (event) => {
      if (held && event.buttons) {
        const [right, down] = [event.offsetX - held.x, event.offsetY - held.y];
        if (held.moved || Math.hypot(right, down) > 4) {
          this.centre[0] -= right / this.scale;
          this.centre[1] += down / this.scale;
          held = { x: event.offsetX, y: event.offsetY, moved: true };
          this.draw();
        }
      }
      this.#tell(event.offsetX, event.offsetY);
    });
    canvas.addEventListener("pointerup", (event) => {
      if (held && !held.moved) chosen(this.nearest(event.offsetX, event.offsetY));
      held = null;
    });
    canvas.addEventListener("pointerleave", () => { held = null; told(null); });
    new ResizeObserver(() => this.draw()).observe(canvas);
  }

  show(values, scale) {
    this.values = values;
    this.colours = scale;
    this.draw();
  }

  mark(pair) {
    this.marked = pair;
    this.draw();
  }

  // Pixels per length, of the page.
  get scale() {
    const { clientWidth, clientHeight } = this.canvas;
    const [wide, tall] = this.high.map((end, axis) => Math.max(end - this.low[axis], 1e-30));
    return this.zoom * Math.min((clientWidth - 16) / wide, (clientHeight - 16) / tall);
  }

  // Where a point of the plane is on the page, and back.
  #page(x, y) {
    const { clientWidth, clientHeight } = this.canvas;
    return [
      clientWidth / 2 + (x - this.centre[0]) * this.scale,
      clientHeight / 2 - (y - this.centre[1]) * this.scale,
    ];
  }

  #plane(x, y) {
    const { clientWidth, clientHeight } = this.canvas;
    return [
      this.centre[0] + (x - clientWidth / 2) / this.scale,
      this.centre[1] - (y - clientHeight / 2) / this.scale,
    ];
  }

  nearest(x, y) {
    const [across, up] = this.#plane(x, y);
    let best = 0;
    let least = Infinity;
    for (let pair = 0; 2 * pair < this.flat.length; pair++) {
      const away = Math.hypot(this.flat[2 * pair] - across, this.flat[2 * pair + 1] - up);
      if (away < least) [best, least] = [pair, away];
    }
    return best;
  }

  #zoom(factor, x, y) {
    const before = this.#plane(x, y);
    this.zoom = Math.min(Math.max(this.zoom * factor, 1), 200);
    const after = this.#plane(x, y);
    for (let axis = 0; axis < 2; axis++) this.centre[axis] += before[axis] - after[axis];
    if (this.zoom === 1) this.centre = this.low.map((end, axis) => (end + this.high[axis]) / 2);
    this.draw();
    this.#tell(x, y);
  }

  #whole() {
    this.zoom = 1;
    this.centre = this.low.map((end, axis) => (end + this.high[axis]) / 2);
    this.draw();
  }

  #key(event) {
    const { clientWidth, clientHeight } = this.canvas;
    const step = 40 / this.scale;
    const moves = {
      ArrowLeft: [-step, 0], ArrowRight: [step, 0], ArrowUp: [0, step], ArrowDown: [0, -step],
    };
    if (event.key in moves) {
      this.centre = this.centre.map((place, axis) => place + moves[event.key][axis]);
      this.draw();
    } else if (event.key === "+") this.#zoom(1.25, clientWidth / 2, clientHeight / 2);
    else if (event.key === "-") this.#zoom(0.8, clientWidth / 2, clientHeight / 2);
    else if (event.key === "0") this.#whole();
    else return;
    event.preventDefault();
  }

  #tell(x, y) {
    const { width, clientWidth } = this.canvas;
    const ratio = width / clientWidth;
    const value = this.pixels?.[Math.floor(y * ratio) * width + Math.floor(x * ratio)];
    if (value === undefined || Number.isNaN(value)) this.told(null);
    else this.told(value, ...this.#plane(x, y));
  }

  draw() {
    const { clientWidth, clientHeight } = this.canvas;
    if (!this.values || !clientWidth || !clientHeight) return;
    const ratio = Math.min(window.devicePixelRatio, 2);
    const width = Math.round(clientWidth * ratio);
    const height = Math.round(clientHeight * ratio);
    if (this.canvas.width !== width) this.canvas.width = width;
    if (this.canvas.height !== height) this.canvas.height = height;
    const context = this.canvas.getContext("2d");
    const image = context.createImageData(width, height);
    this.pixels = new Float32Array(width * height).fill(NaN);
    for (let at = 0; at < this.triangles.length; at += 3) {
      this.#fill(this.triangles.subarray(at, at + 3), ratio, width, height);
    }
    const { ramp: colours, grey, open } = this.colours;
    this.pixels.forEach((value, pixel) => {
      if (Number.isNaN(value)) return;
      const from = 4 * level(this.colours, value);
      for (let part = 0; part < 3; part++) {
        image.data[4 * pixel + part] = value <= open ? grey[part] : colours[from + part];
      }
      image.data[4 * pixel + 3] = 255;
    });
    context.putImageData(image, 0, 0);
    if (this.marked !== undefined && this.marked !== null) {
      const [x, y] = this.#page(this.flat[2 * this.marked], this.flat[2 * this.marked + 1]);
      context.lineWidth = 2 * ratio;
      for (const [colour, radius] of [["#fff", 7], ["#b2182b", 5]]) {
        context.strokeStyle = colour;
        context.beginPath();
        context.arc(x * ratio, y * ratio, radius * ratio, 0, 2 * Math.PI);
        context.stroke();
      }
    }
  }

  // Give the pixels of a triangle values by its barycentric coordinates.
  #fill(corners, ratio, width, height) {
    const places = Array.from(corners, (pair) =>
      this.#page(this.flat[2 * pair], this.flat[2 * pair + 1]).map((end) => end * ratio));
    const [[ax, ay], [bx, by], [cx, cy]] = places;
    const [u, v, w] = Array.from(corners, (pair) => this.values[pair]);
    const twice = (bx - ax) * (cy - ay) - (cx - ax) * (by - ay);
    if (!twice) return;
    const left = Math.max(Math.floor(Math.min(ax, bx, cx)), 0);
    const right = Math.min(Math.ceil(Math.max(ax, bx, cx)), width - 1);
    const top = Math.max(Math.floor(Math.min(ay, by, cy)), 0);
    const bottom = Math.min(Math.ceil(Math.max(ay, by, cy)), height - 1);
    for (let row = top; row <= bottom; row++) {
      for (let column = left; column <= right; column++) {
        const [x, y] = [column + 0.5, row + 0.5];
        const second = ((x - ax) * (cy - ay) - (cx - ax) * (y - ay)) / twice;
        const third = ((bx - ax) * (y - ay) - (x - ax) * (by - ay)) / twice;
        const first = 1 - second - third;
        if (first < -1e-6 || second < -1e-6 || third < -1e-6) continue;
        this.pixels[row * width + column] = u * first + v * second + w * third;
      }
    }
  }
}
