// The player of a report: input, aligned mesh and skinned mesh, alone, over each other or side by side; error and confidence as
// colours; joints that can be selected.

const NEAR = 16; // pixels within which a pointer is at a joint
const RAMP = ["#2166ac", "#92c5de", "#f7f7f7", "#f4a582", "#b2182b"]; // from nothing to the most
const FADED = "#d8dce1";
const CORNERS = 48; // of a circle
const BOUND = "#e8b4ff"; // of no part, paler than all of them

// The flat region between two circles about the origin.
function annulus(inner, outer) {
  const [corners, faces] = [[], []];
  for (let k = 0; k < CORNERS; k++) {
    const turn = (2 * Math.PI * k) / CORNERS;
    for (const radius of [inner, outer]) corners.push(radius * Math.cos(turn), radius * Math.sin(turn), 0);
    const [a, b] = [2 * k, 2 * ((k + 1) % CORNERS)];
    faces.push(a, a + 1, b + 1, a, b + 1, b);
  }
  const flat = new THREE.BufferGeometry();
  flat.setAttribute("position", new THREE.BufferAttribute(new Float32Array(corners), 3));
  flat.setIndex(new THREE.BufferAttribute(new Uint16Array(faces), 1));
  return flat;
}

class ReportPlayer extends Player {
  constructor(scene, arrays, canvas, changed) {
    super(scene, arrays, canvas, changed);
    this.mode = "rig";
    this.colour = "parts";
    this.selected = null;
    this.hovered = null;
    this.isolated = false;
    this.selectionChanged = () => {};
    this.ramp = RAMP.map((c) => new THREE.Color(c));
    this.addRig();
    this.addMarks();
    this.addBounds();
  }

  addRig() {
    const { arrays, scene } = this;
    const count = scene.arrays.rest_vertices.shape[0];
    this.rig = new Surface(this.materials(1));
    this.rig.count = count;
    for (const name of ["position", "color"]) {
      this.rig.geometry.setAttribute(name, new THREE.BufferAttribute(new Float32Array(3 * count), 3).setUsage(THREE.DynamicDrawUsage));
    }
    this.rig.geometry.setIndex(new THREE.BufferAttribute(arrays.faces, 1));
    this.world.add(this.rig.mesh);
    this.veil = new THREE.MeshLambertMaterial({ color: 0x8a93a0, flatShading: true, side: THREE.DoubleSide, transparent: true, opacity: 0.35, depthWrite: false });
  }

  addMarks() {
    const ring = (radius, color) => {
      const mark = new THREE.Mesh(new THREE.SphereGeometry(this.scene.size * radius, 20, 14), new THREE.MeshBasicMaterial({ color, depthTest: false, transparent: true }));
      mark.visible = false;
      this.skeleton.add(mark);
      return mark;
    };
    this.marks = [ring(0.026, 0x000000), ring(0.021, 0xffe14d)];
    this.marks.forEach((mark, k) => { mark.renderOrder = 1 + k / 4; });
  }

  // About every joint a sphere that nine joints of ten lie in: a disc that faces the viewer, with a white and a black edge.
  addBounds() {
    const count = this.arrays.bound ? this.scene.joints.length : 0;
    const rings = [["#ffffff", 1, 0.94, 1], ["#000000", 1, 0.97, 1], [BOUND, 0.3, 0, 0.94]];
    this.bounds = new THREE.Group();
    this.bounds.visible = false;
    rings.forEach(([color, opacity, inner, outer], k) => {
      const discs = new THREE.InstancedMesh(annulus(inner, outer), new THREE.MeshBasicMaterial({ color, opacity, transparent: true, depthTest: false, side: THREE.DoubleSide }), Math.max(count, 1));
      discs.count = count;
      discs.frustumCulled = false;
      discs.renderOrder = 3.1 + k / 10; // above the joint's own dot, which is the larger one where the bound is small
      this.bounds.add(discs);
    });
    this.world.add(this.bounds);
  }

  faceBounds() {
    if (!this.bounds.visible) return;
    const joints = this.scene.joints.length;
    const place = new THREE.Matrix4();
    for (let j = 0; j < joints; j++) {
      const radius = this.arrays.bound[this.at * joints + j];
      place.compose(this.point("joints", joints, j), this.camera.quaternion, new THREE.Vector3(radius, radius, radius));
      for (const discs of this.bounds.children) discs.setMatrixAt(j, place);
    }
    for (const discs of this.bounds.children) discs.instanceMatrix.needsUpdate = true;
  }

  // x(v) = Σ w [R (v − rest) + x], as skeleton.glb has it.
  skin() {
    const { arrays, scene } = this;
    const [count, joints] = [this.rig.count, scene.joints.length];
    const out = this.rig.geometry.attributes.position.array;
    const turns = [];
    for (let j = 0; j < joints; j++) {
      const q = new THREE.Quaternion().fromArray(arrays.turns, 4 * (this.at * joints + j));
      turns.push(new THREE.Matrix4().makeRotationFromQuaternion(q).elements);
    }
    const at = 3 * this.at * joints;
    for (let v = 0; v < count; v++) {
      let [x, y, z] = [0, 0, 0];
      for (let k = 0; k < 4; k++) {
        const w = arrays.weight[4 * v + k];
        if (!w) continue;
        const j = arrays.influence[4 * v + k];
        const m = turns[j];
        const a = arrays.rest_vertices[3 * v] - arrays.rest[3 * j];
        const b = arrays.rest_vertices[3 * v + 1] - arrays.rest[3 * j + 1];
        const c = arrays.rest_vertices[3 * v + 2] - arrays.rest[3 * j + 2];
        x += w * (m[0] * a + m[4] * b + m[8] * c + arrays.joints[at + 3 * j]);
        y += w * (m[1] * a + m[5] * b + m[9] * c + arrays.joints[at + 3 * j + 1]);
        z += w * (m[2] * a + m[6] * b + m[10] * c + arrays.joints[at + 3 * j + 2]);
      }
      out[3 * v] = x; out[3 * v + 1] = y; out[3 * v + 2] = z;
    }
    this.rig.geometry.attributes.position.needsUpdate = true;
  }

  // A colour between 0, nothing, and 1, the most.
  shade(share) {
    const at = Math.max(0, Math.min(0.9999, share)) * (this.ramp.length - 1);
    return this.ramp[Math.floor(at)].clone().lerp(this.ramp[Math.floor(at) + 1], at % 1);
  }

  paint(surface, labels, begin, count) {
    const { arrays, scene } = this;
    const joints = scene.joints.length;
    const colours = surface.mesh.geometry.attributes.color;
    if (!colours) return;
    const parts = scene.palette.map((c) => new THREE.Color(c));
    const [none, faded] = [new THREE.Color(scene.not_rigid), new THREE.Color(FADED)];
    const doubt = scene.joints.map((_, j) => this.shade(1 - arrays.confidence[this.at * joints + j] / 255));
    const shades = [...Array(256).keys()].map((n) => this.shade(n / 255));
    const [own, rgb] = [new THREE.Color(), surface === this.input ? arrays.input_colours : arrays.colours];
    for (let i = 0; i < count; i++) {
      const label = labels[begin + i];
      let colour = label < 0 ? none : parts[label % parts.length];
      if (this.colour === "error") colour = surface === this.input ? faded : shades[arrays.error[this.at * this.rig.count + i]];
      if (this.colour === "input") colour = own.setHex((rgb[3 * (begin + i)] << 16) | (rgb[3 * (begin + i) + 1] << 8) | rgb[3 * (begin + i) + 2]);
      if (this.colour === "confidence") colour = label < 0 ? none : doubt[label];
      if (this.isolated && this.selected !== null && label !== this.selected) colour = faded;
      colour.toArray(colours.array, 3 * i);
    }
    colours.needsUpdate = true;
  }

  layers(mode) {
    this.aligned.mesh.visible = mode === "aligned";
    this.rig.mesh.visible = mode === "rig" || mode === "overlay";
    this.input.mesh.visible = mode === "input" || mode === "overlay";
    for (const surface of [this.aligned, this.rig, this.input]) surface.showParts(this.colour !== "plain");
    if (mode === "overlay") this.input.mesh.material = this.veil;
  }

  show(at) {
    if (!this.rig) return;
    this.at = Math.max(0, Math.min(this.scene.frames.length - 1, at));
    this.skin();
    this.input.mesh.visible = ["input", "overlay", "sides"].includes(this.mode);
    super.show(at);
  }

  showInput() {
    super.showInput();
    this.painted = null; // its mesh is new
  }

  showSkeleton() {
    super.showSkeleton();
    if (!this.marks) return;
    const marked = this.hovered ?? this.selected;
    for (const mark of this.marks) {
      mark.visible = marked !== null;
      if (mark.visible) mark.position.copy(this.point("joints", this.scene.joints.length, marked));
    }
  }

  repaint() {
    const { arrays } = this;
    this.paint(this.rig, arrays.label, 0, this.rig.count);
    this.paint(this.aligned, arrays.label, 0, this.rig.count);
    const [v, w] = [arrays.input_vertex_offsets[this.at], arrays.input_vertex_offsets[this.at + 1]];
    if (this.input.mesh.geometry.attributes.color?.count === w - v) this.paint(this.input, arrays.input_label, v, w - v);
  }

  select(joint) {
    this.selected = joint;
    this.selectionChanged(joint);
    this.show(this.at);
  }

  hover(joint) {
    if (joint === this.hovered) return;
    this.hovered = joint;
    this.showSkeleton();
    this.draw();
  }

  draw() {
    if (!this.rig) return;
    if (this.painted !== `${this.at} ${this.mode} ${this.colour} ${this.selected} ${this.isolated}`) {
      this.painted = `${this.at} ${this.mode} ${this.colour} ${this.selected} ${this.isolated}`;
      this.repaint();
    }
    this.faceBounds();
    const { renderer, camera } = this;
    const [width, height] = [renderer.domElement.clientWidth, renderer.domElement.clientHeight];
    if (this.mode !== "sides") {
      this.layers(this.mode);
      renderer.setScissorTest(false);
      renderer.setViewport(0, 0, width, height);
      super.draw();
    } else {
      renderer.setScissorTest(true);
      ["input", "rig"].forEach((mode, k) => {
        const half = [(k * width) / 2, 0, width / 2, height];
        this.layers(mode);
        renderer.setViewport(...half);
        renderer.setScissor(...half);
        super.draw();
      });
    }
    this.drawn?.();
  }

  aspect(width, height) { return (this.mode === "sides" ? width / 2 : width) / height; }

  // Where a joint is drawn, in pixels of the stage; side by side, in the right half.
  place(j) { return this.placeOf(this.point("joints", this.scene.joints.length, j)); }

  placeOf(point) {
    const { clientWidth, clientHeight } = this.renderer.domElement;
    const p = point.project(this.camera);
    const width = this.mode === "sides" ? clientWidth / 2 : clientWidth;
    return [(this.mode === "sides" ? width : 0) + ((p.x + 1) / 2) * width, ((1 - p.y) / 2) * clientHeight];
  }

  jointAt(x, y) {
    const half = this.renderer.domElement.clientWidth / 2;
    let [best, nearest] = [null, NEAR];
    this.scene.joints.forEach((_, j) => {
      const [px, py] = this.place(j);
      const shift = this.mode === "sides" && x < half ? half : 0;
      const away = Math.hypot(px - shift - x, py - y);
      if (away < nearest) [best, nearest] = [j, away];
    });
    return best;
  }
}
