/**
 * Follow server-sent events with `fetch`, which can send a key where EventSource cannot.
 * A stream that breaks is taken up again after the last event.
 */

import { askForKey, credentials } from "./api.js";

const PAUSE_MAX_MS = 10_000;
const SILENCE_MS = 40_000; // the service sends a heartbeat at least each 15 s

/**
 * @typedef {object} Follower
 * @property {(event: string, data: any, id: string) => void} told
 * @property {(link: "live" | "lost") => void} link
 * @property {() => void} outdated the last id is none of the session's; read it anew
 */

/**
 * Split what comes in into events.
 * @param {(event: string, data: string, id: string) => void} told
 * @param {string} id the last id that is known
 */
export function eventParser(told, id) {
  let rest = "";
  let event = "";
  /** @type {string[]} */
  let data = [];
  /** @param {string} line */
  function take(line) {
    if (line === "") {
      if (data.length > 0) told(event || "message", data.join("\n"), id);
      event = "";
      data = [];
      return;
    }
    const colon = line.indexOf(":");
    if (colon === 0) return; // a heartbeat
    const name = colon < 0 ? line : line.slice(0, colon);
    const value = colon < 0 ? "" : line.slice(colon + 1).replace(/^ /, "");
    if (name === "data") data.push(value);
    else if (name === "event") event = value;
    else if (name === "id") id = value;
  }
  return {
    /** @param {string} text */
    feed(text) {
      const lines = (rest + text).split("\n");
      rest = lines.pop() ?? "";
      for (const line of lines) take(line.replace(/\r$/, ""));
      return id;
    },
  };
}

/**
 * @param {string} path of the events
 * @param {number} seq the last step that is known
 * @param {Follower} follower
 * @returns {() => void} what ends it
 */
export function follow(path, seq, follower) {
  const ended = new AbortController();
  let id = String(seq);
  let pause = 500;

  async function read() {
    const silence = new AbortController();
    const signal = AbortSignal.any([ended.signal, silence.signal]);
    let timer = setTimeout(() => silence.abort(), SILENCE_MS);
    try {
      const headers = { ...credentials(), "Last-Event-ID": id };
      const response = await fetch(path, { headers, signal, cache: "no-store" });
      if (response.status === 404) return follower.outdated();
      if (response.status === 401) return askForKey();
      if (!response.ok || !response.body) return undefined;
      follower.link("live");
      pause = 500;
      const parser = eventParser((event, data, at) => follower.told(event, JSON.parse(data), at), id);
      const text = response.body.pipeThrough(new TextDecoderStream()).getReader();
      for (let piece = await text.read(); !piece.done; piece = await text.read()) {
        clearTimeout(timer);
        timer = setTimeout(() => silence.abort(), SILENCE_MS);
        id = parser.feed(piece.value);
      }
    } catch {
      // the line broke, or nothing was heard for too long: it is taken up again below
    } finally {
      clearTimeout(timer);
    }
    return undefined;
  }

  async function keepReading() {
    while (!ended.signal.aborted) {
      await read();
      if (ended.signal.aborted) return;
      follower.link("lost");
      await new Promise((resolve) => setTimeout(resolve, pause * (0.75 + Math.random() / 2)));
      pause = Math.min(2 * pause, PAUSE_MAX_MS);
    }
  }

  void keepReading();
  return () => ended.abort();
}
