// Styles that a panel brings along when it is first opened.

import { element } from "../elements.js";

/** What has been loaded, or is, by address. @type {Map<string, Promise<unknown>>} */
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

/** Wait until all of them are there: what is shown before would move away under the pointer. */
export function styled() {
  return Promise.all(sheets.values());
}
