/** The menu that says which layers of the map are drawn. */

import { byId, el } from "./dom.js";

const LAYERS = { walls: "Walls, passages, frontiers", beams: "Beams", trail: "Trail", names: "Names", world: "The simulated world" };

/** @typedef {Record<keyof typeof LAYERS, boolean>} Shown */

/** @param {() => void} changed @returns {Shown} what is chosen, now and later */
export function layerMenu(changed) {
  /** @type {Shown} */
  const shown = { walls: true, beams: true, trail: true, names: true, world: false };
  byId("layer-menu").replaceChildren(...Object.entries(LAYERS).map(([name, words]) => {
    const key = /** @type {keyof typeof LAYERS} */ (name);
    const box = el("input", { type: "checkbox", checked: shown[key], onchange: () => {
      shown[key] = box.checked;
      changed();
    } });
    return el("label", {}, box, words);
  }));
  return shown;
}
