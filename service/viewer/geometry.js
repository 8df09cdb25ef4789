/** A few facts about boxes, rings and polygons. Everything is in m, map frame. */

/** @typedef {[number, number]} Point */
/** @typedef {Point[]} Ring */
/** @typedef {[number, number, number, number]} Box least x, y, greatest x, y */

/** @returns {Box} a box that holds nothing */
export function noBox() {
  return [Infinity, Infinity, -Infinity, -Infinity];
}

/** @param {Box} box @param {Iterable<Point>} points @returns {Box} the same box, grown */
export function growBox(box, points) {
  for (const [x, y] of points) {
    if (x < box[0]) box[0] = x;
    if (y < box[1]) box[1] = y;
    if (x > box[2]) box[2] = x;
    if (y > box[3]) box[3] = y;
  }
  return box;
}

/** @param {Box} one @param {Box} other */
export function meet(one, other) {
  return one[0] <= other[2] && other[0] <= one[2] && one[1] <= other[3] && other[1] <= one[3];
}

/** @param {Box} box */
export function isEmpty(box) {
  return !(box[0] <= box[2]);
}

/**
 * Say whether a point lies in polygons of rings, holes left out (even-odd rule).
 * @param {number} x @param {number} y @param {Ring[]} rings
 */
export function inside(x, y, rings) {
  let odd = false;
  for (const ring of rings) {
    for (let i = 0, j = ring.length - 1; i < ring.length; j = i, i += 1) {
      const [xi, yi] = ring[i];
      const [xj, yj] = ring[j];
      if (yi > y !== yj > y && x < ((xj - xi) * (y - yi)) / (yj - yi) + xi) odd = !odd;
    }
  }
  return odd;
}

/** @param {Ring[]} rings closed @param {number} least distance from point to point, in m @returns {Ring[]} the same, closed, with fewer points */
export function thinned(rings, least) {
  return rings.map((ring) => {
    let [lx, ly] = ring[0];
    const kept = ring.filter(([x, y], n) => {
      const isFar = n === 0 || Math.abs(x - lx) + Math.abs(y - ly) >= least;
      if (isFar) [lx, ly] = [x, y];
      return isFar;
    });
    return [...kept, ring[0]];
  });
}

/** @param {number} x @param {number} y @param {Ring[]} rings @returns {number} distance, negative outside */
function depth(x, y, rings) {
  let least = Infinity;
  for (const ring of rings) {
    for (let i = 1; i < ring.length; i += 1) {
      const [ax, ay] = ring[i - 1];
      const dx = ring[i][0] - ax;
      const dy = ring[i][1] - ay;
      const square = dx * dx + dy * dy;
      const t = square > 0 ? Math.max(0, Math.min(1, ((x - ax) * dx + (y - ay) * dy) / square)) : 0;
      const ex = x - ax - t * dx;
      const ey = y - ay - t * dy;
      least = Math.min(least, ex * ex + ey * ey);
    }
  }
  return Math.sqrt(least) * (inside(x, y, rings) ? 1 : -1);
}

/**
 * Find about the middle of the largest circle in polygons: quadtree search, nearer than a
 * fortieth of their size (as the well-known `polylabel` does).
 * @param {Ring[]} rings @param {Box} box
 * @returns {{x: number, y: number, r: number}}
 */
export function pole(rings, box) {
  const width = box[2] - box[0];
  const height = box[3] - box[1];
  const size = Math.min(width, height);
  if (!(size > 0)) return { x: box[0], y: box[1], r: 0 };
  const precision = Math.max(width, height) / 40;
  let best = { x: box[0] + width / 2, y: box[1] + height / 2, r: -Infinity };
  /** @param {number} x @param {number} y @param {number} half */
  function cell(x, y, half) {
    const r = depth(x, y, rings);
    if (r > best.r) best = { x, y, r };
    return { x, y, half, most: r + half * Math.SQRT2 };
  }
  let cells = [];
  for (let x = box[0]; x < box[2]; x += size) {
    for (let y = box[1]; y < box[3]; y += size) cells.push(cell(x + size / 2, y + size / 2, size / 2));
  }
  for (let looked = 0; cells.length > 0 && looked < 120; looked += 1) {
    const at = cells.reduce((most, one, n) => (one.most > cells[most].most ? n : most), 0);
    const [one] = cells.splice(at, 1);
    if (one.most - best.r <= precision) break;
    const h = one.half / 2;
    cells.push(cell(one.x - h, one.y - h, h), cell(one.x + h, one.y - h, h),
      cell(one.x - h, one.y + h, h), cell(one.x + h, one.y + h, h));
  }
  return best;
}

/** @param {Point[]} line @param {number} step in m @param {number} most @returns {Point[]} points on it, so far apart or further */
export function pointsAlong(line, step, most) {
  const length = line.reduce((sum, [x, y], n) => sum + (n > 0 ? Math.hypot(x - line[n - 1][0], y - line[n - 1][1]) : 0), 0);
  const apart = Math.max(step, length / most);
  /** @type {Point[]} */
  const found = [];
  let left = 0; // to go to the next point
  for (let n = 1; n < line.length; n += 1) {
    const [[ax, ay], [bx, by]] = [line[n - 1], line[n]];
    const side = Math.hypot(bx - ax, by - ay);
    for (; left < side; left += apart) found.push([ax + ((bx - ax) * left) / side, ay + ((by - ay) * left) / side]);
    left -= side;
  }
  return found;
}
