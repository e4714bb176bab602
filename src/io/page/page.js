// SPDX-License-Identifier: BSD-3-Clause
// What the page does: opens the map piece by piece, and follows mouse, fingers and keys.

const SLOW_MS = 60, SLICE_MS = 200, IDLE_MS = 250;
const element = name => document.getElementById(name);
const canvas = element("map");
const facts = JSON.parse(element("facts").textContent);
const orbit = new Orbit(facts.box);
let scene = null, asked = false, sharpness = 1, last_frame_ms = 0, idle = 0;

function fail(text) {
  element("trouble").textContent = text;
  element("trouble").hidden = false;
  document.documentElement.dataset.state = "failed";
}

function ground() {
  const numbers = getComputedStyle(document.body).backgroundColor.match(/[\d.]+/g);
  return numbers.slice(0, 3).map(x => x / 255);
}

function fitCanvas() {
  const ratio = sharpness * Math.min(2, window.devicePixelRatio || 1);
  const [width, height] = [canvas.clientWidth, canvas.clientHeight].map(x => Math.max(1, Math.round(ratio * x)));
  if (canvas.width !== width || canvas.height !== height) Object.assign(canvas, { width, height });
}

/// A bar of 1, 2 or 5 times a power of ten of metres, at the point that the view turns around.
function drawScale() {
  const shorter = Math.min(canvas.clientWidth, canvas.clientHeight);
  const most = orbit.metres(Math.min(160, 0.4 * shorter) / shorter);
  const power = 10 ** Math.floor(Math.log10(most));
  const long = [5, 2, 1].map(x => x * power).find(x => x <= most) || power;
  element("scale").firstElementChild.style.width = `${Math.round(shorter * long / orbit.metres(1))}px`;
  element("scale").lastElementChild.textContent = long >= 1 ? `${long} m` : `${Math.round(100 * long)} cm`;
}

function draw() {
  fitCanvas();
  scene.draw(orbit, ground());
  drawScale();
}

/// Draws when the browser is ready to. Where that is slow, with fewer pixels while the view moves.
function redraw(moves = false) {
  if (!scene || asked) return;
  asked = true;
  requestAnimationFrame(now => {
    asked = false;
    const took = now - last_frame_ms;
    last_frame_ms = now;
    if (moves && took < 1000) sharpness = Math.min(1, Math.max(0.35, sharpness * (took > SLOW_MS ? 0.85 : 1.05)));
    draw();
    clearTimeout(idle);
    if (sharpness < 1) {
      idle = setTimeout(() => {
        sharpness = 1;
        redraw();
      }, IDLE_MS);
    }
  });
}

function tell() {
  const count = (facts.shows === "surfels" ? facts.vertices : facts.triangles).toLocaleString("en");
  const size = facts.box.high.map((x, i) => (x - facts.box.low[i]).toFixed(1)).join(" x ");
  const step = facts.step_m > 0 ? `, cells of ${(100 * facts.step_m).toFixed(1)} cm` : "";
  element("told").textContent = `${count} ${facts.shows}${step}, ${size} m`;
}

/// Pieces in slices of time, so that what is there already is seen and can be turned.
async function open() {
  tell();
  for (const [i, about] of facts.chunks.entries()) {
    const data = element(`chunk${i}`);
    scene.add(about, bytesOf(data));
    data.remove();
    if (performance.now() - last_frame_ms < SLICE_MS) continue;
    redraw();
    await new Promise(resolve => setTimeout(resolve));
  }
  draw();
  scene.finish();
  document.documentElement.dataset.state = "open";
  document.documentElement.dataset.openedMs = Math.round(performance.now());
}

const fingers = new Map();

function spread() {
  const [a, b] = [...fingers.values()];
  return { x: (a.x + b.x) / 2, y: (a.y + b.y) / 2, apart: Math.max(1, Math.hypot(a.x - b.x, a.y - b.y)) };
}

function drag(event) {
  const before = fingers.get(event.pointerId);
  if (!before) return;
  const here = { x: event.clientX, y: event.clientY, button: before.button };
  const shorter = Math.min(canvas.clientWidth, canvas.clientHeight);
  if (fingers.size === 2) {
    const was = spread();
    fingers.set(event.pointerId, here);
    const is = spread();
    orbit.move((is.x - was.x) / shorter, (was.y - is.y) / shorter);
    orbit.approach(was.apart / is.apart);
  } else {
    const [right, down] = [(here.x - before.x) / shorter, (here.y - before.y) / shorter];
    fingers.set(event.pointerId, here);
    if (here.button !== 0 || event.shiftKey) orbit.move(right, -down);
    else orbit.turn(-4 * right, 4 * down);
  }
  redraw(true);
}

function release(event) {
  fingers.delete(event.pointerId);
  canvas.classList.toggle("held", fingers.size > 0);
}

function press(key, shift) {
  const ways = { ArrowLeft: [-1, 0], ArrowRight: [1, 0], ArrowUp: [0, 1], ArrowDown: [0, -1] };
  if (key in ways) {
    const [right, top] = ways[key].map(x => 0.1 * x);
    if (shift) orbit.move(-right, -top);
    else orbit.turn(right, top);
  } else if (key === "+" || key === "=") orbit.approach(0.85);
  else if (key === "-") orbit.approach(1 / 0.85);
  else if (key === "0") orbit.whole();
  else if (key === "1") orbit.above();
  else if (key === "l" || key === "L") changeTheme();
  else return false;
  redraw();
  return true;
}

function setTheme(dark) {
  document.documentElement.dataset.theme = dark ? "dark" : "light";
  element("light").textContent = dark ? "Light" : "Dark";
  redraw();
}

function changeTheme() {
  setTheme(document.documentElement.dataset.theme !== "dark");
}

function listen() {
  canvas.addEventListener("pointerdown", event => {
    if (fingers.size >= 2) return;
    canvas.setPointerCapture(event.pointerId);
    fingers.set(event.pointerId, { x: event.clientX, y: event.clientY, button: event.button });
    canvas.classList.add("held");
  });
  canvas.addEventListener("pointermove", drag);
  ["pointerup", "pointercancel"].forEach(name => canvas.addEventListener(name, release));
  canvas.addEventListener("contextmenu", event => event.preventDefault());
  canvas.addEventListener("wheel", event => {
    event.preventDefault();
    const lines = event.deltaMode === 1 ? 33 : 1;
    orbit.approach(Math.exp(Math.max(-1, Math.min(1, 0.0015 * lines * event.deltaY))));
    redraw(true);
  }, { passive: false });
  canvas.addEventListener("dblclick", () => press("0", false));
  canvas.addEventListener("keydown", event => {
    if (!event.ctrlKey && !event.metaKey && !event.altKey && press(event.key, event.shiftKey)) event.preventDefault();
  });
  canvas.addEventListener("webglcontextlost", event => {
    event.preventDefault();
    scene = null;
    fail("The graphics card has lost the map: load the page again.");
  });
  element("whole").addEventListener("click", () => press("0", false));
  element("above").addEventListener("click", () => press("1", false));
  element("light").addEventListener("click", changeTheme);
  element("help").addEventListener("click", () => {
    element("how").hidden = !element("how").hidden;
    element("help").setAttribute("aria-expanded", String(!element("how").hidden));
  });
  window.addEventListener("resize", () => redraw());
}

const prefers = window.matchMedia("(prefers-color-scheme: dark)");
prefers.addEventListener("change", event => setTheme(event.matches));
setTheme(prefers.matches);
listen();
try {
  scene = new Scene(canvas, facts);
  open().catch(error => fail(error.message));
} catch (error) {
  fail(error.message);
}
