/** Maps as they were at steps: those that were read are kept for a while, and zones shared among them. */

import { graphOf, zonesOf } from "./model.js";
import { added, changed } from "./since.js";

const KEPT = 60;
const SPARE = 500; // zones of moments that are no longer kept, before they are let go

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
    /** @type {Moment | null} the newest that was read */
    this.newest = null;
    this.knownMax = SPARE;
  }

  /** Read the newest map: what changed since it was read last, or all of it. @returns {Promise<Moment>} */
  async readNewest() {
    this.newest = (await this.readChanges()) ?? (await this.read(""));
    return this.newest;
  }

  /** @returns {Promise<Moment | null>} nothing if there is nothing to add to, or zones are gone */
  async readChanges() {
    const { newest } = this;
    if (!newest) return null;
    const [body, sight] = await Promise.all([changed(this.get, `/zones?since=${newest.seq}`), this.get("/scan")]);
    if (!body) return null;
    const zones = added(newest.zones, zonesOf(body, this.known, this.numbers), (zone) => zone.id, body.total);
    return zones && this.keep({ seq: body.seq, zones, sight });
  }

  /**
   * @param {string} query the step, or nothing for the newest
   * @param {AbortSignal} [signal] @param {boolean} [withGraph] @returns {Promise<Moment>}
   */
  async read(query, signal, withGraph = false) {
    const parts = ["/zones", "/scan", ...(withGraph ? ["/graph"] : [])];
    const [zones, sight, graph] = await Promise.all(parts.map((part) => this.get(part + query, signal)));
    return this.keep({
      seq: zones.seq, zones: zonesOf(zones, this.known, this.numbers), sight, ...(graph ? { graph: graphOf(graph) } : {}),
    });
  }

  /** @param {Moment} moment @returns {Moment} */
  keep(moment) {
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
    if (this.known.size < this.knownMax) return;
    const used = new Set([...this.kept.values(), ...(this.newest ? [this.newest] : [])].flatMap((moment) => moment.zones));
    for (const [key, zone] of this.known) if (!used.has(zone)) this.known.delete(key);
    this.knownMax = 2 * used.size + SPARE;
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
