// Style sheets of panels, loaded when a panel is first opened.

import { element } from "../elements.js";

/** The style sheets that are loaded or being loaded, by address. @type {Map<string, Promise<unknown>>} */
const sheets = new Map();

/**
 * Load a style sheet once.
 * @param {string} path relative to the folder of the panels
 */
export function stylesheet(path) {
  const href = new URL(path, import.meta.url).href;
  if (sheets.has(href)) return;
  const link = element("link", { rel: "stylesheet", href });
  sheets.set(href, new Promise((done) => (link.onload = link.onerror = done)));
  document.head.append(link);
}

/** Wait until all style sheets are loaded, so that elements do not move under the pointer. */
export function styled() {
  return Promise.all(sheets.values());
}
