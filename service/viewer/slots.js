/**
 * Where a name fits in a zone: level, or along the zone where it is too narrow for that.
 *
 * A zone is cut into rows, in a frame that is turned by the angle of the name. A name fits where
 * enough rows, one beside the other, all have room for its width.
 */

const ROWS = 32;
const SPECK = 1 / 8; // of a zone; a smaller hole is written over
const LONG = 1.25; // times as long as wide; any less has no direction
const LEVEL = Math.PI / 18; // nearer to it is level
const ASIDE = [0, -0.5, 0.5, -1, 1, -1.5, 1.5, -2.5, 2.5, -4, 4, -8, 8]; // widths of the name from the middle
const KEPT_MAX = 120; // places for one name

/** @typedef {import("./geometry.js").Point} Point */
/** @typedef {import("./geometry.js").Ring} Ring */
/** @typedef {[number, number][]} Spans from and to, in m along a row, in order */
/** @typedef {{angle: number, low: number, step: number, rows: Spans[]}} Grain */
/** @typedef {{x: number, y: number, angle: number, off: number}} Slot the middle of a name, in m, and how far it is off that of the zone */

/** @type {WeakMap<import("./model.js").Zone, {angles: number[], grains: Map<number, Grain>}>} */
const known = new WeakMap();

/**
 * @param {import("./model.js").Zone} zone @param {number} width of the name in m @param {number} height
 * @param {boolean} all that there are, for where something may be in the way of the best
 * @returns {Slot[]} the best first; all are level, or all are turned
 */
export function slotsFor(zone, width, height, all) {
  const { box } = zone;
  if (Math.hypot(box[2] - box[0], box[3] - box[1]) < width) return [];
  let about = known.get(zone);
  if (!about) known.set(zone, (about = { angles: anglesOf(zone.rings), grains: new Map() }));
  for (const angle of about.angles) {
    let grain = about.grains.get(angle);
    if (!grain) about.grains.set(angle, (grain = grainOf(zone, angle)));
    const found = fit(grain, width, height, zone.pole, all);
    if (found.length > 0) return found;
  }
  return [];
}

/** @param {Ring[]} rings @returns {number[]} level, along the zone if it is long, and upright */
function anglesOf(rings) {
  const [xx, xy, yy] = spreadOf(rings);
  const half = (xx + yy) / 2;
  const apart = Math.hypot((xx - yy) / 2, xy);
  let angle = Math.atan2(2 * xy, xx - yy) / 2;
  if (angle < -Math.PI / 2 + LEVEL) angle += Math.PI; // nearly upright names read upwards
  const isLong = half + apart > LONG ** 2 * (half - apart);
  const isLevel = Math.abs(angle) < LEVEL;
  const isUpright = Math.abs(angle - Math.PI / 2) < LEVEL;
  return [0, ...(isLong && !isLevel && !isUpright ? [angle] : []), Math.PI / 2];
}

/** @param {Ring[]} rings holes turn the other way @returns {[number, number, number]} second moments about the centroid */
function spreadOf(rings) {
  const [ox, oy] = rings[0][0];
  let [area, x, y, xx, xy, yy] = [0, 0, 0, 0, 0, 0];
  for (const ring of rings) {
    for (let n = 1; n < ring.length; n += 1) {
      const [ax, ay, bx, by] = [ring[n - 1][0] - ox, ring[n - 1][1] - oy, ring[n][0] - ox, ring[n][1] - oy];
      const cross = ax * by - bx * ay;
      area += cross / 2;
      x += ((ax + bx) * cross) / 6;
      y += ((ay + by) * cross) / 6;
      xx += ((ax * ax + ax * bx + bx * bx) * cross) / 12;
      yy += ((ay * ay + ay * by + by * by) * cross) / 12;
      xy += ((2 * ax * ay + ax * by + bx * ay + 2 * bx * by) * cross) / 24;
    }
  }
  if (!(Math.abs(area) > 0)) return [0, 0, 0];
  return [xx / area - (x / area) ** 2, xy / area - (x * y) / area ** 2, yy / area - (y / area) ** 2];
}

/** @param {import("./model.js").Zone} zone @param {number} angle @returns {Grain} */
function grainOf(zone, angle) {
  const [c, s] = [Math.cos(angle), Math.sin(angle)];
  const { box } = zone;
  const least = SPECK * Math.max(box[2] - box[0], box[3] - box[1]);
  const turned = zone.rings.filter((ring) => isLarge(ring, least)).map((ring) => ring.map(([x, y]) => [x * c + y * s, y * c - x * s]));
  const heights = turned.flat().map(([, v]) => v);
  const low = heights.reduce((a, b) => Math.min(a, b), Infinity);
  const step = (heights.reduce((a, b) => Math.max(a, b), -Infinity) - low) / ROWS;
  /** @type {number[][]} */
  const crossings = Array.from({ length: ROWS }, () => []);
  for (const ring of turned) {
    for (let n = 1; n < ring.length; n += 1) {
      const [[au, av], [bu, bv]] = upwards(ring[n - 1], ring[n]);
      const last = Math.min(ROWS - 1, Math.ceil((bv - low) / step - 0.5) - 1);
      for (let row = Math.max(0, Math.ceil((av - low) / step - 0.5)); row <= last; row += 1) {
        crossings[row].push(au + ((low + (row + 0.5) * step - av) / (bv - av)) * (bu - au));
      }
    }
  }
  return { angle, low, step, rows: crossings.map(spansOf) };
}

/** @param {number[][]} ends of a side @returns {number[][]} the lower one first */
function upwards(...ends) {
  return ends[0][1] <= ends[1][1] ? ends : ends.reverse();
}

/** @param {Ring} ring @param {number} least */
function isLarge(ring, least) {
  const across = ring.map(([x]) => x);
  const up = ring.map(([, y]) => y);
  const size = (/** @type {number[]} */ all) => all.reduce((a, b) => Math.max(a, b)) - all.reduce((a, b) => Math.min(a, b));
  return Math.max(size(across), size(up)) >= least;
}

/** @param {number[]} crossings of a row with the border @returns {Spans} what is inside (even-odd rule) */
function spansOf(crossings) {
  crossings.sort((a, b) => a - b);
  /** @type {Spans} */
  const spans = [];
  for (let n = 1; n < crossings.length; n += 2) spans.push([crossings[n - 1], crossings[n]]);
  return spans;
}

/** @param {Grain} grain @param {number} width @param {number} height @param {{x: number, y: number}} pole @param {boolean} all @returns {Slot[]} */
function fit({ angle, low, step, rows }, width, height, pole, all) {
  const [c, s] = [Math.cos(angle), Math.sin(angle)];
  const [pu, pv] = [pole.x * c + pole.y * s, pole.y * c - pole.x * s];
  const many = Math.max(2, Math.ceil(height / step));
  const heights = Array.from({ length: Math.max(ROWS - many + 1, 0) }, (_, first) => ({ first, v: low + (first + many / 2) * step }));
  heights.sort((one, other) => Math.abs(one.v - pv) - Math.abs(other.v - pv));
  /** @type {Slot[]} */
  const slots = [];
  let least = Infinity;
  for (const { first, v } of heights) {
    if (!all && Math.abs(v - pv) >= least) break;
    let spans = rows[first];
    for (let row = first + 1; row < first + many && spans.length > 0; row += 1) spans = common(spans, rows[row], width);
    for (const [from, to] of spans) {
      const [left, right] = [from + width / 2, to - width / 2];
      if (left > right) continue;
      const aside = all ? ASIDE : [0];
      const places = right - left < width ? [(left + right) / 2] : aside.map((times) => Math.min(Math.max(pu + times * width, left), right));
      for (const u of new Set(places)) {
        const off = Math.hypot(u - pu, v - pv);
        least = Math.min(least, off);
        slots.push({ x: u * c - v * s, y: u * s + v * c, angle, off });
      }
    }
  }
  slots.sort((one, other) => one.off - other.off);
  return thinned(slots);
}

/** @param {Slot[]} slots @returns {Slot[]} so many that some are left however large the map is */
function thinned(slots) {
  const every = Math.ceil(slots.length / KEPT_MAX);
  return slots.filter((_, n) => n % every === 0);
}

/** @param {Spans} some @param {Spans} others @param {number} least @returns {Spans} what is in both, if it is so long */
function common(some, others, least) {
  /** @type {Spans} */
  const both = [];
  for (let i = 0, j = 0; i < some.length && j < others.length; ) {
    const from = Math.max(some[i][0], others[j][0]);
    const to = Math.min(some[i][1], others[j][1]);
    if (to - from >= least) both.push([from, to]);
    if (some[i][1] < others[j][1]) i += 1;
    else j += 1;
  }
  return both;
}
