/** The topology graph on its canvas: a node for each zone, an arrow for each passage. */

import { Bends, along, arrow, edgeOf } from "./arrows.js";
import { Camera } from "./camera.js";
import { Stage } from "./canvas.js";
import { byId } from "./dom.js";
import { growBox, noBox } from "./geometry.js";
import { handle } from "./gestures.js";
import { HALF_HEIGHT, layOut } from "./graphlayout.js";
import { font } from "./labels.js";
import { colour, shade } from "./palette.js";

const LEGIBLE = 0.35; // of their size; smaller nodes have no name, and arrows no head
const LARGER_MAX = 2.2; // where there is much room

export class GraphView {
  /** @param {import("./session.js").Session} session */
  constructor(session) {
    this.session = session;
    this.camera = new Camera();
    this.touched = false;
    /** @type {Map<string, import("./graphlayout.js").Placed>} */
    this.placed = new Map();
    /** @type {Map<string, import("./model.js").Zone>} as they were seen last */
    this.zones = new Map();
    this.bends = new Bends(this.placed);
    const canvas = (this.canvas = byId("graph").cloneNode());
    byId("graph").replaceWith(canvas);
    this.stage = new Stage(canvas, this.camera,
      (context, camera, ratio) => this.drawGround(context, camera, ratio),
      (context, camera, ratio) => this.drawAbove(context, camera, ratio),
      () => { if (!this.touched) this.arrange(); });
    handle(canvas, this.camera, {
      moved: () => { this.touched = true; this.stage.move(); },
      fit: () => this.fit(),
      tapped: (px, py) => session.store.set({ selected: this.hit(px, py) }),
      hovered: (at) => this.hovered(at),
      key: () => false,
    });
    byId("graph-in").onclick = () => { this.camera.zoom(1.4); this.stage.move(); };
    byId("graph-out").onclick = () => { this.camera.zoom(1 / 1.4); this.stage.move(); };
    byId("graph-fit").onclick = () => this.fit();
    session.store.on(["graph", "moment"], () => this.changed());
    session.store.on(["at"], () => this.changed());
    session.store.on(["hover", "selected", "answer"], () => this.stage.refresh());
  }

  /** Lay out anew where there are other nodes than before. */
  changed() {
    const nodes = this.session.graphShown().nodes;
    if (!nodes.every((node) => this.placed.has(node.id))) this.arrange();
    const hint = byId("graph-hint");
    hint.hidden = nodes.length > 0;
    hint.textContent = "Each zone becomes a node, each passage an arrow.";
    this.stage.invalidate();
  }

  /** Give each node of now, and of the moment that is shown, its place. */
  arrange() {
    const { graph, moment } = this.session.state;
    for (const zone of moment.zones) this.zones.set(zone.id, zone);
    const known = new Map([...graph.nodes, ...this.session.graphShown().nodes].map((node) => [node.id, node]));
    const nodes = [...known.values()].filter((node) => this.zones.has(node.id));
    const context = this.stage.context;
    context.font = font(13);
    this.placed = layOut(nodes, this.zones, (words) => context.measureText(words).width, this.camera.width, this.camera.height);
    this.bends = new Bends(this.placed);
    if (!this.touched) this.fit();
  }

  fit() {
    const box = noBox();
    for (const { x, y, half } of this.placed.values()) growBox(box, [[x - half, y - HALF_HEIGHT], [x + half, y + HALF_HEIGHT]]);
    this.touched = false;
    this.camera.fit(this.placed.size > 0 ? box : [-1, -1, 1, 1], LARGER_MAX);
    this.stage.renew();
  }

  /** @param {import("./model.js").Edge} edge @returns {[number, number][] | null} start, bend and end in pixels of the layout */
  curve(edge) {
    const a = this.placed.get(edge.source);
    const b = this.placed.get(edge.target);
    const middle = this.bends.of(edge);
    return a && b && middle ? [edgeOf(a, middle, 2), middle, edgeOf(b, middle, 4)] : null;
  }

  /** @param {number} px @param {number} py @returns {{kind: "zone" | "edge", id: string} | null} */
  hit(px, py) {
    const [x, y] = this.camera.toMap(px, py);
    const { nodes, edges } = this.session.graphShown();
    const node = nodes.find(({ id }) => {
      const one = this.placed.get(id);
      return one && Math.abs(x - one.x) <= one.half && Math.abs(y - one.y) <= HALF_HEIGHT;
    });
    if (node) return { kind: "zone", id: node.id };
    let best = 8 / Math.min(this.camera.scale, 1);
    let found = null;
    for (const edge of edges) {
      const curve = this.curve(edge);
      for (let t = 0.05; curve && t < 1; t += 0.05) {
        const [cx, cy] = along(curve, t);
        const distance = Math.hypot(cx - x, cy - y);
        if (distance < best) [best, found] = [distance, edge];
      }
    }
    return found && { kind: "edge", id: found.key };
  }

  /** @param {[number, number] | null} at */
  hovered(at) {
    const found = at && this.hit(...at);
    const { hover } = this.session.state;
    if (found?.id !== hover?.id || found?.kind !== hover?.kind) this.session.store.set({ hover: found });
    this.canvas.classList.toggle("pointing", Boolean(found));
  }

  /** What changes only with the graph. @param {CanvasRenderingContext2D} context @param {Camera} camera @param {number} ratio */
  drawGround(context, camera, ratio) {
    context.setTransform(ratio, 0, 0, ratio, 0, 0);
    context.fillStyle = colour("panel");
    context.fillRect(0, 0, camera.width, camera.height);
    turn(context, camera, ratio);
    const { nodes, edges } = this.session.graphShown();
    if (camera.scale < LEGIBLE) this.drawWeb(context, edges);
    else for (const edge of edges) this.drawEdge(context, edge, 1.6, false);
    for (const node of nodes) this.drawNode(context, node.id, false, false);
  }

  /** Draw arrows too small to be told apart, all at once. @param {CanvasRenderingContext2D} context @param {import("./model.js").Edge[]} edges */
  drawWeb(context, edges) {
    for (const closed of [false, true]) {
      context.beginPath();
      for (const edge of edges) {
        const a = this.placed.get(edge.source);
        const b = this.placed.get(edge.target);
        if (!a || !b || this.session.closings.has(edge) !== closed) continue;
        context.moveTo(a.x, -a.y);
        context.lineTo(b.x, -b.y);
      }
      context.strokeStyle = colour(closed ? "bad" : "trail");
      context.lineWidth = 0.8 / this.camera.scale;
      context.stroke();
    }
  }

  /** What is looked at or was asked for. @param {CanvasRenderingContext2D} context @param {Camera} camera @param {number} ratio */
  drawAbove(context, camera, ratio) {
    turn(context, camera, ratio);
    const { hover, selected, answer } = this.session.state;
    const graph = this.session.graphShown();
    const lit = new Set([hover, selected].filter((one) => one !== null).map((one) => `${one.kind} ${one.id}`));
    const onRoute = new Set(answer?.edges ?? []);
    const zones = new Set(answer?.zones ?? []);
    if (lit.size + onRoute.size + zones.size === 0) return;
    const edges = graph.edges.filter((edge) => lit.has(`edge ${edge.key}`) || onRoute.has(edge.key) ||
      lit.has(`zone ${edge.source}`) || lit.has(`zone ${edge.target}`));
    for (const edge of edges) this.drawEdge(context, edge, lit.has(`edge ${edge.key}`) ? 4 : 2.5, onRoute.has(edge.key));
    for (const missing of answer?.missingEdges ?? []) this.drawMissing(context, missing);
    const ends = new Set([...edges, ...(answer?.missingEdges ?? [])].flatMap((edge) => [edge.source, edge.target]));
    for (const { id } of graph.nodes) {
      if (zones.has(id) || ends.has(id) || lit.has(`zone ${id}`)) this.drawNode(context, id, lit.has(`zone ${id}`), zones.has(id));
    }
  }

  /** @param {CanvasRenderingContext2D} context @param {import("./model.js").Edge} edge @param {number} width @param {boolean} onRoute */
  drawEdge(context, edge, width, onRoute) {
    const curve = this.curve(edge);
    if (!curve) return;
    const closed = this.session.closings.has(edge);
    const source = this.placed.get(edge.source);
    context.strokeStyle = onRoute ? colour("route") : closed ? colour("bad") : shade(source?.number ?? 0).line;
    context.fillStyle = context.strokeStyle;
    context.lineWidth = onRoute ? Math.max(width, 3.5) : width;
    context.setLineDash(closed ? [3, 5] : []);
    arrow(context, curve);
    context.setLineDash([]);
  }

  /** @param {CanvasRenderingContext2D} context @param {{source: string, target: string}} missing */
  drawMissing(context, missing) {
    const curve = this.curve({ key: "", n: 0, point: [0, 0], seq: 0, ...missing });
    if (!curve) return;
    context.strokeStyle = context.fillStyle = colour("bad");
    context.lineWidth = 2.5;
    context.setLineDash([8, 6]);
    arrow(context, curve);
    context.setLineDash([]);
  }

  /** @param {CanvasRenderingContext2D} context @param {string} id @param {boolean} lit @param {boolean} onRoute */
  drawNode(context, id, lit, onRoute) {
    const one = this.placed.get(id);
    if (!one) return;
    const { area, line, text } = shade(one.number);
    if (this.camera.scale < LEGIBLE && !lit && !onRoute) {
      context.fillStyle = line;
      context.fillRect(one.x - one.half, -one.y - HALF_HEIGHT, 2 * one.half, 2 * HALF_HEIGHT);
      return;
    }
    context.beginPath();
    context.roundRect(one.x - one.half, -one.y - HALF_HEIGHT, 2 * one.half, 2 * HALF_HEIGHT, HALF_HEIGHT);
    context.fillStyle = area;
    context.fill();
    context.strokeStyle = onRoute ? colour("route") : line;
    context.lineWidth = lit || onRoute ? 3 : 1.5;
    context.stroke();
    if (this.camera.scale < LEGIBLE) return;
    context.font = font(13);
    context.textAlign = "center";
    context.textBaseline = "middle";
    context.fillStyle = text;
    context.fillText(one.words, one.x, -one.y + 0.5);
  }
}

/** @param {CanvasRenderingContext2D} context @param {Camera} camera @param {number} ratio y points down, for letters */
function turn(context, camera, ratio) {
  const s = camera.scale * ratio;
  context.setTransform(s, 0, 0, s, (camera.width / 2) * ratio - camera.x * s, (camera.height / 2) * ratio + camera.y * s);
}
