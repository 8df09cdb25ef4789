/** Questions in words; the answer in words, and on the map. */

import { Problem, sendJson } from "./api.js";
import { byId, complain, el, fixed } from "./dom.js";
import { edgeKey } from "./model.js";

const FOR_WANT_OF_ROOM = new Set(["too_narrow", "outside_free_space", "not_connected"]);

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
    byId("robot-radius").onchange = () => this.askAgain();
    byId("two-way").onclick = () => this.goBothWays(!this.twoWay);
    this.twoWay = byId("two-way").getAttribute("aria-pressed") === "true";
    session.store.on(["graph"], () => this.suggest());
    session.store.on(["restrictions"], () => this.askAgain());
  }

  /** Offer a question that this map can answer, as an example. */
  suggest() {
    const { edges } = this.session.state.graph;
    const last = edges[edges.length - 1];
    if (last) byId("question").placeholder = `path from ${quoted(last.source)} to ${quoted(last.target)}`;
  }

  /** @param {boolean} twoWay */
  goBothWays(twoWay) {
    this.twoWay = twoWay;
    byId("two-way").setAttribute("aria-pressed", String(twoWay));
    this.askAgain();
  }

  askAgain() {
    if (this.asked) void this.ask(this.asked);
  }

  /** @param {string} text */
  async ask(text) {
    if (!text) return;
    const number = (this.number += 1);
    this.asked = text;
    try {
      const [answer, note] = await this.answered(text);
      if (number === this.number) this.show(answer.sentence, answer, false, note);
    } catch (error) {
      if (!(error instanceof Problem)) complain(error);
      else if (number === this.number) this.show(error.message, error.body, true);
    }
  }

  /**
   * Ask for a path on which the robot fits; if it fits on none, for the way alone.
   * @param {string} text @returns {Promise<[any, string?]>} the answer, and why there is no path
   */
  async answered(text) {
    const radius = byId("robot-radius").valueAsNumber;
    const question = { text, two_way: this.twoWay };
    const path = `${this.session.path}/query`;
    if (Number.isNaN(radius)) return [await sendJson(path, question)];
    try {
      return [await sendJson(path, { ...question, radius })];
    } catch (error) {
      if (!(error instanceof Problem) || !FOR_WANT_OF_ROOM.has(error.body.code)) throw error;
      const words = `${error.message.charAt(0).toLowerCase()}${error.message.slice(1)}`;
      return [await sendJson(path, question), `No path is drawn: ${words}`];
    }
  }

  /** @param {string} words @param {any} body @param {boolean} refused @param {string} [note] */
  show(words, body, refused, note) {
    const box = byId("answer");
    box.classList.toggle("refused", refused);
    const gap = refused ? body : body.gap;
    box.replaceChildren(
      el("p", { class: "said" }, words),
      ...[...this.facts(body, gap), ...(note ? [note] : [])].map((fact) => el("p", { class: "facts" }, fact)),
      el("div", { class: "chips" }, ...this.offers(body),
        el("button", { type: "button", onclick: () => this.clear() }, "Clear")),
    );
    this.session.store.set({ answer: gap ? this.gap(gap) : this.found(body) });
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
    const offers = texts.map((text) => el("button", { type: "button", onclick: () => {
      byId("question").value = text;
      void this.ask(text);
    } }, text));
    if (body.two_way && !this.twoWay) {
      offers.push(el("button", { type: "button", onclick: () => this.goBothWays(true) }, "Use passages both ways"));
    }
    return offers;
  }

  /** @param {any} body @param {any} gap @returns {string[]} */
  facts(body, gap) {
    const facts = [];
    const { route } = body;
    if (route) facts.push(`${route.zones.join(" \u2192 ")} \u00b7 ${fixed(route.length)} m`);
    if (route?.path) facts.push(`The path keeps ${fixed(route.path.clearance)} m from all that is not free.`);
    if (gap?.frontier && !gap.restricted) facts.push("The green ring on the map marks the frontier to explore.");
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
    if (body.frontier && !body.restricted) shown.frontiers.push(body.frontier.point);
    return shown;
  }
}

/** @param {string} name as it may stand in a question */
function quoted(name) {
  return /^[\p{L}\p{N}_-]+$/u.test(name) ? name : `"${name}"`;
}
