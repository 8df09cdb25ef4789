/** Questions in words; the answer in words, and on the map. */

import { Problem, getJson, sendJson } from "./api.js";
import { byId, complain, el, fixed } from "./dom.js";
import { edgeKey } from "./model.js";

const RADIUS = 0.1; // m, of the robot for which a path is drawn

/**
 * @typedef {object} Answer what views draw of an answer
 * @property {[number, number][][]} lines
 * @property {[number, number][]} points
 * @property {string[]} zones
 * @property {string[]} edges keys
 * @property {[number, number][][]} missing
 * @property {{source: string, target: string}[]} missingEdges
 * @property {[number, number][]} frontiers
 */

/** @returns {Answer} */
function nothing() {
  return { lines: [], points: [], zones: [], edges: [], missing: [], missingEdges: [], frontiers: [] };
}

export class AskBox {
  /** @param {import("./session.js").Session} session */
  constructor(session) {
    this.session = session;
    this.asked = "";
    this.number = 0;
    byId("ask-form").onsubmit = (/** @type {Event} */ event) => {
      event.preventDefault();
      void this.ask(byId("question").value.trim());
    };
    byId("question").value = "";
    byId("answer").replaceChildren();
    session.store.on(["graph"], () => this.suggest());
    session.store.on(["restrictions"], () => { if (this.asked) void this.ask(this.asked); });
  }

  /** Offer a question that this map can answer, as an example. */
  suggest() {
    const { edges } = this.session.state.graph;
    const last = edges[edges.length - 1];
    if (last) byId("question").placeholder = `path from ${quoted(last.source)} to ${quoted(last.target)}`;
  }

  /** @param {string} text */
  async ask(text) {
    if (!text) return;
    const number = (this.number += 1);
    this.asked = text;
    try {
      const answer = await sendJson(`${this.session.path}/query`, { text });
      if (number !== this.number) return undefined;
      this.show(answer.sentence, answer, false);
      if (answer.route?.passages.length > 0) await this.addPath(answer, number);
    } catch (error) {
      if (!(error instanceof Problem)) return complain(error);
      if (number === this.number) this.show(error.message, error.body, true);
    }
    return undefined;
  }

  /** @param {string} words @param {any} body @param {boolean} refused */
  show(words, body, refused) {
    const box = byId("answer");
    box.classList.toggle("refused", refused);
    const gap = refused ? body : body.gap;
    box.replaceChildren(
      el("p", { class: "said" }, words),
      ...this.facts(body, gap).map((fact) => el("p", { class: "facts" }, fact)),
      el("div", { class: "chips" }, ...this.offers(body),
        el("button", { type: "button", onclick: () => this.clear() }, "Clear")),
    );
    this.session.store.set({ answer: gap ? this.gap(gap) : this.found(body) });
  }

  /** Draw the path that a robot can drive, where there is one. @param {any} answer @param {number} number */
  async addPath(answer, number) {
    const { route } = answer;
    const query = new URLSearchParams({ from: route.source, to: route.target, radius: String(RADIUS) });
    for (const zone of route.zones.slice(1, -1)) query.append("via", zone);
    if (route.points) [query.set("x", route.points[0][0]), query.set("y", route.points[0][1])];
    let words;
    try {
      const { path } = await getJson(`${this.session.path}/route?${query}`);
      if (number !== this.number) return;
      this.session.store.set({ answer: this.found({ ...answer, route: { ...route, path } }) });
      words = `A path of ${fixed(path.length)} m keeps ${fixed(path.clearance)} m from all that is not free.`;
    } catch (error) {
      if (!(error instanceof Problem)) throw error;
      words = `No path is drawn: ${error.message.charAt(0).toLowerCase()}${error.message.slice(1)}`;
    }
    if (number === this.number) byId("answer").querySelector(".chips").before(el("p", { class: "facts" }, words));
  }

  clear() {
    this.asked = "";
    this.number += 1;
    byId("answer").replaceChildren();
    byId("question").value = "";
    this.session.store.set({ answer: null });
  }

  /** @param {any} body @returns {HTMLElement[]} questions to ask instead */
  offers(body) {
    const texts = [body.example, ...(body.readings ?? [])].filter((one) => typeof one === "string");
    return texts.map((text) => el("button", { type: "button", onclick: () => {
      byId("question").value = text;
      void this.ask(text);
    } }, text));
  }

  /** @param {any} body @param {any} gap @returns {string[]} */
  facts(body, gap) {
    const facts = [];
    const { route } = body;
    if (route) facts.push(`${route.zones.join(" \u2192 ")} \u00b7 ${fixed(route.length)} m`);
    if (gap?.frontier) facts.push("The green ring on the map marks the frontier to explore.");
    if (gap?.missing) facts.push("The dashed arrow is the passage that is missing.");
    const near = [...(body.closest ?? []), ...(body.candidates ?? [])];
    if (near.length > 0) facts.push(`Known are: ${near.join(", ")}.`);
    if (this.session.state.at !== null) facts.push(`This is about the newest map, that of step ${this.session.state.seq}.`);
    return facts;
  }

  /** @param {any} body of an answer @returns {Answer} */
  found(body) {
    const shown = nothing();
    if (body.route) this.addRoute(shown, body.route);
    for (const one of [body.zone, ...(body.zones ?? []), ...(body.neighbours ?? [])]) {
      const id = typeof one === "string" ? one : one?.zone;
      if (id) shown.zones.push(id);
      if (one?.point) shown.points.push(one.point);
    }
    for (const passage of body.passages ?? []) shown.edges.push(edgeKey(passage));
    for (const frontier of body.frontiers ?? []) shown.frontiers.push(frontier.point);
    return shown;
  }

  /** @param {Answer} shown @param {any} route */
  addRoute(shown, route) {
    shown.zones.push(...route.zones);
    shown.edges.push(...route.passages.map(edgeKey));
    const points = route.path?.points ?? route.points ?? this.stations(route);
    shown.lines.push(points);
    shown.points.push(points[0], points[points.length - 1]);
  }

  /** @param {any} route one without a path: from the middle of its first zone through its passages @returns {[number, number][]} */
  stations(route) {
    const zones = new Map(this.session.state.moment.zones.map((zone) => [zone.id, zone]));
    const ends = [route.zones[0], route.zones[route.zones.length - 1]].map((id) => zones.get(id)?.pole);
    const [first, last] = ends.map((pole) => (pole ? [[pole.x, pole.y]] : []));
    return [...first, ...route.passages.map((/** @type {any} */ passage) => passage.point), ...last];
  }

  /** @param {any} body what a refusal tells of the gap @returns {Answer} */
  gap(body) {
    const shown = nothing();
    shown.zones.push(...(body.reachable ?? []));
    if (body.missing) {
      shown.missingEdges.push(body.missing);
      const { source, target } = body.missing;
      const back = this.session.state.graph.edges.find((edge) => edge.source === target && edge.target === source);
      const to = this.session.state.moment.zones.find((zone) => zone.id === target)?.pole;
      if (back && to) shown.missing.push([back.point, [to.x, to.y]]);
    }
    if (body.frontier) shown.frontiers.push(body.frontier.point);
    return shown;
  }
}

/** @param {string} name as it may stand in a question */
function quoted(name) {
  return /^[\p{L}\p{N}_-]+$/u.test(name) ? name : `"${name}"`;
}
