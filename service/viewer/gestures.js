/** Pointers, wheel and keys of a view: pan, zoom, fit, tap and hover. */

const TAP_PIXELS = 6;

/**
 * @typedef {object} Hands
 * @property {() => void} moved the camera has changed
 * @property {() => void} fit
 * @property {(px: number, py: number) => void} tapped
 * @property {(at: [number, number] | null) => void} hovered
 * @property {(event: KeyboardEvent) => boolean} key whether a key was used up
 */

/**
 * @param {HTMLCanvasElement} canvas
 * @param {import("./camera.js").Camera} camera
 * @param {Hands} hands
 */
export function handle(canvas, camera, hands) {
  /** @type {Map<number, {x: number, y: number}>} */
  const down = new Map();
  let travelled = 0;

  /** @param {MouseEvent} event @returns {{x: number, y: number}} */
  function place(event) {
    const box = canvas.getBoundingClientRect();
    return { x: event.clientX - box.left, y: event.clientY - box.top };
  }

  /** @param {PointerEvent} event */
  function drag(event) {
    const before = /** @type {{x: number, y: number}} */ (down.get(event.pointerId));
    const now = place(event);
    travelled += Math.hypot(now.x - before.x, now.y - before.y);
    const other = [...down].find(([id]) => id !== event.pointerId)?.[1];
    if (other) {
      const was = Math.hypot(before.x - other.x, before.y - other.y);
      const is = Math.hypot(now.x - other.x, now.y - other.y);
      camera.zoom(is / Math.max(was, 1), (now.x + other.x) / 2, (now.y + other.y) / 2);
      camera.pan((now.x - before.x) / 2, (now.y - before.y) / 2);
    } else if (travelled > TAP_PIXELS) {
      canvas.classList.add("dragging");
      camera.pan(now.x - before.x, now.y - before.y);
    }
    down.set(event.pointerId, now);
    if (other || travelled > TAP_PIXELS) hands.moved();
  }

  canvas.addEventListener("pointerdown", (event) => {
    if (event.button !== 0) return;
    canvas.setPointerCapture(event.pointerId);
    if (down.size === 0) travelled = 0;
    down.set(event.pointerId, place(event));
  });
  canvas.addEventListener("pointermove", (event) => {
    if (down.has(event.pointerId)) drag(event);
    else if (event.pointerType !== "touch") hands.hovered([place(event).x, place(event).y]);
  });
  for (const name of /** @type {const} */ (["pointerup", "pointercancel"])) {
    canvas.addEventListener(name, (event) => {
      const at = down.get(event.pointerId);
      down.delete(event.pointerId);
      canvas.classList.remove("dragging");
      if (at && name === "pointerup" && travelled <= TAP_PIXELS && down.size === 0) hands.tapped(at.x, at.y);
    });
  }
  canvas.addEventListener("pointerleave", () => hands.hovered(null));
  canvas.addEventListener("wheel", (event) => {
    event.preventDefault();
    const lines = event.deltaMode === 1 ? 30 : 1;
    const { x, y } = place(event);
    camera.zoom(Math.exp(-Math.max(-200, Math.min(200, event.deltaY * lines)) / 400), x, y);
    hands.moved();
  }, { passive: false });
  canvas.addEventListener("dblclick", (event) => {
    const { x, y } = place(event);
    camera.zoom(2, x, y);
    hands.moved();
  });
  canvas.addEventListener("keydown", (event) => {
    if (event.ctrlKey || event.metaKey || event.altKey) return;
    if (hands.key(event) || keyed(event, camera, hands)) event.preventDefault();
  });
}

const STEP = 60; // pixels
/** @type {Record<string, [number, number]>} */
const ARROWS = { ArrowLeft: [STEP, 0], ArrowRight: [-STEP, 0], ArrowUp: [0, STEP], ArrowDown: [0, -STEP] };

/** @param {KeyboardEvent} event @param {import("./camera.js").Camera} camera @param {Hands} hands */
function keyed(event, camera, hands) {
  if (event.key in ARROWS) camera.pan(...ARROWS[event.key]);
  else if (event.key === "+" || event.key === "=") camera.zoom(1.25);
  else if (event.key === "-") camera.zoom(0.8);
  else if (event.key === "0") return hands.fit(), true;
  else return false;
  hands.moved();
  return true;
}
