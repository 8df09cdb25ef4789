/** Ask the service. Errors are sentences; a key is asked for when the service wants one. */

import { byId, sentence } from "./dom.js";

const KEY = "semtopo.key";

/** What the service refused, and why: `body` is its problem (RFC 9457). */
export class Problem extends Error {
  /** @param {number} status @param {Record<string, any>} body */
  constructor(status, body) {
    super(sentence(String(body.detail ?? `the service answered with status ${status}`)));
    this.status = status;
    this.code = String(body.code ?? "");
    this.body = body;
  }
}

/** @returns {Record<string, string>} the header that brings the key, if there is one */
export function credentials() {
  const key = sessionStorage.getItem(KEY);
  return key ? { Authorization: `Bearer ${key}` } : {};
}

/** @type {Promise<void> | null} */
let asking = null;

/** Ask the person for a key, once for all who wait. */
export function askForKey() {
  asking ??= new Promise((resolve) => {
    const dialog = byId("key-dialog");
    dialog.addEventListener("close", () => {
      const key = byId("key").value.trim();
      if (key) sessionStorage.setItem(KEY, key);
      byId("key").value = "";
      asking = null;
      resolve();
    }, { once: true });
    dialog.showModal();
  });
  return asking;
}

/**
 * @param {string} path relative to the page
 * @param {RequestInit} [options]
 * @returns {Promise<Response>}
 */
export async function request(path, options = {}) {
  for (let attempt = 0; ; attempt += 1) {
    const headers = { ...credentials(), ...options.headers };
    let response;
    try {
      response = await fetch(path, { ...options, headers });
    } catch (error) {
      if (error instanceof DOMException) throw error;
      throw new Error("The service does not answer. Is it running?");
    }
    if (response.ok) return response;
    const body = await response.json().catch(() => ({}));
    if (response.status !== 401 || attempt >= 3) throw new Problem(response.status, body);
    await askForKey();
  }
}

/**
 * @param {string} path
 * @param {AbortSignal} [signal]
 * @returns {Promise<any>}
 */
export async function getJson(path, signal) {
  return (await request(path, { signal })).json();
}

/**
 * @param {string} path
 * @param {any} body
 * @param {string} [method]
 * @returns {Promise<any>} the answer; null if it has no body
 */
export async function sendJson(path, body, method = "POST") {
  const response = await request(path, {
    method,
    headers: { "Content-Type": "application/json" },
    body: JSON.stringify(body),
  });
  return response.status === 204 ? null : response.json();
}

/** @param {string} path */
export async function remove(path) {
  await request(path, { method: "DELETE" });
}

/** @param {string} id @param {string} [rest] */
export function sessionPath(id, rest = "") {
  return `sessions/${encodeURIComponent(id)}${rest}`;
}
