// Styles that a panel brings along when it is first opened.

import { element } from "../elements.js";

/**
 * Load a style sheet once.
 * @param {string} path relative to the folder of the panels
 */
export function stylesheet(path) {
  const href = new URL(path, import.meta.url).href;
  if (![...document.styleSheets].some((sheet) => sheet.href === href)) {
    document.head.append(element("link", { rel: "stylesheet", href }));
  }
}
