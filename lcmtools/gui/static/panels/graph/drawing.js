// A graph as SVG: the server computes the layout; this draws, pans, zooms and moves the selection.

import { drawing, element, fill, set, write } from "../../elements.js";
import { rateText } from "../../texts.js";
import { PanZoom } from "../panzoom.js";
import { arrow, curve, saveDrawing } from "./svg.js";

/**
 * @typedef {"node" | "program" | "topic" | "service"} Kind
 * @typedef {{key: string, kind: Kind, name: string, rows: string[], tip: string[],
 *   box: [number, number, number, number], pid?: number | null, stale?: string, isTool?: boolean}} Vertex
 * @typedef {{source: string, target: string, relation: string, rate: number | null,
 *   topics: string[], way: [number, number][]}} Edge
 * @typedef {{size: [number, number], groups: {name: string, top: number, bottom: number}[],
 *   vertices: Vertex[], edges: Edge[], counted: string, leftOut: string}} Graph
 * @typedef {"error" | "warning" | "note"} Severity
 * @typedef {{marks: Map<string, Severity>, lit: Set<string> | null, selected: string | null}} Look
 */

const LIMITS = /** @type {[number, number]} */ ([0.08, 2.5]); // of the scale
/** The shapes of the signs by severity, 16 wide around their centre. */
const SHAPES = {
  error: "M-4 -9H4L9 -4V4L4 9H-4L-9 4V-4Z",
  warning: "M0 -9L10 8H-10Z",
  note: "M0 -8A8 8 0 0 1 0 8A8 8 0 0 1 0 -8",
};

/** A drawing of a graph. */
export class GraphDrawing {
  /** @param {(key: string | null) => void} onSelect */
  constructor(onSelect) {
    this.onSelect = onSelect;
    /** @type {Graph | null} */
    this.graph = null;
    /** @type {string | null} */
    this.hovered = null;
    /** @type {Look} */
    this.look = { marks: new Map(), lit: null, selected: null };
    this.bands = drawing("g");
    this.lines = drawing("g");
    this.boxes = drawing("g");
    this.all = drawing("g", {}, this.bands, this.lines, this.boxes);
    this.svg = drawing(
      "svg",
      { class: "graph-drawing", role: "group", "aria-label": "The graph; arrow keys walk along the edges" },
      drawing("defs", {}, arrow("plain"), arrow("lit")),
      this.all,
    );
    this.element = element("div", { class: "graph-view" }, this.svg);
    /** @type {Map<string, SVGGElement>} */
    this.vertices = new Map();
    /** @type {Map<string, SVGGElement>} */
    this.edges = new Map();
    this.view = new PanZoom(this.svg, {
      size: () => ({ width: this.graph?.size[0] ?? 0, height: this.graph?.size[1] ?? 0 }),
      limits: () => LIMITS,
      changed: () => this.place(),
      largestFit: 1.15,
    });
    const { svg } = this;
    svg.addEventListener("click", (event) => {
      if (!this.view.isDragged) this.onSelect(keyOf(event.target));
    });
    svg.addEventListener("pointerover", (event) => this.hover(keyOf(event.target)));
    for (const type of ["pointerleave", "focusout"]) svg.addEventListener(type, () => this.hover(null));
    svg.addEventListener("focusin", (event) => {
      const key = keyOf(event.target);
      this.hover(key);
      const group = this.vertices.get(key ?? "");
      if (group?.matches(":focus-visible")) this.reveal(group);
    });
    svg.addEventListener("keydown", (event) => this.press(event));
  }

  close() {
    this.view.close();
  }

  /** @param {Graph} graph @param {Look} look */
  show(graph, look) {
    const isResized = String(graph.size) !== String(this.graph?.size);
    this.graph = graph;
    this.look = look;
    this.showBands(graph);
    keepOnly(this.vertices, new Set(graph.vertices.map(({ key }) => key)));
    keepOnly(this.edges, new Set(graph.edges.map(edgeKey)));
    for (const vertex of graph.vertices) this.showVertex(vertex);
    for (const edge of graph.edges) this.showEdge(edge);
    this.light();
    this.makeWalkable();
    if (isResized && this.view.isFitted) this.view.fit();
  }

  /** @param {Graph} graph */
  showBands({ groups, size }) {
    const key = JSON.stringify([groups, size]);
    if (this.bands.dataset.key === key) return;
    this.bands.dataset.key = key;
    this.bands.replaceChildren(
      ...groups.flatMap(({ name, top, bottom }) => [
        drawing("rect", { class: "band", x: 6, y: top, width: size[0] - 12, height: bottom - top, rx: 10 }),
        drawing("text", { class: "band-name", x: 18, y: top + 18 }, name),
      ]),
    );
  }

  /** @param {Vertex} vertex */
  showVertex(vertex) {
    const { key, kind, rows, tip, box, stale, isTool } = vertex;
    const [x, y, width, height] = box;
    const state = JSON.stringify([rows, tip, box, stale, isTool]);
    let group = this.vertices.get(key);
    if (!group) {
      group = drawing("g", { tabindex: -1, role: "button", "data-key": key });
      this.vertices.set(key, group);
      this.boxes.append(group);
    }
    set(group, "aria-label", this.spoken(vertex));
    if (group.dataset.state === state) return;
    group.dataset.state = state;
    const isRound = kind === "topic" || kind === "service";
    const middle = x + width / 2;
    const first = y + (height - rows.length * 15) / 2 + 11.5;
    group.setAttribute("class", `vertex is-${kind}${stale ? " is-stale" : ""}${isTool ? " is-tool" : ""}`);
    group.replaceChildren(
      drawing("title", {}, tip.join("\n")),
      drawing("rect", { class: "box", x, y, width, height, rx: isRound ? height / 2 : 6 }),
      kind === "node" ? drawing("rect", { class: "edge-mark", x, y: y + 6, width: 3, height: height - 12, rx: 1.5 }) : "",
      ...rows.map((row, index) =>
        drawing("text", { class: index ? "detail" : "name", x: middle, y: first + 15 * index }, row),
      ),
      drawing("g", { class: "sign", transform: `translate(${x + width - 4} ${y + 2})` }),
    );
  }

  /** @param {Edge} edge */
  showEdge(edge) {
    const key = edgeKey(edge);
    let group = this.edges.get(key);
    if (!group) {
      group = drawing("g", {}, drawing("path"), drawing("text"));
      this.edges.set(key, group);
      this.lines.append(group);
    }
    const [path, text] = /** @type {[SVGPathElement, SVGTextElement]} */ ([...group.children]);
    const { rate, topics } = edge;
    const isSilent = rate === 0;
    group.setAttribute("class", `edge is-${edge.relation}${isSilent ? " is-silent" : ""}`);
    set(path, "d", curve(edge.way));
    const width = 1.2 + (rate ? Math.min(1.6, Math.log10(1 + rate) * 0.8) : 0);
    set(path, "stroke-width", width.toFixed(2));
    const to = edge.way.at(-1);
    const carried = topics.length > 1 ? `${topics[0]} +${topics.length - 1}` : topics.join();
    write(text, rate === null ? carried : rate ? rateText(rate) : "");
    if (to) {
      set(text, "x", to[0] - 13);
      set(text, "y", to[1] - 5);
    }
  }

  /** Highlight search results, or the neighbours of the selected vertex. */
  light() {
    const { marks, lit, selected } = this.look;
    const focus = this.hovered ?? selected;
    const near = focus ? this.near(focus) : null;
    for (const [key, group] of this.vertices) {
      const isLit = near ? near.has(key) : lit ? lit.has(key) : true;
      group.classList.toggle("is-dimmed", !isLit);
      group.classList.toggle("is-selected", key === selected);
      set(group, "aria-pressed", String(key === selected));
      const severity = marks.get(key);
      const sign = group.querySelector(".sign");
      if (!sign || sign.getAttribute("data-severity") === (severity ?? null)) continue;
      set(sign, "data-severity", severity ?? null);
      set(sign, "class", severity ? `sign is-${severity}` : "sign");
      const y = severity === "warning" ? 6 : 4;
      const text = drawing("text", { y }, severity === "note" ? "i" : "!");
      fill(sign, severity ? [drawing("path", { d: SHAPES[severity] }), text] : null);
    }
    for (const edge of this.graph?.edges ?? []) {
      const { source, target } = edge;
      const group = this.edges.get(edgeKey(edge));
      const isNear = focus === source || focus === target;
      const isLit = near ? isNear : lit ? lit.has(source) && lit.has(target) : true;
      group?.classList.toggle("is-dimmed", !isLit);
      group?.classList.toggle("is-lit", Boolean(near) && isNear);
    }
  }

  /** @param {string} key */
  near(key) {
    const found = new Set([key]);
    for (const { source, target } of this.graph?.edges ?? []) {
      if (source === key) found.add(target);
      if (target === key) found.add(source);
    }
    return found;
  }

  /** @param {Vertex} vertex */
  spoken({ kind, rows, stale, key }) {
    const severity = this.look.marks.get(key);
    const found = severity ? `, ${severity} of wtf` : "";
    return `${kind} ${rows.join(", ")}${stale ? ", stale" : ""}${found}`;
  }

  /** Make one vertex reachable by the Tab key; arrow keys move from there. */
  makeWalkable() {
    const groups = [...this.vertices.values()];
    const active = groups.find((group) => group === document.activeElement || group.tabIndex === 0) ?? groups[0];
    for (const group of groups) group.setAttribute("tabindex", group === active ? "0" : "-1");
  }

  /** @param {string | null} key */
  hover(key) {
    if (key === this.hovered || this.view.pointers.size) return;
    this.hovered = key;
    this.light();
  }

  place() {
    const { left, top, scale } = this.view;
    set(this.all, "transform", `translate(${left.toFixed(1)} ${top.toFixed(1)}) scale(${scale.toFixed(4)})`);
    this.svg.classList.toggle("is-small", scale < 0.45);
  }

  /** @param {SVGGElement} group */
  reveal(group) {
    const [box, view] = [group.getBoundingClientRect(), this.svg.getBoundingClientRect()];
    const right = Math.max(0, box.right - view.right + 10) || Math.min(0, box.left - view.left - 10);
    const low = Math.max(0, box.bottom - view.bottom + 10) || Math.min(0, box.top - view.top - 10);
    if (right || low) this.view.shift(-right, -low);
  }

  /** @param {KeyboardEvent} event */
  press(event) {
    const key = keyOf(event.target);
    if (key && (event.key === "Enter" || event.key === " ")) this.onSelect(key);
    else if (key && event.key.startsWith("Arrow")) this.walk(key, event.key.slice(5));
    else return;
    event.preventDefault();
  }

  /**
   * Select the nearest vertex in a direction, preferably along an edge.
   * @param {string} key
   * @param {string} direction
   */
  walk(key, direction) {
    const vertices = this.graph?.vertices ?? [];
    const here = vertices.find((vertex) => vertex.key === key)?.box;
    if (!here) return;
    const near = this.near(key);
    const dx = Number(direction === "Right") - Number(direction === "Left");
    const dy = Number(direction === "Down") - Number(direction === "Up");
    let best = null;
    let least = Infinity;
    for (const { key: other, box } of vertices) {
      const right = box[0] + box[2] / 2 - here[0] - here[2] / 2;
      const down = box[1] + box[3] / 2 - here[1] - here[3] / 2;
      const along = right * dx + down * dy;
      const across = Math.abs(right * dy) + Math.abs(down * dx);
      if (other === key || along < 5) continue;
      const isFar = dx !== 0 && !near.has(other);
      const cost = along + 2 * across + (isFar ? 1e5 : 0);
      if (cost < least) [best, least] = [other, cost];
    }
    const group = best && this.vertices.get(best);
    if (!group) return;
    this.vertices.get(key)?.setAttribute("tabindex", "-1");
    group.setAttribute("tabindex", "0");
    group.focus();
  }

  /** Save the drawing, with its colours, as a file. @param {string} name */
  save(name) {
    if (this.graph) saveDrawing(this.svg, this.graph.size, getComputedStyle(this.element).backgroundColor, name);
  }
}

/**
 * Remove elements whose keys no longer exist.
 * @param {Map<string, Element>} elements
 * @param {Set<string>} keys
 */
function keepOnly(elements, keys) {
  for (const [key, one] of [...elements]) {
    if (keys.has(key)) continue;
    one.remove();
    elements.delete(key);
  }
}

/** @param {Pick<Edge, "source" | "target" | "relation">} edge */
function edgeKey({ source, target, relation }) {
  return `${source} ${relation} ${target}`;
}

/** @param {EventTarget | null} target */
function keyOf(target) {
  const group = target instanceof Element ? target.closest("[data-key]") : null;
  return group?.getAttribute("data-key") ?? null;
}
