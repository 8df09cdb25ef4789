/** Turn the bodies of the service into what views draw; what has not changed stays the same object. */

import { growBox, noBox, pole, thinned } from "./geometry.js";

/**
 * @typedef {object} Zone
 * @property {string} id
 * @property {string} label
 * @property {number} area in m^2
 * @property {number} since the step that found it
 * @property {number} seq the last step that changed it
 * @property {number} number that its colour goes by
 * @property {import("./geometry.js").Ring[]} rings of all its polygons
 * @property {Path2D} path
 * @property {Path2D} coarse the same with few points, for where it is small on the screen
 * @property {import("./geometry.js").Box} box
 * @property {{x: number, y: number, r: number}} pole
 */

/**
 * @typedef {object} Edge
 * @property {string} key
 * @property {string} source
 * @property {string} target
 * @property {number} n
 * @property {[number, number]} point
 * @property {number} seq
 */

/** @param {any} geometry @returns {import("./geometry.js").Ring[]} */
function ringsOf(geometry) {
  return geometry.type === "Polygon" ? geometry.coordinates : geometry.coordinates.flat();
}

/** @param {import("./geometry.js").Ring[]} rings */
function pathOf(rings) {
  const path = new Path2D();
  for (const ring of rings) {
    draw(path, ring);
    path.closePath();
  }
  return path;
}

/**
 * @param {any} body of /zones
 * @param {Map<string, Zone>} known zones of other moments, by id and seq; new ones are added
 * @param {Map<string, number>} numbers of all zones that were seen, in that order: a zone keeps its colour
 * @returns {Zone[]}
 */
export function zonesOf(body, known, numbers) {
  return body.features.map((/** @type {any} */ feature) => {
    const about = feature.properties;
    const key = `${about.seq} ${feature.id}`;
    const kept = known.get(key);
    if (kept) return kept;
    const number = numbers.get(feature.id) ?? numbers.size;
    numbers.set(feature.id, number);
    const rings = ringsOf(feature.geometry);
    const box = growBox(noBox(), rings.flat());
    /** @type {{x: number, y: number, r: number} | null} */
    let middle = null;
    /** @type {Path2D | null} */
    let path = null;
    /** @type {Path2D | null} */
    let coarse = null;
    const size = Math.max(box[2] - box[0], box[3] - box[1]);
    const zone = { // what is costly is made when it is first needed
      id: feature.id, label: about.label, area: about.area, since: about.since, seq: about.seq,
      number, rings, box,
      get path() { return (path ??= pathOf(rings)); },
      get coarse() { return (coarse ??= pathOf(thinned(rings, size / 30))); },
      get pole() { return (middle ??= pole(thinned(rings, size / 60), box)); },
    };
    known.set(key, zone);
    return zone;
  });
}

/** @param {any} edge @returns {string} */
export function edgeKey(edge) {
  return JSON.stringify([edge.source, edge.target, edge.n ?? 0]);
}

/**
 * @typedef {object} Graph
 * @property {number} seq
 * @property {{id: string, label: string, aliases?: string[], class?: string}[]} nodes
 * @property {Edge[]} edges
 * @property {Set<string>} closed ids of zones and keys of edges
 */

/** @param {any} body of /graph @returns {Graph} */
export function graphOf(body) {
  const edges = body.edges.map((/** @type {any} */ edge) => ({ ...edge, n: edge.n ?? 0, key: edgeKey(edge) }));
  const closed = new Set([
    ...body.nodes.filter((/** @type {any} */ one) => one.closed).map((/** @type {any} */ one) => one.id),
    ...edges.filter((/** @type {any} */ one) => one.closed).map((/** @type {any} */ one) => one.key),
  ]);
  return { seq: body.seq, nodes: body.nodes, edges, closed };
}

/**
 * @typedef {object} Borders of a zone
 * @property {Path2D} obstacle
 * @property {Path2D} passage
 * @property {Map<number, Path2D>} free by their length in m, up to a power of two
 */

/**
 * Gather the lines of each zone by what they are.
 * @param {any} body of /borders
 * @returns {Map<string, Borders>} by the id of the zone
 */
export function bordersOf(body) {
  /** @type {Map<string, Borders>} */
  const all = new Map();
  for (const { properties, geometry } of body.features) {
    const { zone_id: id, occupancy } = properties;
    const borders = all.get(id) ?? { obstacle: new Path2D(), passage: new Path2D(), free: new Map() };
    all.set(id, borders);
    draw(occupancy === "free" ? ofLength(borders.free, geometry.coordinates) : borders[occupancy], geometry.coordinates);
  }
  return all;
}

/** @param {Path2D} path @param {import("./geometry.js").Point[]} line */
function draw(path, line) {
  path.moveTo(...line[0]);
  for (const [x, y] of line) path.lineTo(x, y);
}

/** @param {Map<number, Path2D>} paths @param {import("./geometry.js").Point[]} line @returns {Path2D} that for lines of such a length */
function ofLength(paths, line) {
  let length = 0;
  line.forEach(([x, y], n) => { if (n > 0) length += Math.hypot(x - line[n - 1][0], y - line[n - 1][1]); });
  const most = 2 ** Math.ceil(Math.log2(Math.max(length, 1e-3)));
  const path = paths.get(most) ?? new Path2D();
  paths.set(most, path);
  return path;
}

/** @param {any} body of /doorways */
export function doorwaysOf(body) {
  return body.features.map((/** @type {any} */ { properties, geometry }) => {
    const rings = ringsOf(geometry);
    return { name: JSON.stringify([...properties.ends, properties.number]), since: properties.since, box: growBox(noBox(), rings.flat()), path: pathOf(rings) };
  });
}

/** @param {any} world of /world @returns {{obstacle: Path2D, space: Path2D, passage: Path2D, box: import("./geometry.js").Box}} */
export function worldOf(world) {
  const paths = { obstacle: new Path2D(), space: new Path2D(), passage: new Path2D(), box: noBox() };
  for (const zone of world.zones) {
    const [x, y] = zone.low;
    const kind = /** @type {"obstacle" | "space" | "passage"} */ (zone.kind);
    paths[kind].rect(x, y, zone.high[0] - x, zone.high[1] - y);
    growBox(paths.box, [zone.low, zone.high]);
  }
  return paths;
}
