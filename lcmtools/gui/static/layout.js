// The layout of panels on the page: rows, columns and dividers between them.

import { divider, resize } from "./divider.js";
import { element } from "./elements.js";
import { Frame } from "./frame.js";
import { PANELS } from "./panels/index.js";
import { beside, checked, isSplit, leaves, without } from "./tree.js";

const FAR = 6; // [px] before a press becomes a drag

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
    this.marker = element("div", { class: "drop-marker", hidden: true });
    this.element = element("main", { class: "layout" });
  }

  /**
   * Show another layout.
   * @param {any} value
   */
  show(value) {
    for (const frame of this.frames.values()) frame.close();
    this.frames.clear();
    this.large = null;
    this.arrange(checked(value, (panel) => panel in PANELS));
  }

  /** Return the layout with the settings of its panels, as plain values. */
  kept() {
    /** @type {(tree: Tree) => Tree} */
    const copy = (tree) =>
      isSplit(tree)
        ? { ...tree, parts: tree.parts.map(copy), sizes: tree.sizes.map(round) }
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
    /** @type {Leaf} */
    const leaf = { panel, settings };
    this.enlarge(null);
    if (!this.tree) this.arrange(leaf);
    else {
      const target = near ?? this.largest();
      const box = this.frames.get(target)?.element.getBoundingClientRect();
      const side = box && box.height > box.width * 0.8 ? "down" : "right";
      this.arrange(beside(this.tree, target, leaf, side));
    }
    this.frames.get(leaf)?.element.focus();
    this.page.announce(`${PANELS[panel]?.title} added`);
    this.page.changed();
  }

  /** @param {Leaf} leaf */
  remove(leaf) {
    const frame = this.frames.get(leaf);
    this.enlarge(null);
    this.arrange(this.tree && without(this.tree, leaf));
    this.page.announce(`${frame?.kind.title} closed`);
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

  /** Return the panel with the largest area. */
  largest() {
    /** @type {(leaf: Leaf) => number} */
    const area = (leaf) => {
      const box = this.frames.get(leaf)?.element.getBoundingClientRect();
      return box ? box.width * box.height : 0;
    };
    return /** @type {Leaf} */ (leaves(this.tree).sort((a, b) => area(b) - area(a))[0]);
  }

  /**
   * Return a panel's neighbour on a side.
   * @param {Leaf} leaf
   * @param {Side} side
   */
  neighbour(leaf, side) {
    const from = this.frames.get(leaf)?.element.getBoundingClientRect();
    if (!from) return undefined;
    /** @type {(leaf: Leaf) => {gap: number, shared: number}} */
    const place = (other) => {
      const box = /** @type {Frame} */ (this.frames.get(other)).element.getBoundingClientRect();
      const gaps = {
        left: from.left - box.right,
        right: box.left - from.right,
        up: from.top - box.bottom,
        down: box.top - from.bottom,
      };
      const isAcross = side === "left" || side === "right";
      const shared = isAcross
        ? Math.min(from.bottom, box.bottom) - Math.max(from.top, box.top)
        : Math.min(from.right, box.right) - Math.max(from.left, box.left);
      return { gap: gaps[side], shared };
    };
    const others = leaves(this.tree).filter((one) => one !== leaf);
    const found = others.filter((one) => place(one).gap > -2 && place(one).shared > 0);
    return found.sort((a, b) => place(a).gap - place(b).gap || place(b).shared - place(a).shared)[0];
  }

  /**
   * Lay out the panels by a tree; panels that remain keep their content.
   * @param {Tree | null} tree
   */
  arrange(tree) {
    this.tree = tree;
    const present = new Set(leaves(tree));
    for (const [leaf, frame] of [...this.frames]) {
      if (present.has(leaf)) continue;
      frame.close();
      this.frames.delete(leaf);
    }
    for (const leaf of present) {
      if (!this.frames.has(leaf)) this.frames.set(leaf, new Frame(this.connection, leaf, this.owner()));
    }
    this.element.replaceChildren(tree ? this.draw(tree) : this.empty(), this.marker);
  }

  /** @returns {import("./frame.js").Owner} */
  owner() {
    return {
      changed: this.page.changed,
      announce: this.page.announce,
      add: (panel, settings, near) => this.add(panel, settings, near),
      remove: (leaf) => this.remove(leaf),
      move: (leaf, side) => this.move(leaf, side),
      enlarge: (leaf) => this.enlarge(leaf),
      isAlone: (leaf) => this.tree === leaf,
      drag: (leaf, event) => this.drag(leaf, event),
    };
  }

  empty() {
    return element("p", { class: "empty" }, "No panel is open. Add one at the top.");
  }

  /**
   * @param {Tree} tree
   * @returns {HTMLElement}
   */
  draw(tree) {
    if (!isSplit(tree)) return /** @type {Frame} */ (this.frames.get(tree)).element;
    const box = element("div", { class: `split ${tree.split}` });
    tree.parts.forEach((part, index) => {
      if (index) box.append(divider(tree, index - 1, box, this.page.changed));
      const cell = element("div", { class: "cell" }, this.draw(part));
      box.append(cell);
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
    header.setPointerCapture(event.pointerId);
    /** @param {PointerEvent} moved */
    const follow = (moved) => {
      const far = Math.hypot(moved.clientX - event.clientX, moved.clientY - event.clientY);
      isDragged ||= far > FAR;
      if (!isDragged) return;
      target = this.dropAt(leaf, moved.clientX, moved.clientY);
      this.mark(target);
    };
    /** @param {Event} ended */
    const end = (ended) => {
      header.removeEventListener("pointermove", follow);
      this.mark(null);
      const left = this.tree && without(this.tree, leaf);
      if (ended.type !== "pointerup" || !target || !left) return;
      this.arrange(beside(left, target.leaf, leaf, target.side));
      this.page.changed();
    };
    header.addEventListener("pointermove", follow);
    header.addEventListener("pointerup", end, { once: true });
    header.addEventListener("pointercancel", end, { once: true });
  }

  /**
   * Return the target of a dragged panel: the panel under the pointer, and its nearest side.
   * @param {Leaf} dragged
   * @param {number} x
   * @param {number} y
   * @returns {{leaf: Leaf, side: Side} | null}
   */
  dropAt(dragged, x, y) {
    for (const [leaf, frame] of this.frames) {
      const box = frame.element.getBoundingClientRect();
      const [across, down] = [(x - box.left) / box.width, (y - box.top) / box.height];
      if (leaf === dragged || across < 0 || across > 1 || down < 0 || down > 1) continue;
      /** @type {[Side, number][]} */
      const sides = [
        ["left", across],
        ["right", 1 - across],
        ["up", down],
        ["down", 1 - down],
      ];
      const [nearest] = sides.sort((a, b) => a[1] - b[1]);
      return nearest ? { leaf, side: nearest[0] } : null;
    }
    return null;
  }

  /** @param {{leaf: Leaf, side: Side} | null} target */
  mark(target) {
    this.marker.hidden = !target;
    const box = target && this.frames.get(target.leaf)?.element.getBoundingClientRect();
    if (!target || !box) return;
    const all = this.element.getBoundingClientRect();
    const isAcross = target.side === "left" || target.side === "right";
    const [width, height] = isAcross ? [box.width / 2, box.height] : [box.width, box.height / 2];
    const x = box.left - all.left + (target.side === "right" ? width : 0);
    const y = box.top - all.top + (target.side === "down" ? height : 0);
    Object.assign(this.marker.style, {
      left: `${x}px`,
      top: `${y}px`,
      width: `${width}px`,
      height: `${height}px`,
    });
  }
}

/** @param {number} value */
function round(value) {
  return Math.round(value * 1000) / 1000;
}
