/** What is closed, by whomever: passages, zones, or all zones of a label; close and open them. */

import { remove, sendJson } from "./api.js";
import { complain } from "./dom.js";
import { graphOf } from "./model.js";

const SOON_MS = 50; // after a restriction has ended
const TIMER_MAX_MS = 2 ** 31 - 1;

/** @typedef {{kind: "zone", id: string} | {kind: "edge", edge: import("./model.js").Edge}} Place */

export class Closings {
  /** @param {import("./session.js").Session} session */
  constructor(session) {
    this.session = session;
    this.timer = 0;
  }

  /** Read the restrictions, and the graph, which says what they close; again when one of them ends. */
  async read() {
    const [{ restrictions }, graph] = await Promise.all([
      this.session.get("/restrictions"), this.session.get("/graph"),
    ]);
    this.session.store.set({ restrictions, graph: graphOf(graph) });
    clearTimeout(this.timer);
    const ends = restrictions.flatMap((/** @type {any} */ one) => (one.expires_at ? [Date.parse(one.expires_at)] : []));
    if (ends.length === 0) return;
    const wait = Math.min(Math.max(Math.min(...ends) - Date.now(), 0) + SOON_MS, TIMER_MAX_MS);
    this.timer = window.setTimeout(() => this.read().catch(complain), wait);
  }

  close() {
    clearTimeout(this.timer);
  }

  /** @param {Place} place @returns {any | undefined} the restriction that closes just this, and can be lifted here */
  of(place) {
    return this.session.state.restrictions.find((one) => {
      if (!one.closed) return false;
      if (place.kind === "zone") return one.zone === place.id;
      const { source, target, n } = place.edge;
      return one.passage?.source === source && one.passage.target === target && (one.passage.n ?? 0) === n;
    });
  }

  /** @param {string} id @returns {boolean} whether a zone is closed, itself or by its label */
  hasZone(id) {
    return this.session.state.graph.closed.has(id);
  }

  /** @param {import("./model.js").Edge} edge @returns {boolean} whether no route leads through, for itself or for its ends */
  has(edge) {
    const { closed } = this.session.state.graph;
    return closed.has(edge.key) || closed.has(edge.source) || closed.has(edge.target);
  }

  /** Close something, or open it again. @param {Place} place */
  async turn(place) {
    const { path } = this.session;
    const found = this.of(place);
    try {
      if (found) await remove(`${path}/restrictions/${encodeURIComponent(found.id)}`);
      else if (place.kind === "zone") await sendJson(`${path}/restrictions`, { zone: place.id, closed: true });
      else {
        const { source, target, n } = place.edge;
        await sendJson(`${path}/restrictions`, { passage: { source, target, n }, closed: true });
      }
      await this.read();
    } catch (error) {
      complain(error);
    }
  }
}
