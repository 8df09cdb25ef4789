/** Maps as they were at steps: those that were read are kept for a while, and zones shared among them. */

import { graphOf, zonesOf } from "./model.js";

const KEPT = 60;

/**
 * @typedef {object} Moment what is known of a map at one step
 * @property {number} seq
 * @property {import("./model.js").Zone[]} zones
 * @property {any} [sight] what the robot saw
 * @property {import("./model.js").Graph} [graph] as it was, where it is no part of the newest
 */

export class Moments {
  /** @param {(rest: string, signal?: AbortSignal) => Promise<any>} get */
  constructor(get) {
    this.get = get;
    /** @type {Map<string, import("./model.js").Zone>} by step of change and id */
    this.known = new Map();
    /** @type {Map<string, number>} of zones, in the order in which they were seen */
    this.numbers = new Map();
    /** @type {Map<number, Moment>} the one that was used last is the last */
    this.kept = new Map();
  }

  /**
   * @param {string} query the step, or nothing for the newest
   * @param {AbortSignal} [signal] @param {boolean} [withGraph] @returns {Promise<Moment>}
   */
  async read(query, signal, withGraph = false) {
    const parts = ["/zones", "/scan", ...(withGraph ? ["/graph"] : [])];
    const [zones, sight, graph] = await Promise.all(parts.map((part) => this.get(part + query, signal)));
    const moment = {
      seq: zones.seq, zones: zonesOf(zones, this.known, this.numbers), sight, ...(graph ? { graph: graphOf(graph) } : {}),
    };
    this.kept.set(moment.seq, moment);
    this.forget();
    return moment;
  }

  /** Let go of what was not used for longest, and of the zones that were only there. */
  forget() {
    for (const seq of this.kept.keys()) {
      if (this.kept.size <= KEPT) break;
      this.kept.delete(seq);
    }
    const used = new Set([...this.kept.values()].flatMap((moment) => moment.zones));
    if (this.known.size < 2 * used.size + 500) return;
    for (const [key, zone] of this.known) if (!used.has(zone)) this.known.delete(key);
  }

  /** @param {number} seq @returns {Moment | undefined} */
  recall(seq) {
    const moment = this.kept.get(seq);
    if (moment) {
      this.kept.delete(seq);
      this.kept.set(seq, moment);
    }
    return moment;
  }

  /**
   * What zones there must have been: those that were found by then, as large as they are known.
   * @param {number} seq @param {import("./model.js").Zone[]} near those of a moment near it
   * @returns {import("./model.js").Zone[]}
   */
  guess(seq, near) {
    const newest = this.kept.get(Math.max(...this.kept.keys()));
    const zones = new Map([...(newest?.zones ?? []), ...near].map((zone) => [zone.id, zone]));
    return [...zones.values()].filter((zone) => zone.since <= seq).sort((one, other) => one.since - other.since || one.number - other.number);
  }
}
