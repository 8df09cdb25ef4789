/** Arrows of the graph: they bend so as to pass by the nodes between their ends, and end at pills. */

import { HALF_HEIGHT } from "./graphlayout.js";

const ARROW = 9; // pixels
const BEND = 16; // pixels; the two directions of a pair bend to opposite sides
const TRIED = [1, 2.2, 3.6]; // times that, the least first
const CELL = 120; // pixels
const CLEAR = 3; // pixels between an arrow and a node
const SAMPLES = 14;

/** @typedef {import("./graphlayout.js").Placed} Placed */
/** @typedef {[number, number]} Point */

export class Bends {
  /** @param {Map<string, Placed>} placed */
  constructor(placed) {
    this.placed = placed;
    /** @type {Map<string, Placed[]>} nodes by the cells that they are in */
    this.cells = new Map();
    /** @type {Map<string, Point | null>} */
    this.known = new Map();
    for (const one of placed.values()) {
      for (let c = Math.floor((one.x - one.half) / CELL); c <= Math.floor((one.x + one.half) / CELL); c += 1) {
        for (let r = Math.floor((one.y - HALF_HEIGHT) / CELL); r <= Math.floor((one.y + HALF_HEIGHT) / CELL); r += 1) {
          const key = `${c} ${r}`;
          this.cells.set(key, [...(this.cells.get(key) ?? []), one]);
        }
      }
    }
  }

  /** @param {import("./model.js").Edge} edge @returns {Point | null} what its arrow bends towards */
  of(edge) {
    const known = this.known.get(edge.key);
    if (known !== undefined) return known;
    const a = this.placed.get(edge.source);
    const b = this.placed.get(edge.target);
    const found = a && b ? this.find(a, b, 1 + edge.n) : null;
    if (edge.key) this.known.set(edge.key, found);
    return found;
  }

  /** @param {Placed} a @param {Placed} b @param {number} least times the bend @returns {Point} */
  find(a, b, least) {
    const length = Math.max(Math.hypot(b.x - a.x, b.y - a.y), 1e-9);
    let best = Infinity;
    /** @type {Point} */
    let found = [0, 0];
    for (const times of TRIED) {
      const bend = (1.4 * BEND * times * least) / length;
      if (times > 1 && BEND * times > length / 2) break; // rather through a node than all around
      /** @type {Point} */
      const middle = [(a.x + b.x) / 2 + (b.y - a.y) * bend, (a.y + b.y) / 2 - (b.x - a.x) * bend];
      const hit = this.hits(a, middle, b);
      if (hit < best) [best, found] = [hit, middle];
      if (best === 0) break;
    }
    return found;
  }

  /** @param {Placed} a @param {Point} middle @param {Placed} b @returns {number} of nodes on the way */
  hits(a, middle, b) {
    const hit = new Set();
    for (let n = 1; n < SAMPLES; n += 1) {
      const t = n / SAMPLES;
      const [x, y] = along([[a.x, a.y], middle, [b.x, b.y]], t);
      for (const one of this.cells.get(`${Math.floor(x / CELL)} ${Math.floor(y / CELL)}`) ?? []) {
        const inside = Math.abs(x - one.x) < one.half + CLEAR && Math.abs(y - one.y) < HALF_HEIGHT + CLEAR;
        if (inside && one !== a && one !== b) hit.add(one);
      }
    }
    return hit.size;
  }
}

/** @param {Point[]} curve @param {number} t @returns {Point} */
export function along([a, m, b], t) {
  const u = 1 - t;
  return [u * u * a[0] + 2 * u * t * m[0] + t * t * b[0], u * u * a[1] + 2 * u * t * m[1] + t * t * b[1]];
}

/** Where a line from the middle of a node to a place leaves its pill. @param {Placed} node @param {[number, number]} to @param {number} gap @returns {[number, number]} */
export function edgeOf(node, to, gap) {
  const dx = to[0] - node.x;
  const dy = to[1] - node.y;
  const core = node.half - HALF_HEIGHT;
  const radius = HALF_HEIGHT + gap;
  let far = 1;
  let near = 0;
  for (let round = 0; round < 14; round += 1) {
    const t = (near + far) / 2;
    const outside = Math.hypot(Math.max(Math.abs(dx * t) - core, 0), dy * t) > radius;
    if (outside) far = t;
    else near = t;
  }
  return [node.x + dx * far, node.y + dy * far];
}

/** @param {CanvasRenderingContext2D} context y points down here @param {[number, number][]} curve */
export function arrow(context, [start, middle, end]) {
  const length = Math.max(Math.hypot(end[0] - middle[0], end[1] - middle[1]), 1e-9);
  const ux = (end[0] - middle[0]) / length;
  const uy = (end[1] - middle[1]) / length;
  const base = [end[0] - ARROW * ux, end[1] - ARROW * uy];
  context.beginPath();
  context.moveTo(start[0], -start[1]);
  context.quadraticCurveTo(middle[0], -middle[1], base[0], -base[1]);
  context.stroke();
  context.setLineDash([]);
  context.beginPath();
  context.moveTo(end[0], -end[1]);
  context.lineTo(base[0] - uy * ARROW * 0.45, -(base[1] + ux * ARROW * 0.45));
  context.lineTo(base[0] + uy * ARROW * 0.45, -(base[1] - ux * ARROW * 0.45));
  context.closePath();
  context.fill();
}
