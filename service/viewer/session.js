/** One session: read it, follow it, and go back in time. Views listen to its store. */

import { Problem, getJson, sessionPath } from "./api.js";
import { Closings } from "./closings.js";
import { complain } from "./dom.js";
import { graphOf, worldOf } from "./model.js";
import { Moments } from "./moments.js";
import { changed, graphAfter } from "./since.js";
import { Store } from "./store.js";
import { follow } from "./stream.js";

const DELETED = "This session was deleted. What you see is the last that was known.";
const REFRESH_MS = 120; // between two readings of a map that grows
const SETTLE_MS = 50; // a slider that rests so long is worth asking for

export class Session {
  /** @param {string} id */
  constructor(id) {
    this.id = id;
    this.path = sessionPath(id);
    this.store = new Store({
      /** @type {any} */ session: null,
      seq: 0,
      /** @type {number | null} the step that is looked at; null is live */ at: null,
      /** @type {[number, number, number][]} x, y, theta of each step */ poses: [],
      /** @type {any[]} steps that found something */ changes: [],
      /** @type {import("./moments.js").Moment} */ moment: { seq: 0, zones: [] },
      exact: true,
      /** @type {import("./model.js").Graph} the newest */ graph: { seq: 0, nodes: [], edges: [], closed: new Set() },
      /** @type {any} */ world: null,
      /** @type {any[]} */ restrictions: [],
      /** @type {any} */ answer: null,
      /** @type {{kind: "zone" | "edge", id: string} | null} */ hover: null,
      /** @type {{kind: "zone" | "edge", id: string} | null} */ selected: null,
      link: "waiting",
      driving: false,
    });
    this.closings = new Closings(this);
    this.moments = new Moments((rest, signal) => this.get(rest, signal));
    this.ended = new AbortController();
    /** @type {AbortController | null} */
    this.going = null;
    this.dirty = false;
    this.reading = false;
    this.settle = 0;
  }

  get state() {
    return this.store.state;
  }

  /** Whether a step has found something that the graph does not show yet. */
  get graphIsOld() {
    const { changes, graph } = this.state;
    return changes.length > 0 && graph.seq < changes[changes.length - 1].seq;
  }

  /** @param {import("./moments.js").Moment} moment @returns {boolean} whether it, and the graph, are of the last step */
  isNewest(moment) {
    return moment.seq >= this.state.seq && !this.graphIsOld;
  }

  /** The last step that merged zones or joined passages: graphs before it are no part of the newest. */
  get reshaped() {
    const last = this.state.changes.findLast(({ events }) => events.some((/** @type {any} */ one) => one.type === "merge" || one.type === "join"));
    return last ? last.seq : 0;
  }

  /** The step that is shown. */
  get shown() {
    return this.state.at ?? this.state.seq;
  }

  /** Read what is needed to see something, then the rest, then follow. */
  async open() {
    const [session, moment, graph] = await Promise.all([
      this.get(""), this.moments.readNewest(), this.get("/graph"),
    ]);
    const { seq } = moment;
    this.store.set({ session, seq, graph: graphOf(graph), moment });
    this.stop = follow(`${this.path}/events`, seq, {
      told: (event, data) => this.told(event, data),
      link: (link) => this.store.set({ link }),
      outdated: () => void this.reopen(),
    });
    await Promise.all([this.readTrail(), this.closings.read(), this.readWorld()]);
  }

  close() {
    this.ended.abort();
    this.going?.abort();
    this.closings.close();
    this.stop?.();
  }

  /** @param {string} rest @param {AbortSignal} [signal] */
  get(rest, signal = this.ended.signal) {
    return getJson(this.path + rest, signal);
  }

  /** The log is not what it was: somebody put another database there, or the session is gone. */
  async reopen() {
    this.stop?.();
    try {
      await this.get("");
      location.reload();
    } catch (error) {
      this.store.set({ link: "gone" });
      complain(error instanceof Problem && error.code === "unknown_session" ? DELETED : error);
    }
  }

  async readTrail() {
    for (let after = 0; after !== null; ) {
      const page = await this.get(`/trail?after=${after}`);
      const poses = this.state.poses.slice();
      page.poses.forEach((/** @type {any} */ pose, /** @type {number} */ n) => { poses[page.first - 1 + n] = pose; });
      const seen = new Set(this.state.changes.map((one) => one.seq));
      const changes = [...this.state.changes, ...page.changes.filter((/** @type {any} */ one) => !seen.has(one.seq))];
      this.store.set({ poses, changes: changes.sort((one, other) => one.seq - other.seq) });
      after = page.next;
    }
  }

  async readWorld() {
    if (this.state.session.world) this.store.set({ world: worldOf(await this.get("/world")) });
  }

  /** @param {string} event @param {any} data */
  told(event, data) {
    if (event === "step") this.stepped(data);
    else if (event === "change") this.closings.read().catch(complain);
    else if (event === "deleted") {
      this.stop?.();
      this.store.set({ link: "gone" });
      complain(DELETED);
    }
  }

  /** @param {any} step */
  stepped(step) {
    const { poses } = this.state;
    if (step.seq <= this.state.seq) return; // it was told already
    poses[step.seq - 1] = [step.pose.x, step.pose.y, step.pose.theta];
    const isNews = step.events.length > 0 && !this.state.changes.some((one) => one.seq === step.seq);
    const changes = isNews ? [...this.state.changes, step] : this.state.changes;
    const { selected } = this.state;
    const merge = step.events.find((/** @type {any} */ one) => one.type === "merge" && one.zone_id === selected?.id);
    if (merge) this.store.set({ selected: { kind: "zone", id: merge.into } });
    this.store.set({ seq: step.seq, poses: poses.slice(), changes });
    if (this.state.at === null) this.store.set({ exact: this.isNewest(this.state.moment) });
    if (this.state.at === null || step.events.length > 0) void this.refresh();
  }

  /** Read the newest map; while it is read, further calls lead to one more reading. */
  async refresh() {
    this.dirty = true;
    if (this.reading) return;
    this.reading = true;
    try {
      while (this.dirty && !this.ended.signal.aborted) {
        this.dirty = false;
        await this.readNewest();
        await new Promise((resolve) => setTimeout(resolve, REFRESH_MS));
      }
    } catch (error) {
      complain(error);
    } finally {
      this.reading = false;
    }
  }

  async readNewest() {
    const [moment] = await Promise.all([this.moments.readNewest(), this.graphIsOld ? this.readGraph() : null]);
    if (this.graphIsOld) this.dirty = true;
    if (this.state.at === null) this.store.set({ moment, exact: this.isNewest(moment) });
  }

  /** Read what changed of the graph, or all of it, unless somebody else did meanwhile. */
  async readGraph() {
    const known = this.state.graph;
    const body = await changed((rest) => this.get(rest), `/graph?since=${known.seq}`);
    const graph = (body && graphAfter(known, body)) ?? graphOf(await this.get("/graph"));
    if (this.state.graph === known) this.store.set({ graph });
  }

  /**
   * Show a step, or what is live: at once what can be told from maps that are known, then the map as it was.
   * @param {number | null} at
   */
  go(at) {
    this.going?.abort();
    this.going = null;
    clearTimeout(this.settle);
    if (at === null || at >= this.state.seq) {
      this.store.set({ at: null, exact: this.isNewest(this.state.moment) });
      void this.refresh();
    } else if (!this.recall(at)) {
      this.store.set({ at, moment: { seq: at, zones: this.moments.guess(at, this.state.moment.zones) }, exact: false });
      this.settle = setTimeout(() => this.fetchMoment(at).catch(complain), SETTLE_MS);
    }
  }

  /** Show a step on the way through many: one map is fetched at a time, and shown when it comes. @param {number} at */
  play(at) {
    clearTimeout(this.settle);
    if (this.recall(at)) return;
    const zones = this.state.moment.zones.filter((zone) => zone.since <= at);
    this.store.set({ at, moment: { ...this.state.moment, zones }, exact: false });
    if (!this.going) this.fetchMoment(at).catch(complain);
  }

  /** @param {number} at @returns {boolean} whether the map was known, and is shown */
  recall(at) {
    const moment = this.moments.recall(at);
    if (!moment || (at < this.reshaped && !moment.graph)) return false;
    this.store.set({ at, moment, exact: true });
    return true;
  }

  /** @param {number} at */
  async fetchMoment(at) {
    const going = (this.going = new AbortController());
    try {
      const moment = await this.moments.read(`?at=${at}`, going.signal, at < this.reshaped);
      if (this.state.at === at) this.store.set({ moment, exact: true });
      else if (this.state.at !== null && this.state.at > at) this.store.set({ moment });
    } finally {
      if (this.going === going) this.going = null;
    }
  }

  /** @returns {{nodes: any[], edges: import("./model.js").Edge[]}} the graph at the step that is shown */
  graphShown() {
    const { graph, at, moment } = this.state;
    if (at === null) return graph;
    if (moment.graph && moment.seq === at) return moment.graph;
    const zones = new Set(moment.zones.map((zone) => zone.id));
    return {
      nodes: graph.nodes.filter((node) => zones.has(node.id)),
      edges: graph.edges.filter((edge) => edge.seq <= at && zones.has(edge.source) && zones.has(edge.target)),
    };
  }
}
