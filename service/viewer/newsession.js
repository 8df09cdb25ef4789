/** Begin a session: in the example, in a world from a file, or for a robot with a sensor of its own. */

import { getJson, request, sendJson } from "./api.js";
import { byId, complain } from "./dom.js";

const EXAMPLE = "viewer/example";

/** @param {string} kind */
function choose(kind) {
  byId("new-form").elements.kind.value = kind;
  byId("world-field").hidden = kind !== "world";
  byId("world-file").required = kind === "world";
}

/** @param {string} kind which choice is made already */
function openDialog(kind) {
  byId("new-problem").hidden = true;
  byId("new-name").value = "";
  choose(kind);
  byId("new-dialog").showModal();
}

/** @param {string} kind @returns {Promise<any>} the world of the new session, if it has one */
async function worldFor(kind) {
  if (kind === "example") return getJson(`${EXAMPLE}/world.json`);
  if (kind !== "world") return undefined;
  const [file] = byId("world-file").files;
  if (!file) throw new Error("Choose a world file first.");
  try {
    return JSON.parse(await file.text());
  } catch {
    throw new Error("This file is not JSON.");
  }
}

/** @param {string} kind */
async function create(kind) {
  const world = await worldFor(kind);
  const value = (/** @type {string} */ id) => Number(byId(id).value);
  const session = await sendJson("sessions", {
    ...(byId("new-name").value.trim() ? { name: byId("new-name").value.trim() } : {}),
    ...(world ? { world } : {}),
    sensor: { beams: value("beams"), range: value("range"), samples: value("samples") },
    mapping: { edges: byId("edges").value },
  });
  location.hash = `#/s/${encodeURIComponent(session.id)}${kind === "example" ? "?tour" : ""}`;
}

export function startNewSession() {
  byId("new").onclick = () => openDialog("example");
  byId("empty-own").onclick = () => openDialog("world");
  byId("empty-example").onclick = () => create("example").catch(complain);
  byId("new-cancel").onclick = () => byId("new-dialog").close();
  for (const radio of byId("new-form").elements.kind) radio.onchange = () => choose(radio.value);
  byId("new-form").onsubmit = async (/** @type {Event} */ event) => {
    event.preventDefault();
    byId("new-problem").hidden = true;
    byId("new-create").disabled = true;
    try {
      await create(byId("new-form").elements.kind.value);
      byId("new-dialog").close();
    } catch (error) {
      byId("new-problem").textContent = error instanceof Error ? error.message : String(error);
      byId("new-problem").hidden = false;
    } finally {
      byId("new-create").disabled = false;
    }
  };
}

/** @returns {Promise<[number, number, number][]>} the path through the example, step by step */
export async function tour() {
  const lines = (await (await request(`${EXAMPLE}/path.csv`)).text()).trim().split(/\r?\n/).slice(1);
  return lines.map((line) => {
    const [x, y, theta = 0] = line.split(",").map(Number);
    return [x, y, theta];
  });
}
