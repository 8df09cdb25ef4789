/** Write names where they fit: in their zone, off each other, the larger zones first. */

import { meet } from "./geometry.js";
import { colour, shade } from "./palette.js";
import { slotsFor } from "./slots.js";

const SIZES = [16, 14, 12, 11];
const ROOM = 1.1; // times its own that a name needs
const ROOM_LEAST = 0.94; // the same for the smallest: its ends may touch the border
const LENGTH_MAX = 28;
const MOST = 400; // names in sight
const MARK = 13; // pixels around the middle of the robot, or of another mark
const BEAMS = 0.5; // of a zone: a name goes so far to be out of the beams

/** @typedef {import("./geometry.js").Box} Box */
/** @typedef {{at: [number, number], angle: number, size: number, box: Box}} Place in CSS pixels */
/**
 * @typedef {object} Beside
 * @property {Set<string>} [wanted] zones that are named wherever they are
 * @property {import("./geometry.js").Point[]} [marks] in m; no name is beneath one, if there is room elsewhere
 * @property {Box | null} [sight] what its beams reach, in m
 */

/** @type {Map<string, number>} widths of names at a size of 1 px */
const widths = new Map();

/** @param {CanvasRenderingContext2D} context @param {string} words */
function widthOf(context, words) {
  let width = widths.get(words);
  if (width === undefined) {
    context.font = font(100);
    width = context.measureText(words).width / 100;
    if (widths.size > 5_000) widths.clear();
    widths.set(words, width);
  }
  return width;
}

/** @param {number} size */
export function font(size) {
  return `600 ${size}px system-ui, -apple-system, "Segoe UI", Roboto, "Noto Sans", "DejaVu Sans", sans-serif`;
}

/** @param {string} label */
export function shortened(label, most = LENGTH_MAX) {
  const signs = Array.from(label);
  return signs.length <= most ? label : `${signs.slice(0, most - 1).join("")}\u2026`;
}

/**
 * @param {CanvasRenderingContext2D} context in CSS pixels
 * @param {import("./camera.js").Camera} camera
 * @param {import("./model.js").Zone[]} zones
 * @param {Beside} beside
 */
export function drawLabels(context, camera, zones, { wanted = new Set(), marks = [], sight = null }) {
  const { window, scale } = camera;
  const seen = zones.filter((zone) => meet(zone.box, window) && (wanted.has(zone.id) ||
    (Math.max(zone.box[2] - zone.box[0], zone.box[3] - zone.box[1]) * scale > 14)));
  seen.sort((one, other) => Number(wanted.has(other.id)) - Number(wanted.has(one.id)) || other.area - one.area);
  /** @type {Box[]} */
  const taken = [];
  const avoid = { marks: marks.map((at) => around(camera, at)), sight: sight && boxOnScreen(camera, sight) };
  context.textAlign = "center";
  context.textBaseline = "middle";
  context.lineJoin = "round";
  context.lineWidth = 3.5;
  context.strokeStyle = colour("halo");
  for (const zone of seen.slice(0, MOST)) {
    const words = shortened(zone.label);
    const must = wanted.has(zone.id);
    const found = placeOf(zone, widthOf(context, words), camera, avoid) ?? (must ? atPole(zone, camera) : null);
    if (!found || (!must && taken.some((other) => meet(other, found.box)))) continue;
    taken.push(found.box);
    write(context, words, found, shade(zone.number).text);
  }
}

/** @param {CanvasRenderingContext2D} context @param {string} words @param {Place} place @param {string} fill */
function write(context, words, { at: [x, y], angle, size }, fill) {
  context.save();
  context.translate(x, y);
  context.rotate(-angle);
  context.font = font(size);
  context.globalAlpha = 0.75;
  context.strokeText(words, 0, 0);
  context.globalAlpha = 1;
  context.fillStyle = fill;
  context.fillText(words, 0, 0);
  context.restore();
}

/**
 * The largest name that fits, off all marks; near the middle of the zone, and rather not among the beams.
 * @param {import("./model.js").Zone} zone @param {number} width at a size of 1 px
 * @param {import("./camera.js").Camera} camera @param {{marks: Box[], sight: Box | null}} avoid
 * @returns {Place | null}
 */
function placeOf(zone, width, camera, { marks, sight }) {
  /** @type {Place | null} */
  let covered = null;
  const seen = boxOnScreen(camera, zone.box);
  const isCrowded = [...marks, ...(sight ? [sight] : [])].some((one) => meet(one, seen));
  const far = sight ? BEAMS * Math.hypot(zone.box[2] - zone.box[0], zone.box[3] - zone.box[1]) : 0;
  for (const one of SIZES) {
    const size = one * camera.size;
    const room = one === SIZES[SIZES.length - 1] ? ROOM_LEAST : ROOM;
    /** @type {Place | null} */
    let best = null;
    let least = Infinity;
    for (const slot of slots(zone, width, size, camera.scale, room, isCrowded)) {
      if (slot.off >= least) break; // they are in that order
      const place = placed(slot, size, width, camera);
      covered ??= place;
      if (marks.some((mark) => meet(mark, place.box))) continue;
      const off = slot.off + (sight && meet(sight, place.box) ? far : 0);
      if (off < least) [best, least] = [place, off];
    }
    if (best) return best;
  }
  return covered;
}

/** @type {WeakMap<import("./model.js").Zone, Map<string, import("./slots.js").Slot[]>>} */
const fitting = new WeakMap();

/** @param {import("./model.js").Zone} zone @param {number} width @param {number} size @param {number} scale @param {number} room @param {boolean} all */
function slots(zone, width, size, scale, room, all) {
  let known = fitting.get(zone);
  if (!known || known.size > 40) fitting.set(zone, (known = new Map()));
  const key = `${scale} ${size} ${width} ${all}`;
  let found = known.get(key);
  if (!found) known.set(key, (found = slotsFor(zone, (room * width * size) / scale, (room * size) / scale, all)));
  return found;
}

/** @param {{x: number, y: number, angle: number}} slot @param {number} size @param {number} width @param {import("./camera.js").Camera} camera @returns {Place} */
function placed({ x, y, angle }, size, width, camera) {
  const [px, py] = camera.toScreen(x, y);
  const [c, s] = [Math.abs(Math.cos(angle)), Math.abs(Math.sin(angle))];
  const [along, up] = [(size * width) / 2, size * 0.6];
  const [h, v] = [along * c + up * s, along * s + up * c];
  return { at: [px, py], angle, size, box: [px - h, py - v, px + h, py + v] };
}

/** @param {import("./model.js").Zone} zone @param {import("./camera.js").Camera} camera @returns {Place} */
function atPole(zone, camera) {
  return placed({ ...zone.pole, angle: 0 }, 12 * camera.size, 0, camera);
}

/** @param {import("./camera.js").Camera} camera @param {import("./geometry.js").Point} at @returns {Box} */
function around(camera, at) {
  const [x, y] = camera.toScreen(...at);
  const r = MARK * camera.size;
  return [x - r, y - r, x + r, y + r];
}

/** @param {import("./camera.js").Camera} camera @param {Box} box in m @returns {Box} */
function boxOnScreen(camera, box) {
  const [x0, y1] = camera.toScreen(box[0], box[1]);
  const [x1, y0] = camera.toScreen(box[2], box[3]);
  return [x0, y0, x1, y1];
}
