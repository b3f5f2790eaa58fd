// The page of a report: one player, and what ran.

function wire(player) {
  wireControls(player, {
    "see-aligned": (on) => { player.aligned.mesh.visible = on; },
    "see-input": (on) => { player.input.mesh.visible = on; },
    "see-parts": (on) => { player.aligned.showParts(on); player.input.showParts(on); },
    "see-skeleton": (on) => { player.skeleton.visible = on; },
    "see-leaves": (on) => { player.leaves.visible = on; },
    follow: (on) => { player.following = on; if (on) player.followed = player.centre(); },
  });
  byId("interval").addEventListener("change", (e) => { if (e.target.value !== "") { player.play(false); player.show(Number(e.target.value)); } });
  wireKeys(byId("stage"), player);
  new ResizeObserver(() => player.resize()).observe(byId("stage"));
}

// What the page says of a frame leads to that frame, or to the nearest that the player shows.
function wireLinks(player) {
  for (const link of document.querySelectorAll("button.go[data-frame]")) {
    link.addEventListener("click", () => {
      const wanted = Number(link.dataset.frame);
      const away = player.scene.frames.map((frame) => Math.abs(frame - wanted));
      player.play(false);
      player.show(away.indexOf(Math.min(...away)));
      byId("stage").scrollIntoView({ block: "nearest" });
    });
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
}

async function begin() {
  const run = JSON.parse(byId("run-record").textContent.replace("/*what ran*/", ""));
  if (run) showRun(run);
  const scene = JSON.parse(byId("scene").textContent);
  if (!scene.frames.length) return;
  let player;
  try {
    player = new Player(scene, arraysOf(scene, await payload("payload")), byId("stage"), showControls);
  } catch (error) {
    byId("player-note").textContent = `The player needs a browser with WebGL: ${error.message}. The rest of the page works without it.`;
    byId("player-note").hidden = false;
    return;
  }
  wire(player);
  wireLinks(player);
  player.resize();
  player.show(0);
  window.kinetree = player;
  document.body.dataset.ready = "yes";
  if (!window.matchMedia("(prefers-reduced-motion: reduce)").matches && scene.frames.length > 1) player.play(true);
}

begin();
