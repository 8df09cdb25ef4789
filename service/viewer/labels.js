/** Write names where they fit: in their zone, off each other, the larger zones first. */

import { meet } from "./geometry.js";
import { colour, shade } from "./palette.js";

const SIZES = [16, 14, 12, 11];
const LENGTH_MAX = 28;

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
 * @param {Set<string>} wanted zones that are named wherever they are
 */
export function drawLabels(context, camera, zones, wanted) {
  const { window, scale } = camera;
  const sizes = SIZES.map((size) => size * camera.size);
  const seen = zones.filter((zone) => meet(zone.box, window) && (wanted.has(zone.id) ||
    (Math.max(zone.box[2] - zone.box[0], zone.box[3] - zone.box[1]) * scale > 14)));
  seen.sort((one, other) => Number(wanted.has(other.id)) - Number(wanted.has(one.id)) || other.area - one.area);
  /** @type {import("./geometry.js").Box[]} */
  const taken = [];
  context.textAlign = "center";
  context.textBaseline = "middle";
  context.lineJoin = "round";
  context.lineWidth = 3.5;
  context.strokeStyle = colour("halo");
  for (const zone of seen.slice(0, 400)) {
    const words = shortened(zone.label);
    const width = widthOf(context, words);
    const must = wanted.has(zone.id);
    if (!must && width * sizes[sizes.length - 1] > (zone.box[2] - zone.box[0]) * scale) continue;
    const { x, y, r } = zone.pole;
    const [px, py] = camera.toScreen(x, y);
    const across = Math.max(2 * r, 0.9 * (zone.box[2] - zone.box[0]) * (r > 0 ? 1 : 0)) * scale;
    const size = sizes.find((one) => one * width <= across && one <= 2.2 * r * scale) ?? (must ? 12 * camera.size : 0);
    if (size === 0) continue;
    const half = (size * width) / 2 + 2;
    /** @type {import("./geometry.js").Box} */
    const box = [px - half, py - size * 0.6, px + half, py + size * 0.6];
    if (!must && taken.some((other) => meet(other, box))) continue;
    taken.push(box);
    context.font = font(size);
    context.globalAlpha = 0.75;
    context.strokeText(words, px, py);
    context.globalAlpha = 1;
    context.fillStyle = shade(zone.number).text;
    context.fillText(words, px, py);
  }
}
