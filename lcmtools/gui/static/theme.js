// The light and the dark theme: the colours of style.css for drawings on canvases.

import { element } from "./elements.js";

const SYSTEM = matchMedia("(prefers-color-scheme: dark)");

/** Return true if the page is dark: by the user's choice, else by the system's. */
export function isDark() {
  const chosen = document.documentElement.dataset["theme"];
  return chosen ? chosen === "dark" : SYSTEM.matches;
}

/**
 * Call a function whenever the colours have changed.
 * @param {() => void} listener
 * @param {AbortSignal} signal stops the calls
 */
export function onTheme(listener, signal) {
  SYSTEM.addEventListener("change", listener, { signal });
  const chosen = new MutationObserver(listener);
  chosen.observe(document.documentElement, { attributeFilter: ["data-theme"] });
  signal.addEventListener("abort", () => chosen.disconnect());
}

/**
 * Return a colour of style.css as the browser resolves it, for a canvas.
 * @param {string} name for example "--accent"
 */
export function color(name) {
  const probe = element("span");
  probe.style.color = `var(${name})`;
  document.body.append(probe);
  const found = getComputedStyle(probe).color;
  probe.remove();
  return found;
}

/**
 * Return a colour of style.css as #rrggbb.
 * @param {string} name
 */
export function hexColor(name) {
  const numbers = color(name).match(/\d+/g) ?? [];
  return `#${numbers.slice(0, 3).map((value) => Number(value).toString(16).padStart(2, "0")).join("")}`;
}
