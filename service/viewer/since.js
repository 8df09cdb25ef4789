/** What changed since a step, added to what was known then: a map of a thousand zones is read once. */

import { Problem } from "./api.js";
import { graphOf } from "./model.js";

/**
 * Read what changed.
 * @param {(rest: string, signal?: AbortSignal) => Promise<any>} get
 * @param {string} rest of the path, with the step in its query @param {AbortSignal} [signal]
 * @returns {Promise<any>} nothing where the log has no such step: somebody put another one there
 */
export async function changed(get, rest, signal) {
  try {
    return await get(rest, signal);
  } catch (error) {
    if (error instanceof Problem && error.code === "unknown_step") return null;
    throw error;
  }
}

/**
 * Add what changed to what was known: it keeps its place, and what is new comes last.
 * @template T
 * @param {T[]} known @param {T[]} news @param {(one: T) => string} name @param {number} total of what is there now
 * @returns {T[] | null} nothing if some of what was known is gone: then all must be read
 */
export function added(known, news, name, total) {
  const left = new Map(news.map((one) => [name(one), one]));
  const all = known.map((one) => {
    const found = left.get(name(one));
    if (found) left.delete(name(one));
    return found ?? one;
  });
  all.push(...left.values());
  return all.length === total ? all : null;
}

/** @param {import("./model.js").Graph} known @param {any} body of /graph, with `since` @returns {import("./model.js").Graph | null} as `added` */
export function graphAfter(known, body) {
  const news = graphOf(body);
  const nodes = added(known.nodes, news.nodes, (node) => node.id, body.total.nodes);
  const edges = added(known.edges, news.edges, (edge) => edge.key, body.total.edges);
  return nodes && edges && { seq: body.seq, nodes, edges, closed: new Set([...known.closed, ...news.closed]) };
}
