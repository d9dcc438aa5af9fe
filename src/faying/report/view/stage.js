// The joint in three dimensions: bodies, contact faces and bolts, drawn when something changes.

const VERTEX = `
attribute float value;
varying float shown;
void main() {
  shown = value;
  gl_Position = projectionMatrix * modelViewMatrix * vec4(position, 1.0);
}`;
const FRAGMENT = `
uniform sampler2D ramp;
uniform vec3 grey;
uniform float low, high, open;
varying float shown;
void main() {
  float share = clamp((shown - low) / (high - low), 0.0, 1.0);
  vec3 colour = texture2D(ramp, vec2((share * 255.0 + 0.5) / 256.0, 0.5)).rgb;
  gl_FragColor = vec4(shown <= open ? grey : colour, 1.0);
}`;
const ELEVATION = (28 * Math.PI) / 180;
const AZIMUTH = (-58 * Math.PI) / 180;

// Where points are: at rest, moved with their body, displaced.
class Cloud {
  constructor(points, owners, nodes) {
    this.rest = points;
    this.owners = owners;
    this.nodes = nodes; // whose displacement each point has; null: its own
    this.attribute = new THREE.BufferAttribute(new Float32Array(points.length), 3);
  }

  place(moves, distance, displacement, factor) {
    const { rest, owners, nodes } = this;
    const now = this.attribute.array;
    for (let point = 0; point < owners.length; point++) {
      const move = moves[owners[point]] ?? [0, 0, 0];
      const node = nodes ? nodes[point] : point;
      for (let axis = 0; axis < 3; axis++) {
        const shift = displacement ? factor * displacement[3 * node + axis] : 0;
        now[3 * point + axis] = rest[3 * point + axis] + distance * move[axis] + shift;
      }
    }
    this.attribute.needsUpdate = true;
  }
}

class Stage {
  // `bodies` and `sides` are unpacked; `redrawn` is called after each picture.
  constructor(canvas, labels, data, bodies, sides, redrawn) {
    this.canvas = canvas;
    this.labels = labels;
    this.data = data;
    this.redrawn = redrawn;
    this.renderer = new THREE.WebGLRenderer({
      canvas, antialias: true, alpha: true, preserveDrawingBuffer: true,
    });
    this.renderer.setPixelRatio(Math.min(window.devicePixelRatio, 2));
    this.scene = new THREE.Scene();
    this.camera = new THREE.PerspectiveCamera(25, 1, 0.1, 10);
    this.camera.up.set(0, 0, 1);
    const sun = new THREE.DirectionalLight(0xffffff, 1.6);
    sun.position.set(-0.5, 0.4, 1);
    this.camera.add(sun);
    this.scene.add(this.camera, new THREE.AmbientLight(0xffffff, 1.9));
    this.#addBodies(bodies);
    this.#addSides(bodies, sides);
    this.#addBolts(bodies);
    this.controls = new THREE.OrbitControls(this.camera, canvas);
    this.controls.addEventListener("change", () => this.draw());
    new ResizeObserver(() => this.resize()).observe(canvas.parentElement);
  }

  #addBodies({ points, owner, triangles, edges }) {
    this.solid = new Cloud(points.values, owner.values, null);
    const [low, high] = extent(points.values);
    this.size = Math.hypot(...high.map((end, axis) => end - low[axis])) || 1;
    const colours = new Float32Array(points.values.length);
    const palette = this.data.colours.bodies.map((hex) => new THREE.Color(hex));
    owner.values.forEach((body, point) => {
      const { r, g, b } = palette[body % palette.length];
      colours.set([r, g, b], 3 * point);
    });
    const surface = new THREE.BufferGeometry();
    surface.setAttribute("position", this.solid.attribute);
    surface.setAttribute("color", new THREE.BufferAttribute(colours, 3));
    surface.setIndex(new THREE.BufferAttribute(triangles.values, 1));
    // Behind by a little, for contact faces and edges lie on it.
    this.skin = new THREE.Mesh(surface, new THREE.MeshLambertMaterial({
      vertexColors: true, flatShading: true, side: THREE.DoubleSide,
      polygonOffset: true, polygonOffsetFactor: 2, polygonOffsetUnits: 2,
    }));
    const lines = new THREE.BufferGeometry();
    lines.setAttribute("position", this.solid.attribute);
    lines.setIndex(new THREE.BufferAttribute(edges.values, 1));
    this.edges = new THREE.LineSegments(lines, new THREE.LineBasicMaterial({
      transparent: true, opacity: 0.55,
    }));
    // Their bounds change with what is shown, and everything is in view most of the time.
    for (const thing of [this.skin, this.edges]) thing.frustumCulled = false;
    this.scene.add(this.skin, this.edges);
  }

  #addSides({ owner }, sides) {
    this.paint = {
      ramp: { value: null }, grey: { value: new THREE.Vector3() },
      low: { value: 0 }, high: { value: 1 }, open: { value: 0 },
    };
    const material = new THREE.ShaderMaterial({
      vertexShader: VERTEX, fragmentShader: FRAGMENT, uniforms: this.paint, side: THREE.DoubleSide,
    });
    this.faces = sides.flatMap(({ points, nodes, triangles }, number) =>
      points.map((place, side) => {
        const owners = nodes[side].values.map((node) => owner.values[node]);
        const cloud = new Cloud(place.values, owners, nodes[side].values);
        const geometry = new THREE.BufferGeometry();
        const values = new THREE.BufferAttribute(new Float32Array(owners.length), 1);
        geometry.setAttribute("position", cloud.attribute);
        geometry.setAttribute("value", values);
        geometry.setIndex(new THREE.BufferAttribute(triangles.values, 1));
        const mesh = new THREE.Mesh(geometry, material);
        mesh.frustumCulled = false;
        this.scene.add(mesh);
        return { number, side, cloud, values, mesh };
      }));
  }

  #addBolts({ owner }) {
    this.bolts = this.data.bolts.map(({ name, colour, failed, ends, nodes }) => {
      const owners = nodes.map((node) => owner.values[node]);
      const cloud = new Cloud(Float32Array.from(ends.flat()), owners, nodes);
      const line = new THREE.BufferGeometry();
      line.setAttribute("position", cloud.attribute);
      const material = new THREE.LineBasicMaterial({
        color: colour, depthTest: false,
      });
      const drawn = new THREE.LineSegments(line, material);
      drawn.frustumCulled = false;
      drawn.renderOrder = 1;
      this.scene.add(drawn);
      const label = document.createElement("span");
      if (failed) label.className = "poor";
      this.labels.append(label);
      return { name, cloud, label };
    });
    this.marker = new THREE.Points(new THREE.BufferGeometry(), new THREE.PointsMaterial({
      size: 11, sizeAttenuation: false, color: this.data.colours.bolt, depthTest: false,
    }));
    this.marker.geometry.setAttribute("position", new THREE.BufferAttribute(new Float32Array(3), 3));
    this.marker.renderOrder = 2;
    this.marker.frustumCulled = false;
    this.marker.visible = false;
    this.scene.add(this.marker);
  }

  // `apart` in sizes of the model; displacements (n, 3) or null.
  place(apart, displacement, factor) {
    const clouds = [this.solid, ...this.faces.map((f) => f.cloud), ...this.bolts.map((b) => b.cloud)];
    for (const cloud of clouds) {
      cloud.place(this.data.bodies.moves, apart * this.size, displacement, factor);
    }
  }

  // One value per pair of every interface, and the scale they are shown by.
  colour(fields, scale) {
    const texture = new THREE.DataTexture(scale.ramp, LEVELS, 1);
    texture.minFilter = texture.magFilter = THREE.LinearFilter;
    texture.needsUpdate = true;
    this.paint.ramp.value?.dispose();
    this.paint.ramp.value = texture;
    this.paint.grey.value.set(...scale.grey.map((part) => part / 255));
    for (const name of ["low", "high", "open"]) this.paint[name].value = scale[name];
    for (const face of this.faces) {
      face.values.array.set(fields[face.number]);
      face.values.needsUpdate = true;
    }
  }

  // Show everything from the house's corner, as large as it fits.
  fit() {
    const [low, high] = extent(this.solid.attribute.array);
    const target = low.map((end, axis) => (end + high[axis]) / 2);
    const away = [
      Math.cos(ELEVATION) * Math.cos(AZIMUTH), Math.cos(ELEVATION) * Math.sin(AZIMUTH),
      Math.sin(ELEVATION),
    ];
    const right = [-Math.sin(AZIMUTH), Math.cos(AZIMUTH), 0];
    const up = [
      away[1] * right[2] - away[2] * right[1], away[2] * right[0] - away[0] * right[2],
      away[0] * right[1] - away[1] * right[0],
    ];
    const tall = Math.tan((this.camera.fov * Math.PI) / 360);
    const wide = tall * this.camera.aspect;
    let distance = 1e-6 * this.size;
    const now = this.solid.attribute.array;
    for (let at = 0; at < now.length; at += 3) {
      const [x, y, z] = [right, up, away].map((direction) =>
        direction.reduce((sum, part, axis) => sum + part * (now[at + axis] - target[axis]), 0));
      distance = Math.max(distance, z + Math.abs(x) / wide, z + Math.abs(y) / tall);
    }
    distance *= 1.08;
    this.camera.position.set(...target.map((end, axis) => end + distance * away[axis]));
    this.controls.target.set(...target);
    this.controls.update();
    this.fitted = this.camera.position.clone();
    this.draw();
  }

  resize() {
    const { clientWidth: width, clientHeight: height } = this.canvas.parentElement;
    if (!width || !height) return;
    this.renderer.setSize(width, height, false);
    this.camera.aspect = width / height;
    this.camera.updateProjectionMatrix();
    // What a reader has turned or come nearer to stays so.
    if (this.fitted?.equals(this.camera.position)) this.fit();
    else this.draw();
  }

  // Turn by angles, or come nearer by a factor: the keyboard's way.
  turn(sideways, upwards, nearer) {
    const { target } = this.controls;
    const arm = this.camera.position.clone().sub(target);
    const length = arm.length();
    const polar = Math.acos(arm.z / length) - upwards;
    const azimuth = Math.atan2(arm.y, arm.x) + sideways;
    const safe = Math.min(Math.max(polar, 0.01), Math.PI - 0.01);
    arm.set(
      Math.sin(safe) * Math.cos(azimuth), Math.sin(safe) * Math.sin(azimuth), Math.cos(safe),
    ).multiplyScalar(length / nearer);
    this.camera.position.copy(target).add(arm);
    this.controls.update();
    this.draw();
  }

  draw() {
    const style = getComputedStyle(this.canvas);
    this.edges.material.color.set(style.getPropertyValue("--ink").trim() || "#000");
    const distance = this.camera.position.distanceTo(this.controls.target);
    this.camera.near = Math.max(distance - 3 * this.size, distance / 1000);
    this.camera.far = distance + 3 * this.size;
    this.camera.updateProjectionMatrix();
    this.camera.updateMatrixWorld();
    this.renderer.render(this.scene, this.camera);
    this.#placeLabels();
    this.redrawn();
  }

  // Above their bolts within the canvas, the lower ones first; those in the way of others go higher.
  #placeLabels() {
    const { clientWidth } = this.canvas;
    const wanted = this.bolts.map(({ cloud, label }) => {
      const [x, y] = this.onScreen(new THREE.Vector3().fromArray(cloud.attribute.array, 3));
      const { offsetWidth: wide, offsetHeight: tall } = label;
      const left = Math.max(0, Math.min(x - wide / 2, clientWidth - wide));
      return { label, left, wide, tall, top: y - 1.2 * tall };
    }).sort((one, other) => other.top - one.top);
    wanted.forEach((one, number) => {
      for (const there of wanted.slice(0, number)) {
        const beside = one.left >= there.left + there.wide || there.left >= one.left + one.wide;
        const apart = one.top >= there.top + there.tall || there.top >= one.top + one.tall;
        if (!beside && !apart) one.top = there.top - one.tall - 1;
      }
      one.label.style.transform = `translate(${one.left}px, ${one.top}px)`;
    });
  }

  onScreen(point) {
    const { x, y } = point.clone().project(this.camera);
    const { clientWidth, clientHeight } = this.canvas;
    return [((x + 1) / 2) * clientWidth, ((1 - y) / 2) * clientHeight];
  }

  // The pair {number, side, pair} or place on a body {point} drawn at a place of the canvas, or null.
  at(x, y) {
    const { clientWidth, clientHeight } = this.canvas;
    const ray = new THREE.Raycaster();
    const place = new THREE.Vector2((2 * x) / clientWidth - 1, 1 - (2 * y) / clientHeight);
    ray.setFromCamera(place, this.camera);
    const things = [this.skin, ...this.faces.map((face) => face.mesh)];
    for (const { geometry } of things) geometry.boundingSphere = null;
    const hits = ray.intersectObjects(things, false);
    if (!hits.length) return null;
    // Contact faces lie on bodies and are drawn in front of them.
    const near = hits.filter((hit) => hit.distance < hits[0].distance + 1e-4 * this.size);
    const hit = near.find((one) => one.object !== this.skin) ?? near[0];
    const { a, b, c } = hit.face;
    const positions = hit.object.geometry.attributes.position;
    const away = (point) => new THREE.Vector3().fromBufferAttribute(positions, point)
      .distanceTo(hit.point);
    const nearest = [a, b, c].reduce((best, next) => (away(next) < away(best) ? next : best));
    if (hit.object === this.skin) return { point: nearest };
    const face = this.faces.find(({ mesh }) => mesh === hit.object);
    return { number: face.number, side: face.side, pair: nearest };
  }

  // Mark a pair (on the minus side unless it names one) or a place on a body; null marks nothing.
  mark(picked) {
    this.marker.visible = picked !== null;
    if (picked) {
      const cloud = picked.point === undefined
        ? this.faces.find(
          (face) => face.number === picked.number && face.side === (picked.side ?? 0)).cloud
        : this.solid;
      const from = 3 * (picked.point ?? picked.pair);
      this.marker.geometry.attributes.position.array.set(
        cloud.attribute.array.slice(from, from + 3));
      this.marker.geometry.attributes.position.needsUpdate = true;
    }
  }
}

function extent(points) {
  const low = [Infinity, Infinity, Infinity];
  const high = [-Infinity, -Infinity, -Infinity];
  points.forEach((value, at) => {
    low[at % 3] = Math.min(low[at % 3], value);
    high[at % 3] = Math.max(high[at % 3], value);
  });
  return [low, high];
}
