// The layout of panels on the page: rows, columns and dividers between them.

import { divider, resize } from "./divider.js";
import { div, element, set } from "./elements.js";
import { Frame, SIDES } from "./frame.js";
import { PANELS } from "./panels/index.js";
import { areEqual, beside, checked, copied, isSplit, leaves, without } from "./tree.js";

const HIGH = 360; // [px] of a panel that can be divided into an upper and a lower one
const FAR = 6; // [px] before a press becomes a drag
const BEYOND = 16; // [px] from a panel into its neighbour
const MOST_UNDONE = 30; // changes that can be undone

/**
 * @typedef {import("./tree.js").Leaf} Leaf
 * @typedef {import("./tree.js").Split} Split
 * @typedef {import("./tree.js").Tree} Tree
 * @typedef {import("./tree.js").Side} Side
 */

/** The panels of a page. */
export class Layout {
  /**
   * @param {import("./connection.js").Connection} connection
   * @param {{changed: () => void, announce: (text: string) => void}} page
   */
  constructor(connection, page) {
    this.connection = connection;
    this.page = page;
    /** @type {Tree | null} */
    this.tree = null;
    /** @type {Map<Leaf, Frame>} */
    this.frames = new Map();
    /** @type {Leaf | null} */
    this.large = null;
    /** The arrangements before the latest changes. @type {(Tree | null)[]} */
    this.past = [];
    /** The arrangement when it was last remembered; undefined before. @type {Tree | null | undefined} */
    this.present = undefined;
    this.element = element("main", { class: "layout" });
  }

  /**
   * Show another layout.
   * @param {any} value
   */
  show(value) {
    this.arrange(checked(value, (panel) => panel in PANELS));
  }

  /** Remember the arrangement before a change, so that it can be undone. */
  remember() {
    if (areEqual(this.tree, this.present)) return;
    if (this.present !== undefined) this.past = [...this.past, this.present].slice(-MOST_UNDONE);
    this.present = copied(this.tree);
  }

  /** Undo the latest change of the arrangement; return false if there is none. */
  undo() {
    const before = this.past.pop();
    if (before === undefined) return false;
    this.present = before;
    this.arrange(copied(before));
    return true;
  }

  /** Return the layout with the settings of its panels, as plain values. */
  kept() {
    /** @type {(tree: Tree) => Tree} */
    const copy = (tree) =>
      isSplit(tree)
        ? { ...tree, parts: tree.parts.map(copy), sizes: tree.sizes.map((size) => Number(size.toFixed(3))) }
        : { panel: tree.panel, settings: this.frames.get(tree)?.settings() ?? tree.settings };
    return this.tree && copy(this.tree);
  }

  /**
   * Add a panel next to another one, or at the right edge.
   * @param {string} panel
   * @param {object} settings
   * @param {Leaf} [near]
   */
  add(panel, settings, near) {
    const leaf = { panel, settings };
    this.enlarge(null);
    if (!this.tree) this.arrange(leaf);
    else {
      const wide = PANELS[panel]?.isWide && this.largest(({ width, height }) => (height > HIGH ? width : 0));
      const target = wide || near || /** @type {Leaf} */ (this.largest(({ width, height }) => width * height));
      const box = this.frames.get(target)?.element.getBoundingClientRect();
      const side = wide || (box && box.height > box.width * 0.8) ? "down" : "right";
      this.arrange(beside(this.tree, target, leaf, side));
    }
    this.frames.get(leaf)?.element.focus();
    this.page.announce(`${PANELS[panel]?.title} added`);
    this.page.changed();
  }

  /** @param {Leaf} leaf */
  remove(leaf) {
    this.arrange(this.tree && without(this.tree, leaf));
    this.page.announce(`${PANELS[leaf.panel]?.title} closed`);
    this.page.changed();
  }

  /**
   * Move a panel past its neighbour on a side, or to the edge of the page.
   * @param {Leaf} leaf
   * @param {Side} side
   */
  move(leaf, side) {
    const left = this.tree && without(this.tree, leaf);
    if (!left) return;
    this.enlarge(null);
    this.arrange(beside(left, this.neighbour(leaf, side) ?? left, leaf, side));
    this.frames.get(leaf)?.element.focus();
    this.page.announce(`${PANELS[leaf.panel]?.title} moved ${side}`);
    this.page.changed();
  }

  /** @param {Leaf | null} leaf */
  enlarge(leaf) {
    this.large = leaf === this.large ? null : leaf;
    for (const [one, frame] of this.frames) frame.setLarge(one === this.large);
    this.element.classList.toggle("has-large", this.large !== null);
  }

  /**
   * Return the panel of which a measure is largest; undefined if it is 0 for all.
   * @param {(box: DOMRect) => number} measure
   */
  largest(measure) {
    const sizes = [...this.frames].map(([leaf, frame]) => ({ leaf, size: measure(frame.element.getBoundingClientRect()) }));
    const [first] = sizes.sort((a, b) => b.size - a.size);
    return first?.size ? first.leaf : undefined;
  }

  /**
   * Return the panel beyond a side of another one; undefined at the edge of the page.
   * @param {Leaf} leaf
   * @param {Side} side
   */
  neighbour(leaf, side) {
    const box = this.frames.get(leaf)?.element.getBoundingClientRect();
    if (!box) return undefined;
    for (const share of [0.5, 0.25, 0.75]) {
      const [x, y] = [box.left + share * box.width, box.top + share * box.height];
      const places = { left: [box.left - BEYOND, y], right: [box.right + BEYOND, y], up: [x, box.top - BEYOND], down: [x, box.bottom + BEYOND] };
      const found = this.leafAt(.../** @type {[number, number]} */ (places[side]));
      if (found) return found;
    }
    return undefined;
  }

  /** @param {number} x @param {number} y */
  leafAt(x, y) {
    const panel = document.elementFromPoint(x, y)?.closest(".panel");
    return leaves(this.tree).find((leaf) => this.frames.get(leaf)?.element === panel);
  }

  /**
   * Lay out the panels by a tree; panels that remain keep their content.
   * @param {Tree | null} tree
   */
  arrange(tree) {
    this.enlarge(null);
    this.tree = tree;
    const present = new Set(leaves(tree));
    for (const [leaf, frame] of [...this.frames]) {
      if (present.has(leaf)) continue;
      leaf.settings = frame.settings(); // with which it comes back if this is undone
      frame.close();
      this.frames.delete(leaf);
    }
    for (const leaf of present) {
      if (!this.frames.has(leaf)) this.frames.set(leaf, new Frame(this, leaf));
    }
    const empty = element("p", { class: "empty" }, "No panel is open. Add one at the top.");
    this.element.replaceChildren(tree ? this.draw(tree) : empty);
  }

  /** @param {Tree} tree @returns {HTMLElement} */
  draw(tree) {
    if (!isSplit(tree)) return /** @type {Frame} */ (this.frames.get(tree)).element;
    const box = div(`split ${tree.split}`);
    tree.parts.forEach((part, index) => {
      if (index) box.append(divider(tree, index - 1, box, this.page.changed));
      box.append(div("cell", this.draw(part)));
    });
    resize(tree, box);
    return box;
  }

  /**
   * Drag a panel by its header to a side of another panel.
   * @param {Leaf} leaf
   * @param {PointerEvent} event
   */
  drag(leaf, event) {
    const header = /** @type {HTMLElement} */ (event.currentTarget);
    if (event.button || this.large || /** @type {Element} */ (event.target).closest("button")) return;
    if (matchMedia("(max-width: 700px)").matches) return; // dragging scrolls there
    /** @type {{leaf: Leaf, side: Side} | null} */
    let target = null;
    let isDragged = false;
    const ends = new AbortController();
    header.setPointerCapture(event.pointerId);
    /** @param {PointerEvent} moved */
    const follow = ({ clientX, clientY }) => {
      isDragged ||= Math.hypot(clientX - event.clientX, clientY - event.clientY) > FAR;
      if (!isDragged) return;
      target = this.dropAt(leaf, clientX, clientY);
      this.mark(target);
    };
    /** @param {Event} ended */
    const end = (ended) => {
      ends.abort();
      this.mark(null);
      const left = this.tree && without(this.tree, leaf);
      if (ended.type !== "pointerup" || !target || !left) return;
      this.arrange(beside(left, target.leaf, leaf, target.side));
      this.page.changed();
    };
    header.addEventListener("pointermove", follow, ends);
    for (const name of ["pointerup", "pointercancel"]) header.addEventListener(name, end, ends);
  }

  /**
   * Return the target of a dragged panel: the panel under the pointer, and its nearest side.
   * @param {Leaf} dragged
   * @param {number} x
   * @param {number} y
   * @returns {{leaf: Leaf, side: Side} | null}
   */
  dropAt(dragged, x, y) {
    const leaf = this.leafAt(x, y);
    const box = leaf && leaf !== dragged && this.frames.get(leaf)?.element.getBoundingClientRect();
    if (!box) return null;
    const [across, down] = [(x - box.left) / box.width, (y - box.top) / box.height];
    const ways = { left: across, right: 1 - across, up: down, down: 1 - down };
    const side = SIDES.reduce((best, one) => (ways[one] < ways[best] ? one : best));
    return { leaf, side };
  }

  /** @param {{leaf: Leaf, side: Side} | null} target */
  mark(target) {
    for (const [leaf, { element: panel }] of this.frames) set(panel, "data-drop", leaf === target?.leaf ? target.side : null);
  }
}
