/** Turn the bodies of the service into what views draw; what has not changed stays the same object. */

import { growBox, noBox, pole } from "./geometry.js";

/**
 * @typedef {object} Zone
 * @property {string} id
 * @property {string} label
 * @property {number} area in m^2
 * @property {number} since the step that found it
 * @property {number} seq the last step that changed it
 * @property {number} number in order of finding
 * @property {import("./geometry.js").Ring[]} rings of all its polygons
 * @property {Path2D} path
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
    ring.forEach(([x, y], n) => (n === 0 ? path.moveTo(x, y) : path.lineTo(x, y)));
    path.closePath();
  }
  return path;
}

/**
 * @param {any} body of /zones
 * @param {Map<string, Zone>} known zones of other moments, by id and seq; new ones are added
 * @returns {Zone[]}
 */
export function zonesOf(body, known) {
  return body.features.map((/** @type {any} */ feature, /** @type {number} */ number) => {
    const about = feature.properties;
    const key = `${about.seq} ${feature.id}`;
    const kept = known.get(key);
    if (kept && kept.number === number) return kept;
    const rings = ringsOf(feature.geometry);
    const box = growBox(noBox(), rings.flat());
    /** @type {{x: number, y: number, r: number} | null} */
    let middle = null;
    const zone = {
      id: feature.id, label: about.label, area: about.area, since: about.since, seq: about.seq,
      number, rings, box, path: pathOf(rings),
      get pole() { return (middle ??= pole(rings, box)); }, // found when it is first needed
    };
    known.set(key, zone);
    return zone;
  });
}

/** @param {any} edge @returns {string} */
export function edgeKey(edge) {
  return JSON.stringify([edge.source, edge.target, edge.n ?? 0]);
}

/** @param {any} body of /graph @returns {{nodes: {id: string, label: string}[], edges: Edge[]}} */
export function graphOf(body) {
  return {
    nodes: body.nodes,
    edges: body.edges.map((/** @type {any} */ edge) => ({ ...edge, n: edge.n ?? 0, key: edgeKey(edge) })),
  };
}

/**
 * Gather lines by what they are, so that each sort is drawn at once.
 * @param {any} body of /borders
 * @returns {{obstacle: Path2D, passage: Path2D, free: Path2D}}
 */
export function bordersOf(body) {
  const paths = { obstacle: new Path2D(), passage: new Path2D(), free: new Path2D() };
  for (const feature of body.features) {
    const path = paths[/** @type {keyof typeof paths} */ (feature.properties.occupancy)];
    feature.geometry.coordinates.forEach((/** @type {[number, number]} */ [x, y], /** @type {number} */ n) =>
      n === 0 ? path.moveTo(x, y) : path.lineTo(x, y));
  }
  return paths;
}

/** @param {any} body of /doorways */
export function doorwaysOf(body) {
  return body.features.map((/** @type {any} */ feature) => ({
    ends: feature.properties.ends, since: feature.properties.since, path: pathOf(ringsOf(feature.geometry)),
  }));
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
