"use strict";
// Draws a scene stored in a page with three.js. The page makes no request.

const byId = (id) => document.getElementById(id);
const DASHES = 9; // of a bone that an assumed joint divides
const TYPES = { uint8: Uint8Array, int16: Int16Array, uint16: Uint16Array, uint32: Uint32Array, float32: Float32Array };

async function payload(id) {
  const text = byId(id).textContent.trim();
  const packed = Uint8Array.from(atob(text), (c) => c.charCodeAt(0));
  const stream = new Blob([packed]).stream().pipeThrough(new DecompressionStream("deflate"));
  return new Response(stream).arrayBuffer();
}

function arraysOf(scene, bytes) {
  const arrays = {};
  for (const [name, a] of Object.entries(scene.arrays)) {
    arrays[name] = new TYPES[a.dtype](bytes, a.offset, a.shape.reduce((x, y) => x * y, 1));
  }
  return arrays;
}

class Surface {
  constructor(materials) {
    this.geometry = new THREE.BufferGeometry();
    this.mesh = new THREE.Mesh(this.geometry, materials.plain);
    this.mesh.frustumCulled = false;
    this.materials = materials;
  }
  showParts(on) { this.mesh.material = on ? this.materials.parts : this.materials.plain; }
}

function dequantised(source, begin, count, scene, out) {
  const [scale, low] = [scene.scale, scene.low];
  for (let i = 0; i < count; i++) {
    for (let x = 0; x < 3; x++) out[3 * i + x] = low[x] + scale * source[3 * (begin + i) + x];
  }
  return out;
}

function partColours(labels, begin, count, scene) {
  const out = new Float32Array(3 * count);
  const rgb = scene.palette.map((c) => new THREE.Color(c));
  const notRigid = new THREE.Color(scene.not_rigid);
  for (let i = 0; i < count; i++) {
    const label = labels[begin + i];
    (label < 0 ? notRigid : rgb[label % rgb.length]).toArray(out, 3 * i);
  }
  return out;
}

// `changed` is called whenever another frame is shown, and when playing begins or ends.
class Player {
  constructor(scene, arrays, canvas, changed) {
    this.scene = scene;
    this.arrays = arrays;
    this.changed = changed;
    this.following = false;
    this.at = 0;
    this.playing = false;
    this.speed = 1;
    this.elapsed = 0;
    this.renderer = new THREE.WebGLRenderer({ canvas, antialias: true, alpha: true, preserveDrawingBuffer: true });
    this.renderer.setPixelRatio(Math.min(window.devicePixelRatio || 1, 2));
    this.world = new THREE.Scene();
    this.camera = new THREE.PerspectiveCamera(35, 1, scene.size / 100, scene.size * 50);
    this.controls = new THREE.OrbitControls(this.camera, canvas);
    this.controls.enableDamping = false;
    canvas.style.touchAction = ""; // the page's style lets a swipe scroll
    this.controls.addEventListener("change", () => this.draw());
    this.addLight();
    this.addAlignedMesh();
    this.addInputMesh();
    this.addSkeleton();
    this.addLeaves();
    this.resetView();
  }

  addLight() {
    this.world.add(new THREE.HemisphereLight(0xffffff, 0x8a93a0, 2.2));
    const lamp = new THREE.DirectionalLight(0xffffff, 1.6);
    lamp.position.set(0.4, 0.8, 1);
    this.world.add(lamp);
  }

  materials(opacity) {
    const shared = { flatShading: true, side: THREE.DoubleSide, transparent: opacity < 1, opacity, depthWrite: true };
    return {
      plain: new THREE.MeshLambertMaterial({ color: 0xb9bec6, ...shared }),
      parts: new THREE.MeshLambertMaterial({ vertexColors: true, ...shared }),
    };
  }

  addAlignedMesh() {
    const { arrays, scene } = this;
    this.aligned = new Surface(this.materials(1));
    if (!arrays.positions) return;
    const count = scene.arrays.positions.shape[1];
    this.aligned.count = count;
    const position = new THREE.BufferAttribute(new Float32Array(3 * count), 3).setUsage(THREE.DynamicDrawUsage);
    this.aligned.geometry.setAttribute("position", position);
    this.aligned.geometry.setAttribute("color", new THREE.BufferAttribute(partColours(arrays.label, 0, count, scene), 3));
    this.aligned.geometry.setIndex(new THREE.BufferAttribute(arrays.faces, 1));
    this.world.add(this.aligned.mesh);
  }

  addInputMesh() {
    this.input = new Surface(this.materials(1));
    this.world.add(this.input.mesh);
    this.input.mesh.visible = false;
  }

  addSkeleton() {
    const { scene } = this;
    this.skeleton = new THREE.Group();
    const onTop = { depthTest: false, transparent: true };
    const count = scene.joints.length;
    const ball = new THREE.SphereGeometry(scene.size * 0.0105, 14, 10);
    this.balls = new THREE.InstancedMesh(ball, new THREE.MeshBasicMaterial({ color: 0xffffff, ...onTop }), Math.max(count, 1));
    const rod = new THREE.CylinderGeometry(scene.size * 0.0025, scene.size * 0.006, 1, 8).translate(0, 0.5, 0);
    this.rods = new THREE.InstancedMesh(rod, new THREE.MeshBasicMaterial({ color: 0x222222, ...onTop }), Math.max(count, 1));
    // Black rods with white edges, seen over any part and over a dark stage.
    const edge = rod.clone().scale(1.7, 1, 1.7);
    this.edges = new THREE.InstancedMesh(edge, new THREE.MeshBasicMaterial({ color: 0xffffff, ...onTop }), Math.max(count, 1));
    this.edges.renderOrder = 1.9;
    this.balls.renderOrder = 3;
    this.rods.renderOrder = 2;
    // A white and a black ring: one of them stands out from any part and from the stage.
    this.rings = [[1.65, 0xffffff], [1.35, 0x000000]].map(([scale, color], k) => {
      const ring = new THREE.InstancedMesh(ball.clone().scale(scale, scale, scale), new THREE.MeshBasicMaterial({ color, ...onTop }), Math.max(count, 1));
      ring.renderOrder = 2.3 + k / 3;
      return ring;
    });
    scene.joints.forEach((joint, j) => this.balls.setColorAt(j, new THREE.Color(scene.kinds[joint.kind])));
    for (const part of [this.edges, this.rods, ...this.rings, this.balls]) {
      part.frustumCulled = false;
      part.count = count;
      this.skeleton.add(part);
    }
    this.addAssumed();
    this.world.add(this.skeleton);
  }

  // Joints that were not found are hollow, and the bones that they lie on dashed.
  addAssumed() {
    const { scene } = this;
    const onTop = { depthTest: false, transparent: true };
    this.assumed = scene.assumed || [];
    this.dashed = [...new Set(this.assumed.map((joint) => joint.child))];
    const dash = new THREE.CylinderGeometry(scene.size * 0.0035, scene.size * 0.0035, 1, 8).translate(0, 0.5, 0);
    const count = this.dashed.length * DASHES;
    this.dashes = [[1.7, 0xffffff, 1.9], [1, 0x222222, 2]].map(([wide, color, order]) => {
      const dashes = new THREE.InstancedMesh(dash.clone().scale(wide, 1, wide), new THREE.MeshBasicMaterial({ color, ...onTop }), Math.max(count, 1));
      dashes.count = count;
      dashes.renderOrder = order;
      return dashes;
    });
    this.hollows = [[1.3, 0x000000], [0.9, 0xffffff]].map(([scale, color], k) => {
      const ball = new THREE.SphereGeometry(scene.size * 0.0105 * scale, 14, 10);
      const hollow = new THREE.InstancedMesh(ball, new THREE.MeshBasicMaterial({ color, ...onTop }), Math.max(this.assumed.length, 1));
      hollow.count = this.assumed.length;
      hollow.renderOrder = 2.8 + k / 10;
      return hollow;
    });
    for (const part of [...this.dashes, ...this.hollows]) {
      part.frustumCulled = false;
      this.skeleton.add(part);
    }
  }

  assumedPoint(k) {
    return this.point("assumed", this.assumed.length, k);
  }

  // A place on a dashed bone, which leads from joint to joint: 0 at its inner end, 1 at its outer.
  alongDashed(child, from, here, share) {
    const inner = this.assumed.map((joint, k) => [joint, k]).filter(([joint]) => joint.child === child);
    const stops = [from, ...inner.map(([, k]) => this.assumedPoint(k)), here];
    const lengths = stops.slice(1).map((stop, i) => stop.distanceTo(stops[i]));
    let rest = share * lengths.reduce((a, b) => a + b, 0);
    let i = 0;
    while (i < lengths.length - 1 && rest > lengths[i]) rest -= lengths[i++];
    return stops[i].clone().lerp(stops[i + 1], lengths[i] > 0 ? rest / lengths[i] : 0);
  }

  addLeaves() {
    const count = this.scene.arrays.leaves ? this.scene.arrays.leaves.shape[1] : 0;
    const ball = new THREE.SphereGeometry(this.scene.size * 0.023, 14, 10);
    this.leaves = new THREE.InstancedMesh(ball, new THREE.MeshBasicMaterial({ color: new THREE.Color(this.scene.surface_leaf) }), Math.max(count, 1));
    this.leaves.count = count;
    this.leaves.visible = false;
    this.leaves.frustumCulled = false;
    this.world.add(this.leaves);
  }

  point(name, count, k) {
    const a = this.arrays[name];
    const i = 3 * (this.at * count + k);
    return new THREE.Vector3(a[i], a[i + 1], a[i + 2]);
  }

  centre() {
    return this.scene.joints.length ? this.point("joints", this.scene.joints.length, 0) : new THREE.Vector3(...this.scene.centre);
  }

  // The box of all frames, or of one where the body walks far; "Follow" keeps it in view then.
  extent() {
    const { scene, arrays } = this;
    const [low, high] = [[Infinity, Infinity, Infinity], [-Infinity, -Infinity, -Infinity]];
    (arrays.positions || []).forEach((level, i) => { low[i % 3] = Math.min(low[i % 3], level); high[i % 3] = Math.max(high[i % 3], level); });
    const side = low.map((l, x) => (high[x] >= l ? (high[x] - l) * scene.scale : scene.size));
    const far = Math.hypot(...side) / (2.2 * scene.size);
    const centre = far > 1 || !arrays.positions ? scene.centre : low.map((l, x) => scene.low[x] + (scene.scale * (l + high[x])) / 2);
    return { centre, half: side.map((s) => s / 2 / Math.max(far, 1)) };
  }

  resetView() {
    const { centre, half } = (this.box ??= this.extent());
    this.controls.target.set(...centre);
    const slope = Math.tan((this.camera.fov * Math.PI) / 360);
    const [across, up] = [half[0] + 0.25 * half[2], half[1] + 0.12 * half[2]];
    const away = 1.06 * (Math.max(up / slope, across / (slope * this.camera.aspect)) + half[2]);
    this.camera.position.copy(this.controls.target).add(new THREE.Vector3(0.25, 0.12, 1).setLength(away));
    this.followed = null;
    this.controls.update();
  }

  show(at) {
    const { scene, arrays } = this;
    this.at = Math.max(0, Math.min(scene.frames.length - 1, at));
    if (arrays.positions) {
      const position = this.aligned.geometry.attributes.position;
      dequantised(arrays.positions, this.at * this.aligned.count, this.aligned.count, scene, position.array);
      position.needsUpdate = true;
    }
    this.showInput();
    this.showSkeleton();
    this.showLeaves();
    if (this.following) this.follow();
    this.changed(this);
    this.draw();
  }

  showInput() {
    const { arrays, scene } = this;
    if (!arrays.input_vertices || !this.input.mesh.visible) return;
    const [v, w] = [arrays.input_vertex_offsets[this.at], arrays.input_vertex_offsets[this.at + 1]];
    const [f, g] = [arrays.input_face_spans[2 * this.at], arrays.input_face_spans[2 * this.at + 1]];
    const geometry = new THREE.BufferGeometry();
    geometry.setAttribute("position", new THREE.BufferAttribute(dequantised(arrays.input_vertices, v, w - v, scene, new Float32Array(3 * (w - v))), 3));
    geometry.setAttribute("color", new THREE.BufferAttribute(partColours(arrays.input_label, v, w - v, scene), 3));
    geometry.setIndex(new THREE.BufferAttribute(arrays.input_faces.slice(3 * f, 3 * g), 1));
    this.input.mesh.geometry.dispose();
    this.input.mesh.geometry = geometry;
  }

  showSkeleton() {
    const joints = this.scene.joints;
    const place = new THREE.Matrix4();
    const upwards = new THREE.Vector3(0, 1, 0);
    joints.forEach((joint, j) => {
      const here = this.point("joints", joints.length, j);
      for (const part of [...this.rings, this.balls]) part.setMatrixAt(j, place.makeTranslation(here.x, here.y, here.z));
      const from = joint.parent < 0 ? here : this.point("joints", joints.length, joint.parent);
      const along = here.clone().sub(from);
      const length = along.length();
      const turn = new THREE.Quaternion().setFromUnitVectors(upwards, length > 0 ? along.divideScalar(length) : upwards);
      const dashed = this.dashed.indexOf(j);
      if (dashed < 0) place.compose(from, turn, new THREE.Vector3(1, Math.max(length, 1e-9), 1));
      else place.makeScale(0, 0, 0);
      for (const part of [this.edges, this.rods]) part.setMatrixAt(j, place);
      for (let k = 0; dashed >= 0 && k < DASHES; k++) {
        const begin = this.alongDashed(j, from, here, (k + 0.2) / DASHES);
        const dash = this.alongDashed(j, from, here, (k + 0.8) / DASHES).sub(begin);
        const long = dash.length();
        const aim = new THREE.Quaternion().setFromUnitVectors(upwards, long > 0 ? dash.divideScalar(long) : upwards);
        place.compose(begin, aim, new THREE.Vector3(1, Math.max(long, 1e-9), 1));
        for (const part of this.dashes) part.setMatrixAt(dashed * DASHES + k, place);
      }
    });
    this.assumed.forEach((_, k) => {
      const at = this.assumedPoint(k);
      for (const hollow of this.hollows) hollow.setMatrixAt(k, place.makeTranslation(at.x, at.y, at.z));
    });
    for (const part of [...this.dashes, ...this.hollows]) part.instanceMatrix.needsUpdate = true;
    for (const part of [...this.rings, this.balls]) part.instanceMatrix.needsUpdate = true;
    for (const part of [this.edges, this.rods]) part.instanceMatrix.needsUpdate = true;
  }

  showLeaves() {
    const place = new THREE.Matrix4();
    for (let k = 0; k < this.leaves.count; k++) {
      const here = this.point("leaves", this.scene.arrays.leaves.shape[1], k);
      const known = Number.isFinite(here.x);
      this.leaves.setMatrixAt(k, known ? place.makeTranslation(here.x, here.y, here.z) : place.makeScale(0, 0, 0));
    }
    this.leaves.instanceMatrix.needsUpdate = true;
  }

  follow() {
    const now = this.centre();
    const shift = now.clone().sub(this.followed || now);
    this.camera.position.add(shift);
    this.controls.target.add(shift);
    this.followed = now;
  }

  turn(around, over) {
    const away = this.camera.position.clone().sub(this.controls.target);
    away.applyAxisAngle(new THREE.Vector3(0, 1, 0), around);
    const side = new THREE.Vector3(0, 1, 0).cross(away).normalize();
    const tilted = away.clone().applyAxisAngle(side, over);
    this.camera.position.copy(this.controls.target).add(Math.abs(tilted.y) < 0.98 * tilted.length() ? tilted : away);
    this.controls.update();
    this.draw();
  }

  resize() {
    const canvas = this.renderer.domElement;
    const { clientWidth, clientHeight } = canvas;
    if (!clientWidth) return;
    this.renderer.setSize(clientWidth, clientHeight, false);
    this.camera.aspect = this.aspect(clientWidth, clientHeight);
    this.camera.fov = this.camera.aspect < 1 ? 35 / this.camera.aspect : 35;
    this.camera.updateProjectionMatrix();
    this.draw();
  }

  aspect(width, height) { return width / height; }

  draw() { this.renderer.render(this.world, this.camera); }

  tick(now) {
    if (!this.playing) return;
    const step = 1000 / ((this.scene.rate || 25) * this.speed);
    if (this.last !== undefined) this.elapsed += now - this.last;
    this.last = now;
    const frames = Math.floor(this.elapsed / step);
    if (frames) {
      this.elapsed -= frames * step;
      this.show((this.at + frames) % this.scene.frames.length);
    }
    requestAnimationFrame((t) => this.tick(t));
  }

  play(on) {
    if (on === this.playing) return;
    this.playing = on;
    this.last = undefined;
    this.changed(this);
    if (on) requestAnimationFrame((t) => this.tick(t));
  }
}

function element(name, text, parent) {
  const child = document.createElement(name);
  if (text !== undefined) child.textContent = text;
  parent.append(child);
  return child;
}

function row(kind, cells, parent) {
  const line = element("tr", undefined, parent);
  for (const cell of cells) {
    const place = element(kind, typeof cell === "number" && !Number.isInteger(cell) ? cell.toFixed(2) : String(cell ?? ""), line);
    if (typeof cell === "number") place.className = "n";
  }
}

function frameCaption(scene, at) {
  return `frame ${scene.frames[at]}` + (scene.fps ? ` · ${(scene.frames[at] / scene.fps).toFixed(2)} s` : "");
}

function showControls(player) {
  const { scene, at } = player;
  byId("scrub").value = at;
  byId("scrub").setAttribute("aria-valuetext", `frame ${scene.frames[at]}`);
  byId("when").textContent = frameCaption(scene, at);
  byId("play").textContent = player.playing ? "Pause" : "Play";
  byId("play").setAttribute("aria-pressed", String(player.playing));
}

// Connects a page's controls with a player: toggles are functions by the id of their box.
function wireControls(player, toggles) {
  const { scene } = player;
  for (const [id, act] of Object.entries(toggles)) {
    const box = byId(id);
    box.addEventListener("change", () => { act(box.checked); player.show(player.at); });
    act(box.checked);
  }
  const scrub = byId("scrub");
  scrub.max = scene.frames.length - 1;
  scrub.addEventListener("input", () => { player.play(false); player.show(Number(scrub.value)); });
  byId("play").addEventListener("click", () => player.play(!player.playing));
  byId("speed").addEventListener("change", (e) => { player.speed = Number(e.target.value); });
  byId("home").addEventListener("click", () => player.resetView());
  const turns = { "turn-left": [-0.3, 0], "turn-right": [0.3, 0], "turn-up": [0, -0.25], "turn-down": [0, 0.25] };
  for (const [id, [around, over]] of Object.entries(turns)) byId(id).addEventListener("click", () => player.turn(around, over));
}

function wireKeys(canvas, player) {
  canvas.addEventListener("keydown", (e) => {
    const keys = {
      " ": () => player.play(!player.playing),
      ArrowRight: () => (e.shiftKey ? player.turn(0.15, 0) : player.show(player.at + 1)),
      ArrowLeft: () => (e.shiftKey ? player.turn(-0.15, 0) : player.show(player.at - 1)),
      ArrowUp: () => player.turn(0, -0.15),
      ArrowDown: () => player.turn(0, 0.15),
      Home: () => player.show(0),
      End: () => player.show(player.scene.frames.length - 1),
    };
    if (keys[e.key]) { e.preventDefault(); keys[e.key](); }
  });
}
