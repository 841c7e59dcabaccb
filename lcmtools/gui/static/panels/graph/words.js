// The texts of the graph: a vertex's connections, and wtf's findings.

import { element } from "../../elements.js";

/**
 * @typedef {import("./drawing.js").Graph} Graph
 * @typedef {import("./drawing.js").Vertex} Vertex
 * @typedef {{rule: string, severity: "error" | "warning" | "note", text: string, items: string[],
 *   remedies: string[], subjects: {kind: string, name: string, pid: number | null}[]}} Finding
 */

export const SIGNS = { error: "✖", warning: "▲", note: "●" };

/**
 * Return true if a finding's subject is this vertex.
 * @param {Vertex} vertex
 * @param {{kind: string, name: string, pid: number | null}} subject
 */
export function isMeant(vertex, { kind, name, pid }) {
  if (kind === "topic") return vertex.kind === "topic" && vertex.name === name;
  if (vertex.kind === "node") return vertex.name === name;
  return vertex.kind === "program" && pid !== null && vertex.pid === pid;
}

/**
 * Return a line for each connection into and out of a vertex.
 * @param {Graph} graph
 * @param {Vertex} vertex
 */
export function sides(graph, vertex) {
  const names = new Map(graph.vertices.map(({ key, rows }) => [key, rows[0] ?? ""]));
  const words = /** @type {Record<string, [string, string]>} */ ({
    publishes: ["publishes", "published by"],
    subscribes: ["subscribes to", "subscribed to by"],
    calls: ["calls", "called by"],
    serves: ["serves", "served by"],
    feeds: ["feeds", "fed by"],
  });
  return graph.edges.flatMap(({ source, target, relation, rate, topics }) => {
    if (source !== vertex.key && target !== vertex.key) return [];
    const isMember = vertex.kind === "node" || vertex.kind === "program";
    const isOwn = relation === "feeds" ? source === vertex.key : isMember;
    const other = names.get(source === vertex.key ? target : source);
    const [own, others] = words[relation] ?? [relation, relation];
    const flow = rate === null ? "" : `, ${rate ? `${rate} Hz` : "silent"}`;
    const over = topics.length ? ` over ${topics.join(", ")}` : "";
    return [`${isOwn ? own : others} ${other}${flow}${over}`];
  });
}

/** @param {string} text */
export function sentence(text) {
  return text.replace(/:$/, "");
}

/** @param {Finding} finding */
export function findingText({ severity, text, items, remedies }) {
  return element(
    "section",
    { class: `finding is-${severity}` },
    element("h3", {}, element("span", { class: "sign", "aria-hidden": "true" }, SIGNS[severity]), ` ${severity}: ${sentence(text)}`),
    items.length ? element("ul", {}, items.map((item) => element("li", { class: item.endsWith(":") ? "is-head" : null }, item))) : null,
    remedies.map((remedy) => element("p", { class: "remedy" }, `→ ${remedy}`)),
  );
}
