// The page: the bar at the top, the panels, and saving their layout.

import { Connection } from "./connection.js";
import { element, iconButton, openMenu, set, write } from "./elements.js";
import { Layout } from "./layout.js";
import { PANELS } from "./panels/index.js";
import { isDark } from "./theme.js";
import { Timeline } from "./timeline.js";

const KEEP = "lcmtools.layout."; // prefix of a view's name in the browser's storage
const THEME = "lcmtools.theme";
const SOON = 300; // [ms] until a change is saved
const DEFAULT = {
  split: "row",
  sizes: [3, 2],
  parts: [
    { split: "column", sizes: [3, 1], parts: [{ panel: "topics" }, { panel: "log" }] },
    { panel: "world" },
  ],
};

const address = `${location.protocol === "https:" ? "wss" : "ws"}://${location.host}/socket${location.search}`;
const connection = new Connection(address);
const layout = new Layout(connection, { changed: keepSoon, announce });
const spoken = element("div", { class: "spoken", role: "status", "aria-live": "polite" });
const link = element("span", { class: "link", role: "status" });
const bus = element("span", { class: "bus" });
const trouble = element("p", { class: "trouble", role: "alert", hidden: true });

/** @type {ReturnType<typeof setTimeout> | undefined} */
let timer;
/** The last address after # that this page has set. */
let written = "";

document.body.append(
  element(
    "header",
    { class: "bar" },
    element("h1", {}, "lcmtools"),
    bus,
    link,
    element("span", { class: "space" }),
    textButton("add", "Add panel", openPanels),
    iconButton("link", "Copy the address of this arrangement", copyAddress),
    iconButton("reset", "Reset layout", startAgain),
    iconButton("theme", "Light or dark", changeTheme),
  ),
  trouble,
  layout.element,
  new Timeline(connection).element,
  spoken,
);
showTheme(read(THEME));
connection.addEventListener("change", showLink);
connection.addEventListener("change", begin);
addEventListener("hashchange", () => {
  if (location.hash !== written) layout.show(fromHash() ?? first());
});
addEventListener("pagehide", keep);

/** Show the panels once, when the server has sent the view. */
function begin() {
  if (!connection.hello) return;
  connection.removeEventListener("change", begin);
  layout.show(fromHash() ?? fromStorage() ?? first());
}

/** Return the initial layout of this view. */
function first() {
  const view = connection.hello?.view;
  return view?.panel ? view : DEFAULT;
}

function startAgain() {
  layout.show(first());
  keep();
  announce("the layout is reset");
}

/** Return the name under which this view's layout is saved. */
function viewName() {
  const view = connection.hello?.view;
  return KEEP + (view?.panel ? JSON.stringify(view) : "all");
}

function fromHash() {
  try {
    return parsed(decodeURIComponent(location.hash.slice(1)));
  } catch {
    return null; // a truncated address
  }
}

function fromStorage() {
  return parsed(read(viewName()));
}

/** @param {string | null} text */
function parsed(text) {
  try {
    return text ? JSON.parse(text) : null;
  } catch {
    return null;
  }
}

function keepSoon() {
  clearTimeout(timer);
  timer = setTimeout(keep, SOON);
}

function keep() {
  clearTimeout(timer);
  if (!connection.hello) return;
  const text = JSON.stringify(layout.kept());
  store(viewName(), text);
  history.replaceState(null, "", `#${encodeURIComponent(text)}`);
  written = location.hash;
}

/** @param {string} name */
function read(name) {
  try {
    return localStorage.getItem(name);
  } catch {
    return null; // storage is disabled
  }
}

/**
 * @param {string} name
 * @param {string} value
 */
function store(name, value) {
  try {
    localStorage.setItem(name, value);
  } catch {
    // storage is disabled or full
  }
}

/** @param {Event} event */
function openPanels(event) {
  openMenu(
    /** @type {HTMLButtonElement} */ (event.currentTarget),
    Object.entries(PANELS).map(([name, { title, detail }]) => ({
      label: title,
      detail,
      run: () => layout.add(name, {}),
    })),
  );
}

async function copyAddress() {
  keep();
  try {
    await navigator.clipboard.writeText(location.href);
    announce("the address is copied");
  } catch {
    announce("the address is in the browser's address bar");
  }
}

function changeTheme() {
  const next = isDark() ? "light" : "dark";
  store(THEME, next);
  showTheme(next);
  announce(`${next} colours`);
}

/** @param {string | null} theme */
function showTheme(theme) {
  if (theme === "light" || theme === "dark") document.documentElement.dataset.theme = theme;
  connection.dispatchEvent(new Event("change")); // drawings update their colours
}

function showLink() {
  const { hello, isOpen, refusal, state } = connection;
  write(bus, hello ? hello.bus : "");
  set(bus, "title", hello ? `${hello.source} ${hello.bus}` : null);
  const rights = hello?.source === "log" ? "log" : connection.canCommand ? "connected" : "watching only";
  const words = isOpen ? rights : "no server";
  write(link, words);
  set(link, "data-state", isOpen ? (state.trouble ? "warn" : "good") : "bad");
  const lost = hello ? "The connection to lcmtools gui is lost." : "There is no answer yet.";
  const told = refusal || (isOpen ? state.trouble || "" : `${lost} Trying again …`);
  trouble.hidden = !told || (!hello && !refusal && !isOpen && performance.now() < 1500);
  write(trouble, told);
  document.body.classList.toggle("is-cut-off", !isOpen);
  document.title = hello?.view.panel ? `${PANELS[hello.view.panel]?.title} – lcmtools` : "lcmtools";
}

/** @param {string} text */
function announce(text) {
  write(spoken, text);
}

/**
 * @param {"add"} name
 * @param {string} label
 * @param {(event: Event) => void} onclick
 */
function textButton(name, label, onclick) {
  const button = iconButton(name, label, onclick, { "aria-haspopup": "menu", "aria-expanded": "false" });
  button.append(element("span", {}, label));
  return button;
}
