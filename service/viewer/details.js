/** What is selected, in words: a zone with its ways, or a passage that can be closed and opened. */

import { byId, counted, el, fixed } from "./dom.js";
import { shade } from "./palette.js";

/** @param {import("./session.js").Session} session */
export function showDetails(session) {
  const redraw = () => byId("details").replaceChildren(...content(session));
  session.store.on(["selected", "graph", "moment", "at", "session", "seq"], redraw);
  redraw();
}

/** @param {import("./session.js").Session} session @returns {Node[]} */
function content(session) {
  const { selected, session: about } = session.state;
  const { edges } = session.graphShown();
  if (selected?.kind === "zone") {
    const zone = session.state.moment.zones.find((one) => one.id === selected.id);
    if (zone) return aboutZone(session, zone, edges);
  }
  if (selected?.kind === "edge") {
    const edge = edges.find((one) => one.key === selected.id);
    if (edge) return aboutEdge(session, edge);
  }
  return about ? aboutSession(session, about) : [];
}

/** @param {[string, string][]} facts */
function list(facts) {
  return el("dl", {}, ...facts.flatMap(([name, value]) => [el("dt", {}, name), el("dd", {}, value)]));
}

/** @param {import("./session.js").Session} session @param {any} about */
function aboutSession(session, about) {
  const { moment } = session.state;
  const area = moment.zones.reduce((sum, zone) => sum + zone.area, 0);
  const sensor = about.world ? `${about.sensor.beams} beams, ${about.sensor.range} m` : "the robot\u2019s own";
  const parts = [list([
    ["World", about.world ? `${about.world.name || "unnamed"}, ${counted(about.world.zones, "rectangle")}` : "none: a real robot"],
    ["Sensor", sensor],
    ["Known", `${counted(moment.zones.length, "zone")}, ${fixed(area, 1)} m\u00b2`],
  ])];
  if (about.world || session.state.seq > 0) return parts;
  const url = new URL(`${session.path}/step`, document.baseURI);
  const scan = '{"angle_min": 0, "angle_increment": 1.57, "range_max": 5,\n  "beams": [[["hall", 2]], [["hall", 3]], [["hall", 2]], [["hall", 5]]], "kinds": {}}';
  const command = `curl ${url} --json '{"pose": {"x": 0, "y": 0, "theta": 0},\n  "scan": ${scan}}'`;
  return [...parts, el("p", {}, "Let the robot send its first scan:"), el("pre", {}, el("code", {}, command))];
}

/** @param {import("./session.js").Session} session @param {import("./model.js").Zone} zone @param {import("./model.js").Edge[]} edges */
function aboutZone(session, zone, edges) {
  const out = edges.filter((edge) => edge.source === zone.id);
  const into = edges.filter((edge) => edge.target === zone.id);
  const { aliases = [], class: kind } = session.state.graph.nodes.find((node) => node.id === zone.id) ?? {};
  return [
    el("p", { class: "name" }, swatch(zone.number), zone.label),
    list([
      ...(zone.id === zone.label ? [] : /** @type {[string, string][]} */ ([["Id", zone.id]])),
      ...(aliases.length === 0 ? [] : /** @type {[string, string][]} */ ([["Called", aliases.join(", ")]])),
      ...(kind ? /** @type {[string, string][]} */ ([["Class", kind]]) : []),
      ["Area", `${fixed(zone.area)} m\u00b2`],
      ["Found", `at step ${zone.since}`],
      ["Grew", `at step ${zone.seq}`],
      ["Passages", `${out.length} out, ${into.length} in`],
      ["State", stateOf(session.closings.hasZone(zone.id))],
    ]),
    turner(session, { kind: "zone", id: zone.id }, session.closings.hasZone(zone.id), "zone"),
    el("ul", { class: "ways" }, ...[...out, ...into].slice(0, 60).map((edge) => way(session, edge))),
  ];
}

/** @param {import("./session.js").Session} session @param {import("./model.js").Edge} edge */
function aboutEdge(session, edge) {
  const closed = session.closings.has(edge);
  return [
    el("p", { class: "name" }, `${edge.source} \u2192 ${edge.target}`),
    list([
      ["Point", `(${fixed(edge.point[0])}, ${fixed(edge.point[1])}) m`],
      ["Found", `at step ${edge.seq}`],
      ["State", stateOf(closed)],
    ]),
    turner(session, { kind: "edge", edge }, closed, "passage"),
  ];
}

/** @param {boolean} closed */
function stateOf(closed) {
  return closed ? "closed: no route leads through" : "open";
}

/**
 * A button that closes or opens; where something else closes it, such as its label, words that say so.
 * @param {import("./session.js").Session} session @param {import("./closings.js").Place} place @param {boolean} closed @param {string} what
 */
function turner(session, place, closed, what) {
  const own = Boolean(session.closings.of(place));
  if (closed && !own) return el("p", { class: "facts" }, what === "zone" ? "All zones of its label are closed." : "It is closed with a zone.");
  return el("button", { type: "button", class: own ? "primary" : "danger", onclick: () => session.closings.turn(place) },
    `${own ? "Open" : "Close"} this ${what}`);
}

/** @param {import("./session.js").Session} session @param {import("./model.js").Edge} edge */
function way(session, edge) {
  const closed = session.closings.has(edge);
  const own = Boolean(session.closings.of({ kind: "edge", edge }));
  const name = `${edge.source} \u2192 ${edge.target}`;
  const show = el("button", {
    type: "button", class: "way", onclick: () => session.store.set({ selected: { kind: "edge", id: edge.key } }),
    onmouseenter: () => session.store.set({ hover: { kind: "edge", id: edge.key } }),
    onmouseleave: () => session.store.set({ hover: null }),
    onfocus: () => session.store.set({ hover: { kind: "edge", id: edge.key } }),
    onblur: () => session.store.set({ hover: null }),
  }, name);
  const act = closed && !own ? null : el("button", {
    type: "button", class: "act", "aria-label": `${own ? "Open" : "Close"} ${name}`,
    onclick: () => session.closings.turn({ kind: "edge", edge }),
  }, own ? "Open" : "Close");
  return el("li", {}, show, closed ? el("span", { class: "shut" }, "closed") : null, act);
}

/** @param {number} number */
function swatch(number) {
  const one = el("i", { class: "swatch" });
  const { area, line } = shade(number);
  one.style.backgroundColor = area;
  one.style.borderColor = line;
  return one;
}
