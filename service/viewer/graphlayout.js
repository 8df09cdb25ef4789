/** Lay the graph out as the zones lie on the map, moved apart until no two nodes cover each other. */

import { shortened } from "./labels.js";

const BESIDE = 12; // pixels between nodes side by side
const BELOW = 24; // pixels between nodes one below the other
const MARGIN = 24; // pixels around all of them
const ROOMY = 4; // times the room that nodes need, above which they are drawn larger
const LARGER_MAX = 2;
const GROWTH = 1.1;
const CROWDED = 0.15; // of the nodes may be too near to others before they are moved apart
const CROWDED_FEW = 0.6; // the same of so few that it leaves no disorder
const FEW = 40;
const ENOUGH = 2; // times the panel that would be just filled: rows and columns stay in order
const ENOUGH_FEW = 1.3;
const STRETCH_MAX = 3; // of one axis against the other, so that the panel is filled
const ROUNDS = 80;
const MOVES_MAX = 20_000; // of nodes, so that many are laid out quickly, too

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
 * @param {number} width of the panel in pixels @param {number} height
 * @returns {Map<string, Placed>}
 */
export function layOut(nodes, zones, measure, width, height) {
  /** @type {Placed[]} */
  const placed = nodes.map((node, number) => {
    const zone = zones.get(node.id);
    const words = shortened(node.label, 18);
    const [x, y] = zone ? [(zone.box[0] + zone.box[2]) / 2, (zone.box[1] + zone.box[3]) / 2] : [0, 0];
    return { id: node.id, words, x, y, half: measure(words) / 2 + 10, number: zone?.number ?? number };
  });
  spread(placed, Math.max(width - 2 * MARGIN, 100), Math.max(height - 2 * MARGIN, 100));
  const homes = placed.map(({ x, y }) => [x, y]);
  for (let round = 0; round < Math.min(ROUNDS, MOVES_MAX / placed.length); round += 1) {
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

/**
 * Scale the places so that they fill the panel, and more where the nodes need more; the map is stretched for it.
 * @param {Placed[]} placed @param {number} across the panel @param {number} up
 */
function spread(placed, across, up) {
  const homes = placed.map(({ x, y }) => [x, y]);
  const [left, low] = [least(homes.map(([x]) => x)), least(homes.map(([, y]) => y))];
  const width = Math.max(-least(homes.map(([x]) => -x)) - left, 1e-9);
  const height = Math.max(-least(homes.map(([, y]) => -y)) - low, 1e-9);
  const room = placed.reduce((sum, one) => sum + (2 * one.half + BESIDE) * (2 * HALF_HEIGHT + BELOW), 0);
  const most = placed.reduce((widest, one) => Math.max(widest, one.half), 0);
  const full = Math.sqrt(room / (across * up)); // times the panel that would be just filled
  const isFew = placed.length <= FEW;
  const enough = Math.max(1, (isFew ? ENOUGH_FEW : ENOUGH) * full);
  const crowded = (isFew ? CROWDED_FEW : CROWDED) * placed.length;
  const first = Math.min(Math.max(Math.sqrt(ROOMY) * full, 1 / LARGER_MAX), 1);
  for (let times = Math.max(first, 0.8 * full); ; times *= GROWTH) {
    const [sx, sy] = [Math.max(times * across - 2 * most, 1) / width, Math.max(times * up - 2 * HALF_HEIGHT, 1) / height];
    const [tx, ty] = [Math.min(sx, STRETCH_MAX * sy), Math.min(sy, STRETCH_MAX * sx)];
    placed.forEach((one, n) => {
      // a golden spiral keeps nodes of one place apart, always in the same way
      one.x = (homes[n][0] - left) * tx + Math.cos(one.number * 2.4) * 3;
      one.y = (homes[n][1] - low) * ty + Math.sin(one.number * 2.4) * 3;
    });
    if (times >= enough || neighbours(placed).length <= crowded) break;
  }
}

/** @param {number[]} values */
function least(values) {
  return values.reduce((a, b) => Math.min(a, b), Infinity);
}

/** Push apart nodes that are too near. @param {Placed[]} placed @returns {boolean} whether any was */
function separate(placed) {
  const near = neighbours(placed);
  for (const [one, other] of near) push(one, other);
  return near.length > 0;
}

/** Find nodes that are too near each other, by a grid of cells. @param {Placed[]} placed @returns {[Placed, Placed][]} */
function neighbours(placed) {
  const widest = placed.reduce((most, one) => Math.max(most, one.half), 0);
  const across = 2 * widest + BESIDE;
  const down = 2 * HALF_HEIGHT + BELOW;
  /** @type {Map<string, Placed[]>} */
  const cells = new Map();
  /** @type {[Placed, Placed][]} */
  const found = [];
  for (const one of placed) {
    const column = Math.floor(one.x / across);
    const row = Math.floor(one.y / down);
    for (let c = column - 1; c <= column + 1; c += 1) {
      for (let r = row - 1; r <= row + 1; r += 1) {
        for (const other of cells.get(`${c} ${r}`) ?? []) if (overlap(one, other).every((by) => by > 0)) found.push([one, other]);
      }
    }
    const key = `${column} ${row}`;
    if (cells.has(key)) cells.get(key)?.push(one);
    else cells.set(key, [one]);
  }
  return found;
}

/** @param {Placed} one @param {Placed} other @returns {[number, number]} in pixels across and up; both above 0 is too near */
function overlap(one, other) {
  return [one.half + other.half + BESIDE - Math.abs(one.x - other.x), 2 * HALF_HEIGHT + BELOW - Math.abs(one.y - other.y)];
}

/** @param {Placed} one @param {Placed} other */
function push(one, other) {
  const [across, down] = overlap(one, other);
  if (across <= 0 || down <= 0) return; // it was moved already
  if (across < down) {
    const by = (across / 2) * (one.x < other.x ? -1 : 1);
    one.x += by;
    other.x -= by;
  } else {
    const by = (down / 2) * (one.y < other.y ? -1 : 1);
    one.y += by;
    other.y -= by;
  }
}
