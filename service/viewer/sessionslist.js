/** All sessions, newest first, and what to do when there is none; what others begin appears by itself. */

import { getJson, remove, sessionPath } from "./api.js";
import { byId, complain, counted, el } from "./dom.js";

const AGAIN_MS = 4_000;

/** @type {any[]} */
let sessions = [];
/** @type {string | null} */
let cursor = null;
let timer = 0;

/** Show the list, and keep it up to date until it is hidden. */
export async function showList() {
  byId("more").onclick = () => readMore().catch(complain);
  sessions = [];
  await readNewest();
  clearInterval(timer);
  timer = window.setInterval(() => {
    if (byId("list-view").hidden) clearInterval(timer);
    else if (document.visibilityState === "visible") readNewest().catch(() => {}); // the next time may do
  }, AGAIN_MS);
}

/** @param {string} [after] */
function read(after) {
  return getJson(`sessions?order=newest&limit=100${after ? `&cursor=${after}` : ""}`);
}

/** Read the first page; what was read beyond it stays. */
async function readNewest() {
  const page = await read();
  const last = page.sessions[page.sessions.length - 1];
  const beyond = page.next === null ? [] : sessions.slice(1 + sessions.findIndex((one) => one.id === last.id));
  const known = page.next !== null && sessions.some((one) => one.id === last.id);
  cursor = known ? cursor : page.next;
  replace([...page.sessions, ...(known ? beyond : [])]);
}

async function readMore() {
  const page = await read(cursor ?? undefined);
  cursor = page.next;
  replace([...sessions, ...page.sessions]);
}

/** Show other sessions; the cards of those that were shown stay, with the focus that they may have. @param {any[]} other */
function replace(other) {
  sessions = other;
  byId("empty").hidden = sessions.length > 0;
  byId("more").hidden = cursor === null;
  const list = byId("sessions");
  const shown = new Map([...list.children].map((one) => [one.dataset.id, one]));
  const cards = sessions.map((session) => shown.get(session.id) ?? card(session));
  sessions.forEach((session, n) => { cards[n].querySelector("small").textContent = about(session); });
  for (const gone of [...shown.values()].filter((one) => !cards.includes(one))) gone.remove();
  cards.forEach((one, n) => { if (list.children[n] !== one) list.insertBefore(one, list.children[n] ?? null); });
}

/** @param {any} session */
function about(session) {
  const when = new Date(session.created_at).toLocaleString(undefined, { dateStyle: "medium", timeStyle: "short" });
  return `${counted(session.seq, "step")} \u00b7 ${when}`;
}

/** @param {any} session */
function card(session) {
  const name = el("a", { href: `#/s/${encodeURIComponent(session.id)}` }, session.name);
  const del = el("button", { type: "button", class: "danger", "aria-label": `Delete ${session.name}`, onclick: () => ask(session, del) }, "Delete");
  return el("li", { class: "card", "data-id": session.id }, name, el("small"),
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
    replace(sessions.filter((one) => one.id !== session.id));
  } catch (error) {
    complain(error);
  }
}
