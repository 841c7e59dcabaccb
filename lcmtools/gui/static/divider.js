// The dividers between panels, and the sizes of the panels.

import { element } from "./elements.js";
import { total } from "./tree.js";

/** @typedef {import("./tree.js").Split} Split */

const STEP = 0.02; // of a split's size, for an arrow key
const LEAST = 0.05; // of a split's size: the smallest part

/**
 * Create the divider between two parts of a split, which can be dragged or moved by arrow keys.
 * @param {Split} tree
 * @param {number} index of the part before the divider
 * @param {HTMLElement} box
 * @param {() => void} changed
 */
export function divider(tree, index, box, changed) {
  const isRow = tree.split === "row";
  const line = element("div", {
    class: "divider",
    role: "separator",
    tabindex: 0,
    "aria-orientation": isRow ? "vertical" : "horizontal",
    "aria-label": "Divider",
    "aria-valuemin": 0,
    "aria-valuemax": 100,
  });
  /** @param {number} change as a fraction of the split */
  const shift = (change) => {
    const sum = total(tree);
    const [before = 0, after = 0] = tree.sizes.slice(index, index + 2);
    const least = LEAST * sum;
    const moved = Math.max(least - before, Math.min(after - least, change * sum));
    tree.sizes[index] = before + moved;
    tree.sizes[index + 1] = after - moved;
    resize(tree, box);
    changed();
  };
  line.addEventListener("keydown", (event) => {
    const [back, forth] = isRow ? ["ArrowLeft", "ArrowRight"] : ["ArrowUp", "ArrowDown"];
    const step = event.key === forth ? 1 : event.key === back ? -1 : 0;
    if (!step) return;
    event.preventDefault();
    shift(step * STEP);
  });
  /** @param {PointerEvent} event */
  const place = (event) => (isRow ? event.clientX : event.clientY);
  let last = 0;
  line.addEventListener("pointerdown", (event) => {
    line.setPointerCapture(event.pointerId);
    last = place(event);
  });
  line.addEventListener("pointermove", (event) => {
    if (!line.hasPointerCapture(event.pointerId)) return;
    shift((place(event) - last) / (isRow ? box.clientWidth : box.clientHeight));
    last = place(event);
  });
  line.addEventListener("dblclick", () => {
    const sum = (tree.sizes[index] ?? 1) + (tree.sizes[index + 1] ?? 1);
    tree.sizes[index] = tree.sizes[index + 1] = sum / 2;
    shift(0);
  });
  return line;
}

/**
 * Set the sizes of a split's parts.
 * @param {Split} tree
 * @param {HTMLElement} box
 */
export function resize(tree, box) {
  const sum = total(tree);
  let place = 0;
  let until = 0;
  for (const child of box.children) {
    if (!(child instanceof HTMLElement)) continue;
    if (child.className === "cell") {
      const share = (tree.sizes[place++] ?? 1) / sum;
      child.style.flexGrow = String(share * 100);
      until += share;
    } else child.setAttribute("aria-valuenow", String(Math.round(until * 100)));
  }
}
