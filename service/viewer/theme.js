/** Light or dark: as the system has it, until somebody chooses. */

import { byId } from "./dom.js";

const KEY = "semtopo.theme";
const system = matchMedia("(prefers-color-scheme: dark)");
/** @type {Set<() => void>} */
const listeners = new Set();

/** @returns {"system" | "light" | "dark"} */
function chosen() {
  const kept = localStorage.getItem(KEY);
  return kept === "light" || kept === "dark" ? kept : "system";
}

export function isDark() {
  return document.documentElement.dataset.theme === "dark";
}

/** @param {() => void} listener called after the colours have changed */
export function onTheme(listener) {
  listeners.add(listener);
}

function apply() {
  const choice = chosen();
  const dark = choice === "system" ? system.matches : choice === "dark";
  document.documentElement.dataset.theme = dark ? "dark" : "light";
  const button = byId("theme");
  button.dataset.choice = choice;
  byId("theme-name").textContent = { system: "Auto", light: "Light", dark: "Dark" }[choice];
  button.setAttribute("aria-label", `Colours: ${choice === "system" ? "as the system" : choice}`);
  for (const listener of listeners) listener();
}

export function startTheme() {
  system.addEventListener("change", apply);
  byId("theme").addEventListener("click", () => {
    const order = /** @type {const} */ (["system", "light", "dark"]);
    const next = order[(order.indexOf(chosen()) + 1) % order.length];
    if (next === "system") localStorage.removeItem(KEY);
    else localStorage.setItem(KEY, next);
    apply();
  });
  apply();
}
