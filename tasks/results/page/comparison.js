// The page of a comparison: two players with one camera and one frame, a curve, and tables whose joints can be selected.

const SVG = "http://www.w3.org/2000/svg";
const MARGIN = { left: 46, right: 10, top: 10, bottom: 24 };
const HEIGHT = 190;
const NEAR = 16; // pixels within which a click selects a joint

class ComparedPlayer extends Player {
  constructor(scene, arrays, canvas, changed, only, colour) {
    super(scene, arrays, canvas, changed);
    this.only = new Set(only);
    this.marked = null;
    for (const j of this.only) this.balls.setColorAt(j, new THREE.Color(colour));
    this.balls.instanceColor.needsUpdate = true;
    this.marks = [[0.026, 0x000000], [0.021, 0xffffff]].map(([radius, color], k) => {
      const material = new THREE.MeshBasicMaterial({ color, depthTest: false, transparent: true });
      const mark = new THREE.Mesh(new THREE.SphereGeometry(scene.size * radius, 20, 14), material);
      mark.renderOrder = 1 + k / 2;
      mark.visible = false;
      this.skeleton.add(mark);
      return mark;
    });
  }

  showSkeleton() {
    super.showSkeleton();
    const place = new THREE.Matrix4();
    for (const j of this.only) {
      const here = this.point("joints", this.scene.joints.length, j);
      this.balls.setMatrixAt(j, place.compose(here, new THREE.Quaternion(), new THREE.Vector3(1.5, 1.5, 1.5)));
    }
    for (const mark of this.marks) {
      mark.visible = this.marked !== null;
      if (mark.visible) mark.position.copy(this.point("joints", this.scene.joints.length, this.marked));
    }
  }

  jointAt(x, y) {
    const { clientWidth, clientHeight } = this.renderer.domElement;
    let [best, nearest] = [null, NEAR];
    this.scene.joints.forEach((_, j) => {
      const p = this.point("joints", this.scene.joints.length, j).project(this.camera);
      const away = Math.hypot(((p.x + 1) / 2) * clientWidth - x, ((1 - p.y) / 2) * clientHeight - y);
      if (away < nearest) [best, nearest] = [j, away];
    });
    return best;
  }
}

function copyCamera(from, to) {
  to.camera.position.copy(from.camera.position);
  to.camera.quaternion.copy(from.camera.quaternion);
  to.controls.target.copy(from.controls.target);
  to.draw();
}

function svg(name, attributes, parent) {
  const child = document.createElementNS(SVG, name);
  for (const [key, value] of Object.entries(attributes)) child.setAttribute(key, value);
  parent.append(child);
  return child;
}

// Curves over the frames, with a line at the frame that is shown; a click goes to a frame.
class Chart {
  constructor(frames, go) {
    this.frames = frames;
    this.curves = [];
    this.now = frames[0];
    this.place = byId("chart");
    const select = (e) => {
      const share = (e.offsetX - MARGIN.left) / (this.place.clientWidth - MARGIN.left - MARGIN.right);
      go(this.frames[Math.round(Math.max(0, Math.min(1, share)) * (this.frames.length - 1))]);
    };
    this.place.addEventListener("pointerdown", (e) => { this.place.setPointerCapture(e.pointerId); select(e); });
    this.place.addEventListener("pointermove", (e) => { if (e.buttons) select(e); });
    new ResizeObserver(() => this.draw()).observe(this.place);
  }

  x(t) { return MARGIN.left + (t / Math.max(this.frames.length - 1, 1)) * (this.place.clientWidth - MARGIN.left - MARGIN.right); }

  y(value) { return HEIGHT - MARGIN.bottom - (value / this.highest) * (HEIGHT - MARGIN.top - MARGIN.bottom); }

  set(name, curves) {
    this.curves = curves;
    byId("chart-name").textContent = name;
    byId("chart-legend").textContent = "";
    curves.forEach((curve) => {
      const entry = element("span", undefined, byId("chart-legend"));
      element("span", undefined, entry).className = `line line-${curve.run}`;
      entry.append(` ${curve.name}`);
    });
    this.draw();
  }

  draw() {
    this.place.textContent = "";
    const known = this.curves.flatMap((c) => c.values.filter((v) => v !== null));
    this.highest = 1.1 * Math.max(...known, 0.1);
    for (const value of [0, this.highest / 2, this.highest / 1.1]) {
      svg("line", { class: "grid", x1: MARGIN.left, x2: this.x(this.frames.length - 1), y1: this.y(value), y2: this.y(value) }, this.place);
      svg("text", { x: MARGIN.left - 6, y: this.y(value) + 4, "text-anchor": "end" }, this.place).textContent = value.toFixed(value < 10 ? 1 : 0);
    }
    const last = this.frames.length - 1;
    for (const t of new Set([0, Math.round(last / 2), last])) {
      const anchor = t === 0 ? "start" : t === last ? "end" : "middle";
      svg("text", { x: this.x(t), y: HEIGHT - 6, "text-anchor": anchor }, this.place).textContent = `frame ${this.frames[t]}`;
    }
    for (const curve of this.curves) {
      const points = curve.values.map((v, t) => (v === null ? "" : `${this.x(t)},${this.y(v)}`)).filter(Boolean);
      if (points.length) svg("polyline", { class: `curve line-${curve.run}`, points: points.join(" ") }, this.place);
    }
    this.cursor = svg("line", { class: "cursor", y1: MARGIN.top, y2: HEIGHT - MARGIN.bottom }, this.place);
    this.show(this.now);
  }

  show(frame) {
    this.now = frame;
    const x = this.x(this.frames.indexOf(frame));
    this.cursor.setAttribute("x1", x);
    this.cursor.setAttribute("x2", x);
  }
}

class Selection {
  constructor(content, chart, players) {
    Object.assign(this, { content, chart, players, row: null });
    for (const button of document.querySelectorAll("[data-row]")) {
      button.addEventListener("click", () => this.select(this.row === Number(button.dataset.row) ? null : Number(button.dataset.row)));
    }
    document.addEventListener("keydown", (e) => { if (e.key === "Escape") this.select(null); });
  }

  select(number) {
    this.row = number;
    const row = number === null ? this.content.mean : this.content.rows[number];
    this.chart.set(row.name, row.curves);
    for (const button of document.querySelectorAll("[data-row]")) {
      button.setAttribute("aria-pressed", String(Number(button.dataset.row) === number));
    }
    for (const [player, joint] of [[this.players[0], row.a], [this.players[1], row.b]]) {
      if (!player) continue;
      player.marked = joint;
      player.showSkeleton();
      player.draw();
    }
  }

  selectJoint(run, joint) {
    const number = this.content.rows.findIndex((row) => row[run] === joint);
    this.select(joint === null || number < 0 ? null : number);
  }
}

function wireClicks(canvas, run, player, selection) {
  let from = null;
  canvas.addEventListener("pointerdown", (e) => { from = [e.offsetX, e.offsetY]; });
  canvas.addEventListener("pointerup", (e) => {
    const still = from && Math.hypot(e.offsetX - from[0], e.offsetY - from[1]) < 4;
    if (still) selection.selectJoint(run, player.jointAt(e.offsetX, e.offsetY));
  });
}

async function players(content, changed) {
  const made = [];
  for (const run of ["a", "b"]) {
    const scene = JSON.parse(byId(`scene-${run}`).textContent);
    const arrays = arraysOf(scene, await payload(`payload-${run}`));
    const listens = run === "a" ? changed : () => {};
    made.push(new ComparedPlayer(scene, arrays, byId(`stage-${run}`), listens, content[`only_${run}`], content.only_colour));
  }
  return made;
}

function wire([a, b], selection) {
  const each = (act) => (on) => [a, b].forEach((player) => act(player, on));
  a.controls.addEventListener("change", () => copyCamera(a, b));
  b.controls.addEventListener("change", () => copyCamera(b, a));
  wireControls(a, {
    "see-aligned": each((p, on) => { p.aligned.mesh.visible = on; }),
    "see-input": each((p, on) => { p.input.mesh.visible = on; }),
    "see-parts": each((p, on) => { p.aligned.showParts(on); p.input.showParts(on); }),
    "see-skeleton": each((p, on) => { p.skeleton.visible = on; }),
    follow: (on) => { a.following = on; if (on) a.followed = a.centre(); },
  });
  for (const [run, player] of [["a", a], ["b", b]]) {
    const canvas = byId(`stage-${run}`);
    wireKeys(canvas, a);
    wireClicks(canvas, run, player, selection);
    new ResizeObserver(() => player.resize()).observe(canvas);
    player.resize();
  }
}

async function begin() {
  const content = JSON.parse(byId("comparison").textContent);
  let both = [];
  const go = (frame) => {
    if (!both.length) return chart.show(frame);
    const away = both[0].scene.frames.map((f) => Math.abs(f - frame));
    both[0].play(false);
    return both[0].show(away.indexOf(Math.min(...away)));
  };
  const chart = new Chart(content.frames, go);
  const changed = (a) => {
    if (!both.length) return;
    both[1].show(a.at);
    copyCamera(a, both[1]);
    showControls(a);
    chart.show(a.scene.frames[a.at]);
  };
  try {
    both = await players(content, changed);
  } catch (error) {
    byId("player-note").textContent = `The players need a browser with WebGL: ${error.message}. The rest of the page works without it.`;
    byId("player-note").hidden = false;
  }
  const selection = new Selection(content, chart, both);
  if (both.length) {
    wire(both, selection);
    both[0].show(0);
  }
  selection.select(null);
  window.kinetree = { players: both, selection, chart };
  document.body.dataset.ready = "yes";
  const still = window.matchMedia("(prefers-reduced-motion: reduce)").matches;
  if (both.length && !still && both[0].scene.frames.length > 1) both[0].play(true);
}

begin();
