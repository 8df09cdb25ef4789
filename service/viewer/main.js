/** Put the page together: the list at `#/`, a session at `#/s/ID`. */

import { Problem } from "./api.js";
import { AskBox } from "./ask.js";
import { showDetails } from "./details.js";
import { byId, complain, el } from "./dom.js";
import { Driver } from "./drive.js";
import { GraphView } from "./graphview.js";
import { MapView } from "./mapview.js";
import { startNewSession, tour } from "./newsession.js";
import { Session } from "./session.js";
import { showList } from "./sessionslist.js";
import { showTables } from "./tables.js";
import { startTheme } from "./theme.js";
import { Timeline } from "./timeline.js";

const LINKS = { waiting: "connecting", live: "live", lost: "reconnecting", gone: "ended" };

/** @type {(() => void) | null} what closes the session that is open */
let closeOpen = null;

/** @param {"list" | "session"} name */
function show(name) {
  byId("list-view").hidden = name !== "list";
  byId("session-view").hidden = name !== "session";
  byId("link").hidden = byId("title").hidden = name !== "session";
}

/** @param {Session} session */
function tellLink(session) {
  const link = /** @type {keyof typeof LINKS} */ (session.state.link);
  byId("link").textContent = LINKS[link];
  byId("link").dataset.link = link;
}

/** @param {Session} session @param {Driver} driver */
function offerTour(session, driver) {
  const button = el("button", { type: "button", id: "tour", class: "primary", onclick: async () => {
    button.remove();
    try {
      session.go(null);
      driver.follow((await tour()).slice(session.state.seq));
    } catch (error) {
      complain(error);
    }
  } }, "Drive the tour");
  byId("drive").before(button);
}

/** @param {string} id @param {string} options */
async function openSession(id, options) {
  show("session");
  const session = new Session(id);
  const driver = new Driver(session);
  const map = new MapView(session, (x, y) => driver.goTo(x, y), (event) => driver.key(event));
  const graph = new GraphView(session);
  const timeline = new Timeline(session);
  new AskBox(session);
  showDetails(session);
  showTables(session);
  session.store.on(["link"], () => tellLink(session));
  session.store.on(["session"], () => {
    byId("title").textContent = session.state.session.name;
    document.title = `${session.state.session.name} \u00b7 semtopo`;
  });
  tellLink(session);
  closeOpen = () => {
    session.close();
    driver.close();
    timeline.close();
    document.getElementById("tour")?.remove();
  };
  try {
    await session.open();
    map.fit();
    graph.fit();
    if (options.includes("tour") && session.state.seq === 0) offerTour(session, driver);
  } catch (error) {
    session.store.set({ link: "gone" });
    complain(error);
    if (error instanceof Problem && error.code === "unknown_session") location.replace("#/");
  }
}

async function route() {
  closeOpen?.();
  closeOpen = null;
  byId("title").textContent = "";
  document.title = "semtopo";
  const [path, options = ""] = location.hash.replace(/^#/, "").split("?");
  const found = /^\/s\/(.+)$/.exec(path);
  if (found) await openSession(decodeURIComponent(found[1]), options);
  else {
    show("list");
    await showList().catch(complain);
  }
}

startTheme();
startNewSession();
addEventListener("hashchange", () => void route());
void route();
