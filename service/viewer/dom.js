/** Build elements. Text is only ever set as text: labels come from anyone. */

/**
 * @template {keyof HTMLElementTagNameMap} K
 * @param {K} name
 * @param {Record<string, any>} [properties] attributes; `class`, `on...` listeners, or properties
 * @param {...(Node | string | null | undefined)} children
 * @returns {HTMLElementTagNameMap[K]}
 */
export function el(name, properties = {}, ...children) {
  const element = document.createElement(name);
  for (const [key, value] of Object.entries(properties)) {
    if (value === undefined || value === null || value === false) continue;
    if (key.startsWith("on")) element.addEventListener(key.slice(2), value);
    else element.setAttribute(key, value === true ? "" : String(value));
  }
  element.append(...children.filter((child) => child !== null && child !== undefined));
  return element;
}

/**
 * @param {string} id
 * @returns {any} the element of that id, which index.html has
 */
export function byId(id) {
  const found = document.getElementById(id);
  if (!found) throw new Error(`index.html has no #${id}`);
  return found;
}

/**
 * Show an error as a sentence, until it is closed or some time has passed.
 * @param {unknown} error
 */
export function complain(error) {
  if (error instanceof DOMException && error.name === "AbortError") return;
  const words = error instanceof Error ? error.message : String(error);
  const notices = byId("notices");
  for (const shown of notices.children) if (shown.dataset.words === words) shown.remove();
  const close = el("button", { type: "button", "aria-label": "Close", onclick: () => notice.remove() }, "\u00d7");
  const notice = el("div", { class: "notice" }, el("p", {}, words), close);
  notice.dataset.words = words;
  notices.append(notice);
  setTimeout(() => notice.remove(), 12_000);
}

/** @param {string} text @returns {string} a sentence, with a capital and a full stop */
export function sentence(text) {
  const whole = text.charAt(0).toUpperCase() + text.slice(1);
  return /[.?!]$/.test(whole) ? whole : `${whole}.`;
}

/** @param {number} value @param {number} [digits] */
export function fixed(value, digits = 2) {
  return value.toFixed(digits).replace("-", "\u2212");
}

/** @param {number} count @param {string} one */
export function counted(count, one) {
  return `${count.toLocaleString("en")} ${one}${count === 1 ? "" : "s"}`;
}
