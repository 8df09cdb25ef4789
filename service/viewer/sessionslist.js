/** All sessions, newest first as far as they were read, and what to do when there is none. */

import { getJson, remove, sessionPath } from "./api.js";
import { byId, complain, counted, el } from "./dom.js";

/** @type {any[]} */
let sessions = [];
/** @type {string | null} */
let cursor = null;

export async function showList() {
  sessions = [];
  cursor = null;
  byId("more").onclick = () => readMore().catch(complain);
  await readMore();
}

async function readMore() {
  const page = await getJson(`sessions?limit=200${cursor ? `&cursor=${cursor}` : ""}`);
  sessions = [...sessions, ...page.sessions];
  cursor = page.next;
  redraw();
}

function redraw() {
  byId("empty").hidden = sessions.length > 0;
  byId("more").hidden = cursor === null;
  byId("sessions").replaceChildren(...[...sessions].reverse().map(card));
}

/** @param {any} session */
function card(session) {
  const made = new Date(session.created_at);
  const when = made.toLocaleString(undefined, { dateStyle: "medium", timeStyle: "short" });
  const name = el("a", { href: `#/s/${encodeURIComponent(session.id)}` }, session.name);
  const del = el("button", { type: "button", class: "danger", "aria-label": `Delete ${session.name}`, onclick: () => ask(session, del) }, "Delete");
  return el("li", { class: "card" }, name, el("small", {}, `${counted(session.seq, "step")} \u00b7 ${when}`),
    session.name === session.id ? null : el("small", {}, session.id), del);
}

/** Delete at the second click. @param {any} session @param {HTMLButtonElement} button */
async function ask(session, button) {
  if (button.dataset.sure !== "yes") {
    button.dataset.sure = "yes";
    button.textContent = "Really delete?";
    setTimeout(() => {
      delete button.dataset.sure;
      button.textContent = "Delete";
    }, 4_000);
    return;
  }
  try {
    await remove(sessionPath(session.id));
    sessions = sessions.filter((one) => one !== session);
    redraw();
  } catch (error) {
    complain(error);
  }
}
