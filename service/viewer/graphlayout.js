/** Lay the graph out as the zones lie on the map, moved apart until no two nodes cover each other. */

import { shortened } from "./labels.js";

const SPACE = 26; // pixels between nodes
const STRETCH_MAX = 3; // of one axis against the other, so that the panel is filled
const ROUNDS = 80;

/**
 * @typedef {object} Placed
 * @property {string} id
 * @property {string} words
 * @property {number} x in pixels, y points up
 * @property {number} y
 * @property {number} half of its width
 * @property {number} number of its zone
 */

export const HALF_HEIGHT = 15;

/**
 * @param {{id: string, label: string}[]} nodes
 * @param {Map<string, import("./model.js").Zone>} zones
 * @param {(words: string) => number} measure width in pixels
 * @param {number} aspect width of the panel over its height
 * @returns {Map<string, Placed>}
 */
export function layOut(nodes, zones, measure, aspect) {
  /** @type {Placed[]} */
  const placed = nodes.map((node, number) => {
    const zone = zones.get(node.id);
    const words = shortened(node.label, 18);
    const [x, y] = zone ? [(zone.box[0] + zone.box[2]) / 2, (zone.box[1] + zone.box[3]) / 2] : [0, 0];
    return { id: node.id, words, x, y, half: measure(words) / 2 + 14, number: zone?.number ?? number };
  });
  spread(placed, aspect);
  const homes = placed.map(({ x, y }) => [x, y]);
  for (let round = 0; round < ROUNDS; round += 1) {
    const moved = separate(placed);
    placed.forEach((one, n) => {
      one.x += (homes[n][0] - one.x) * 0.02;
      one.y += (homes[n][1] - one.y) * 0.02;
    });
    if (!moved) break;
  }
  separate(placed);
  return new Map(placed.map((one) => [one.id, one]));
}

/** Scale the places so that the nodes have room and fill the panel. @param {Placed[]} placed @param {number} aspect */
function spread(placed, aspect) {
  const xs = placed.map((one) => one.x);
  const ys = placed.map((one) => one.y);
  const [left, low] = [least(xs), least(ys)];
  const width = Math.max(-least(xs.map((x) => -x)) - left, 1e-9);
  const height = Math.max(-least(ys.map((y) => -y)) - low, 1e-9);
  const room = placed.reduce((sum, one) => sum + 2 * (one.half + SPACE) * 2 * (HALF_HEIGHT + SPACE), 0);
  const stretch = Math.min(Math.max((aspect * height) / width, 1 / STRETCH_MAX), STRETCH_MAX);
  const scale = Math.sqrt(room / Math.max(width * stretch * height, Math.max(width * stretch, height) ** 2 / 8));
  for (const one of placed) {
    // a golden spiral keeps nodes of one place apart, always in the same way
    one.x = (one.x - left) * scale * stretch + Math.cos(one.number * 2.4) * 3;
    one.y = (one.y - low) * scale + Math.sin(one.number * 2.4) * 3;
  }
}

/** @param {number[]} values */
function least(values) {
  return values.reduce((a, b) => Math.min(a, b), Infinity);
}

/** Push apart nodes that are too near, by a grid of cells. @param {Placed[]} placed @returns {boolean} whether any was */
function separate(placed) {
  const widest = placed.reduce((most, one) => Math.max(most, one.half), 0);
  const across = 2 * widest + SPACE;
  const down = 2 * HALF_HEIGHT + SPACE;
  /** @type {Map<string, Placed[]>} */
  const cells = new Map();
  let moved = false;
  for (const one of placed) {
    const column = Math.floor(one.x / across);
    const row = Math.floor(one.y / down);
    for (let c = column - 1; c <= column + 1; c += 1) {
      for (let r = row - 1; r <= row + 1; r += 1) {
        for (const other of cells.get(`${c} ${r}`) ?? []) moved = push(one, other) || moved;
      }
    }
    const key = `${column} ${row}`;
    if (cells.has(key)) cells.get(key)?.push(one);
    else cells.set(key, [one]);
  }
  return moved;
}

/** @param {Placed} one @param {Placed} other */
function push(one, other) {
  const dx = one.x - other.x;
  const dy = one.y - other.y;
  const across = one.half + other.half + SPACE - Math.abs(dx);
  const down = 2 * HALF_HEIGHT + SPACE - Math.abs(dy);
  if (across <= 0 || down <= 0) return false;
  if (across < down) {
    const by = (across / 2) * (dx < 0 ? -1 : 1);
    one.x += by;
    other.x -= by;
  } else {
    const by = (down / 2) * (dy < 0 ? -1 : 1);
    one.y += by;
    other.y -= by;
  }
  return true;
}
