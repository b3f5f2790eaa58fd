// The page of a report: one player with its controls, what the page says of frames and joints, and what ran.

const FILES = ["skeleton.glb", "skeleton.bvh", "skeleton.json"]; // offered where the run left them
const MODES = ["rig", "input", "aligned", "overlay", "sides"];

function wire(player) {
  wireControls(player, {
    "see-skeleton": (on) => { player.skeleton.visible = on; },
    "see-names": (on) => { byId("labels").hidden = !on; },
    "see-leaves": (on) => { player.leaves.visible = on; },
    isolate: (on) => { player.isolated = on; },
    follow: (on) => { player.following = on; if (on) player.followed = player.centre(); },
    ...(player.arrays.bound ? { "see-bounds": (on) => { player.bounds.visible = on; } } : {}),
  });
  byId("mode").addEventListener("change", (e) => setMode(player, e.target.value));
  byId("colour").addEventListener("change", (e) => setColour(player, e.target.value));
  byId("interval").addEventListener("change", (e) => { if (e.target.value !== "") { player.play(false); player.show(Number(e.target.value)); } });
  wireKeys(byId("stage"), player);
  document.addEventListener("keydown", (e) => { if (e.key === "Escape") player.select(null); });
  byId("stage").addEventListener("keydown", (e) => {
    if (/^[1-5]$/.test(e.key)) { byId("mode").value = MODES[e.key - 1]; setMode(player, MODES[e.key - 1]); }
    if (e.key.toLowerCase() === "b" && !e.ctrlKey && !e.metaKey && !e.altKey) byId("see-bounds")?.click();
  });
  new ResizeObserver(() => { player.resize(); drawBands(player); }).observe(byId("stage"));
}

function setMode(player, mode) {
  const before = player.mode;
  player.mode = mode;
  byId("sides").hidden = mode !== "sides";
  if (mode === "overlay" && player.colour === "parts") { byId("colour").value = "error"; setColour(player, "error"); }
  player.resize();
  if ((before === "sides") !== (mode === "sides")) player.resetView();
  player.show(player.at);
}

function setColour(player, colour) {
  player.colour = colour;
  byId("scale").hidden = colour !== "error" && colour !== "confidence";
  byId("scale-low").textContent = colour === "error" ? "on the input" : "confidence 1";
  byId("scale-high").textContent = colour === "error" ? `${(100 * player.scene.most).toFixed(0)} % of the body's size away` : "0";
  player.show(player.at);
}

// Names beside the joints; of all where they are wanted, always of the one under the pointer and of the selected one.
function drawLabels(player) {
  const all = !byId("labels").hidden;
  const { joints } = player.scene;
  const place = byId("names");
  const wanted = joints.map((_, j) => j).filter((j) => j === player.selected || j === player.hovered || (all && joints[j].kind !== "leaf"));
  const texts = wanted.map((j) => [joints[j].label, player.place(j)]);
  if (all) texts.push(...player.assumed.map((joint, k) => [`${joint.label} (assumed)`, player.placeOf(player.assumedPoint(k))]));
  while (place.children.length < texts.length) element("span", "", place);
  while (place.children.length > texts.length) place.lastChild.remove();
  const middle = joints.length ? player.place(0)[0] : 0;
  texts.forEach(([text, [x, y]], k) => {
    const outwards = x < middle ? `translate(${(x - 10).toFixed(1)}px, ${(y - 9).toFixed(1)}px) translateX(-100%)` : `translate(${(x + 10).toFixed(1)}px, ${(y - 9).toFixed(1)}px)`;
    const label = place.children[k];
    label.textContent = text;
    label.style.transform = outwards;
  });
}

// What the stage shows, in words; while it plays, the words stay those of the frame at which it began.
function describe(player) {
  if (player.playing) return;
  const { scene, arrays, at, mode, colour, selected } = player;
  const { joints } = scene;
  const named = (state) => joints.filter((_, j) => arrays.state[at * joints.length + j] === state).map((joint) => joint.label).join(", ");
  const modeWords = byId("mode").selectedOptions[0].textContent;
  const colourWords = { parts: "a colour for every part", error: "coloured by the distance to the input", confidence: "coloured by confidence", input: "in the colours of the input", plain: "without colours" }[colour];
  const skeleton = player.skeleton.visible ? `, and its skeleton of ${joints.filter((j) => j.kind === "joint").length} joints under ${joints[0].label}` : "";
  const words = [`The body at ${frameCaption(scene, at)}, one of ${scene.frames.length} frames: ${mode === "sides" ? "" : "the "}${modeWords}, ${colourWords}${skeleton}.`];
  for (const [state, word] of [[2, "Wrong"], [1, "Uncertain"]]) if (named(state)) words.push(`${word}: ${named(state)}.`);
  if (player.assumed.length) words.push(`Assumed, not found: ${player.assumed.map((joint) => joint.label).join(", ")}.`);
  if (selected !== null) words.push(`Selected: ${joints[selected].label}, ${joints[selected].kind}${boundWords(player, selected)}.`);
  byId("stage").setAttribute("aria-label", words.join(" "));
}

// The bound of a joint in this frame, in words; empty where it is not known.
function boundWords(player, j) {
  const { scene, arrays, at } = player;
  const bound = arrays.bound ? arrays.bound[at * scene.joints.length + j] : 0;
  return bound ? `, 90 % bound ${Number(bound.toPrecision(2))}${scene.unit ? ` ${scene.unit}` : ""}` : "";
}

function wirePicking(player) {
  const canvas = byId("stage");
  let from = null;
  canvas.addEventListener("pointerdown", (e) => { from = [e.offsetX, e.offsetY]; });
  canvas.addEventListener("pointerup", (e) => {
    const still = from && Math.hypot(e.offsetX - from[0], e.offsetY - from[1]) < 4;
    if (still) player.select(player.jointAt(e.offsetX, e.offsetY));
  });
  canvas.addEventListener("pointermove", (e) => { if (!e.buttons) player.hover(player.jointAt(e.offsetX, e.offsetY)); });
  canvas.addEventListener("pointerleave", () => player.hover(null));
  const rows = [...document.querySelectorAll("tr[data-joint]")];
  for (const line of rows) {
    const joint = Number(line.dataset.joint);
    line.querySelector("button").addEventListener("click", () => {
      player.select(player.selected === joint ? null : joint);
      if (player.selected !== null) byId("stage").scrollIntoView({ block: "nearest" });
    });
    line.addEventListener("pointerenter", () => player.hover(joint));
    line.addEventListener("pointerleave", () => player.hover(null));
  }
  player.selectionChanged = (joint) => {
    for (const line of rows) line.querySelector("button").setAttribute("aria-pressed", String(Number(line.dataset.joint) === joint));
    const place = byId("selected");
    place.textContent = joint === null ? "" : player.scene.joints[joint].label;
    drawBands(player);
  };
}

// What the page says of a frame and a joint leads there, or to the nearest frame that the player shows.
function wireLinks(player) {
  for (const link of document.querySelectorAll("button.go")) {
    link.addEventListener("click", () => {
      if (link.dataset.joint !== undefined) player.select(Number(link.dataset.joint));
      if (link.dataset.frame !== undefined) {
        const away = player.scene.frames.map((frame) => Math.abs(frame - Number(link.dataset.frame)));
        player.play(false);
        player.show(away.indexOf(Math.min(...away)));
      }
      byId("stage").scrollIntoView({ block: "nearest" });
    });
  }
}

// Below the slider: intervals of one topology in turn, and how far the body, or the selected joint, is to be trusted.
function drawBands(player) {
  const canvas = byId("bands");
  const { scene, arrays } = player;
  const [width, height, count] = [canvas.clientWidth, canvas.clientHeight, scene.frames.length];
  if (!width) return;
  const sharp = window.devicePixelRatio || 1;
  canvas.width = width * sharp;
  canvas.height = height * sharp;
  const pen = canvas.getContext("2d");
  pen.scale(sharp, sharp);
  const colour = (name) => getComputedStyle(document.documentElement).getPropertyValue(name);
  const x = (t) => (count > 1 ? 8 + (t / (count - 1)) * (width - 16) : width / 2); // a slider's thumb is 16 pixels wide
  const step = count > 1 ? (width - 16) / (count - 1) : width;
  const joints = scene.joints.length;
  for (let t = 0; t < count; t++) {
    const turn = scene.intervals.filter((i) => i.at <= t).length % 2;
    pen.fillStyle = colour(turn ? "--line" : "--soft");
    pen.fillRect(x(t) - step / 2, 0, step + 0.5, height * 0.3);
    const states = player.selected === null ? arrays.state.subarray(t * joints, (t + 1) * joints) : [arrays.state[t * joints + player.selected]];
    pen.fillStyle = colour(["--good", "--warn", "--bad"][Math.max(...states)]);
    pen.fillRect(x(t) - step / 2, height * 0.4, step + 0.5, height * 0.6);
  }
}

// The record of the run is inserted into the page when the run has ended.
function showRun(run) {
  const place = byId("ran");
  place.textContent = "";
  const counts = Object.entries(run.nodes || {}).filter(([, n]) => n).map(([name, n]) => `${n} ${name}`).join(", ");
  element("p", `${run.run || "This run"} ${run.status}: ${counts || "nothing to do"}${run.seconds === undefined ? "" : ` in ${run.seconds} s`}.`, place);
  for (const failure of run.failures || []) element("p", `${failure.node} failed: ${failure.message}`, place).className = "warnings";
  const scroll = element("div", undefined, place);
  scroll.className = "scroll";
  scroll.tabIndex = 0;
  const table = element("table", undefined, scroll);
  row("th", ["task", "per", "reads", "ran", "reused", "failed", "seconds"], element("thead", undefined, table));
  const body = element("tbody", undefined, table);
  for (const [name, task] of Object.entries(run.graph || {})) {
    const counts = (run.tasks || {})[name] || {};
    row("td", [name, task.over, task.reads.join(", "), counts.ran || 0, counts.fresh || 0, counts.failed || 0, Number(counts.seconds || 0)], body);
  }
  for (const [heading, content] of [["Configuration, where it differs from the default", run.config], ["Versions", run.versions]]) {
    if (!content) continue;
    const folded = element("details", undefined, place);
    element("summary", heading, folded);
    element("pre", typeof content === "string" ? content : JSON.stringify(content, null, 2), folded);
  }
  for (const name of FILES.filter((file) => (run.files || []).includes(file))) {
    const link = element("a", name, byId("files"));
    link.href = encodeURIComponent(name);
    link.download = name;
    link.className = "button";
  }
}

function nameTheData(run) {
  const name = /^ +input: ['"]?(.+?)['"]?$/m.exec((run && run.config) || "");
  if (!name) return;
  const data = name[1].replace(/[/\\]+$/, "").split(/[/\\]/).pop();
  byId("title").textContent = `${data}: ${byId("title").textContent.replace(/^kinetree: /, "")}`;
  document.title = byId("title").textContent;
}

async function begin() {
  const run = JSON.parse(byId("run-record").textContent.replace("/*what ran*/", ""));
  if (run) showRun(run);
  nameTheData(run);
  const scene = JSON.parse(byId("scene").textContent);
  if (!scene.frames.length) return;
  let player;
  try {
    player = new ReportPlayer(scene, arraysOf(scene, await payload("payload")), byId("stage"), showControls);
  } catch (error) {
    byId("player-note").textContent = `The player needs a browser with WebGL: ${error.message}. The rest of the page works without it.`;
    byId("player-note").hidden = false;
    return;
  }
  player.drawn = () => { drawLabels(player); describe(player); };
  wire(player);
  wirePicking(player);
  wireLinks(player);
  player.resize();
  player.resetView();
  player.show(0);
  drawBands(player);
  window.kinetree = player;
  document.body.dataset.ready = "yes";
  if (!window.matchMedia("(prefers-reduced-motion: reduce)").matches && scene.frames.length > 1) player.play(true);
}

begin();
