/** Zones and passages as tables: the same as the map and the graph, for who would rather read. */

import { byId, el, fixed } from "./dom.js";

const ROWS = 200; // more are shown on request

/** @param {import("./session.js").Session} session */
export function showTables(session) {
  let rows = ROWS;
  const body = el("div", {});
  const whole = el("details", { ontoggle: () => redraw() }, el("summary", {}, "Zones and passages as tables"), body);
  byId("tables").replaceChildren(whole);

  function redraw() {
    if (!whole.open) return;
    const { edges } = session.graphShown();
    const zones = session.state.moment.zones;
    const more = Math.max(zones.length, edges.length) > rows;
    const button = more && el("button", { type: "button", onclick: () => { rows += 5 * ROWS; redraw(); } }, "Show more rows");
    body.replaceChildren(
      table(`Zones (${shownOf(zones)})`, ["Zone", "Area, m\u00b2", "Found", "Grew"], zones.slice(0, rows).map((zone) => [
        link(zone.label, () => session.store.set({ selected: { kind: "zone", id: zone.id } })),
        fixed(zone.area), String(zone.since), String(zone.seq),
      ])),
      table(`Passages (${shownOf(edges)})`, ["From", "To", "Point, m", "Found"], edges.slice(0, rows).map((edge) => [
        link(edge.source, () => session.store.set({ selected: { kind: "edge", id: edge.key } })),
        edge.target + (session.closings.has(edge) ? " (closed)" : ""),
        `${fixed(edge.point[0])}, ${fixed(edge.point[1])}`, String(edge.seq),
      ])),
      ...(button ? [button] : []),
    );
  }

  /** @param {any[]} all */
  function shownOf(all) {
    return all.length > rows ? `${rows} of ${all.length}` : `${all.length}`;
  }
  session.store.on(["moment", "graph", "at", "restrictions"], redraw);
}

/** @param {string} words @param {() => void} onclick */
function link(words, onclick) {
  return el("button", { type: "button", onclick }, words);
}

/** @param {string} caption @param {string[]} columns @param {(string | Node)[][]} rows */
function table(caption, columns, rows) {
  return el("table", {}, el("caption", {}, caption),
    el("thead", {}, el("tr", {}, ...columns.map((name) => el("th", { scope: "col" }, name)))),
    el("tbody", {}, ...rows.map((row) => el("tr", {}, ...row.map((cell) => el("td", {}, cell))))));
}
