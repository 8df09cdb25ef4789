/** Questions in words; the answer in words, and on the map. */

import { Problem, sendJson } from "./api.js";
import { byId, complain, el, fixed } from "./dom.js";
import { edgeKey } from "./model.js";

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
      if (number === this.number) this.show(answer.sentence, answer, false);
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
    const clear = el("button", { type: "button", onclick: () => this.clear() }, "Clear");
    box.replaceChildren(el("p", { class: "said" }, words), ...this.facts(body, refused), el("div", { class: "chips" }, clear));
    this.session.store.set({ answer: refused ? this.gap(body) : this.way(body) });
  }

  clear() {
    this.asked = "";
    byId("answer").replaceChildren();
    byId("question").value = "";
    this.session.store.set({ answer: null });
  }

  /** @param {any} body @param {boolean} refused @returns {HTMLElement[]} */
  facts(body, refused) {
    const route = body.route;
    if (!refused && route) {
      const path = route.path;
      const more = path ? `, path ${fixed(path.length)} m, at least ${fixed(path.clearance)} m from walls` : "";
      return [el("p", { class: "facts" }, `${route.zones.join(" \u2192 ")} \u00b7 ${fixed(route.length)} m${more}`)];
    }
    if (!refused) return [];
    const facts = [];
    if (body.missing) facts.push(`Known is only the way back, ${body.missing.target} \u2192 ${body.missing.source}.`);
    if (body.frontier) facts.push("The ring on the map marks the nearest place where the map is not finished.");
    return facts.map((fact) => el("p", { class: "facts" }, fact));
  }

  /** @param {any} body of an answer @returns {Answer} */
  way(body) {
    const shown = nothing();
    const routes = body.routes ?? (body.route ? [body.route] : []);
    for (const route of routes.slice(0, 1)) {
      shown.zones.push(...route.zones);
      shown.edges.push(...route.passages.map(edgeKey));
      const points = route.path?.points ?? route.points ?? this.stations(route);
      shown.lines.push(points);
      shown.points.push(...(route.path || route.points ? [points[0], points[points.length - 1]] : []));
    }
    return shown;
  }

  /** @param {any} route one that tells no points: from the robot or the first zone's middle to the last one's */
  stations(route) {
    const zones = new Map(this.session.state.moment.zones.map((zone) => [zone.id, zone]));
    const ends = [route.zones[0], route.zones[route.zones.length - 1]].map((id) => zones.get(id)?.pole);
    const middle = route.passages.map((/** @type {any} */ passage) => passage.point);
    return [...(ends[0] ? [[ends[0].x, ends[0].y]] : []), ...middle, ...(ends[1] ? [[ends[1].x, ends[1].y]] : [])];
  }

  /** @param {any} body of a refusal @returns {Answer} */
  gap(body) {
    const shown = nothing();
    shown.zones.push(...(body.reachable ?? []));
    if (body.missing) {
      shown.missingEdges.push(body.missing);
      const zones = new Map(this.session.state.moment.zones.map((zone) => [zone.id, zone]));
      const back = this.session.state.graph.edges.find((edge) => edge.source === body.missing.target && edge.target === body.missing.source);
      const from = zones.get(body.missing.source)?.pole;
      const to = zones.get(body.missing.target)?.pole;
      if (back && to) shown.missing.push([back.point, [to.x, to.y]]);
      else if (from && to) shown.missing.push([[from.x, from.y], [to.x, to.y]]);
    }
    if (body.frontier) shown.frontiers.push(body.frontier.point);
    return shown;
  }
}

/** @param {string} name as it may stand in a question */
export function quoted(name) {
  return /^[\p{L}\p{N}_-]+$/u.test(name) ? name : `"${name}"`;
}
