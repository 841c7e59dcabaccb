// SVG parts of the graph's drawing, and saving it as a file.

import { drawing, set } from "../../elements.js";
import { saveFile } from "../save.js";

/** The style properties that are copied into a saved drawing. */
const KEPT = ["fill", "stroke", "stroke-width", "stroke-dasharray", "opacity", "font", "text-anchor", "paint-order"];

/** Create the head of an arrow, which edges refer to by its id. @param {"plain" | "lit"} name */
export function arrow(name) {
  const place = { viewBox: "0 0 10 10", refX: 9, refY: 5, markerWidth: 8, markerHeight: 8, orient: "auto" };
  const head = drawing("path", { d: "M0 1L9 5L0 9Z", class: `arrow is-${name}` });
  return drawing("marker", { id: `arrow-${name}`, markerUnits: "userSpaceOnUse", ...place }, head);
}

/**
 * Return a smooth path through points, horizontal at each of them.
 * @param {[number, number][]} way
 */
export function curve(way) {
  const [first, ...others] = way;
  if (!first) return "";
  let [x, y] = first;
  let path = `M${x} ${y}`;
  others.forEach(([u, v], index) => {
    const bend = (u - x) / 2;
    path += index % 2 && others.length > 1 && v === y ? `L${u} ${v}` : `C${x + bend} ${y} ${u - bend} ${v} ${u} ${v}`;
    [x, y] = [u, v];
  });
  return path;
}

/**
 * Save a drawing, with its colours, as a file.
 * @param {SVGSVGElement} svg
 * @param {[number, number]} size
 * @param {string} background
 * @param {string} name
 */
export function saveDrawing(svg, [width, height], background, name) {
  const copy = /** @type {SVGSVGElement} */ (svg.cloneNode(true));
  const [originals, copies] = [svg.querySelectorAll("*"), copy.querySelectorAll("*")];
  originals.forEach((original, index) => {
    const style = getComputedStyle(original);
    for (const property of KEPT) {
      if (original instanceof SVGGraphicsElement || original.closest("marker")) {
        copies[index]?.setAttribute(property, style.getPropertyValue(property));
      }
    }
  });
  copy.querySelector("g")?.removeAttribute("transform");
  for (const [attribute, value] of Object.entries({ xmlns: "http://www.w3.org/2000/svg", viewBox: `0 0 ${width} ${height}`, width, height })) {
    set(copy, attribute, value);
  }
  copy.insertBefore(drawing("rect", { width: "100%", height: "100%", fill: background }), copy.querySelector("g"));
  const text = new XMLSerializer().serializeToString(copy);
  saveFile(name, new Blob([text], { type: "image/svg+xml" }));
}
