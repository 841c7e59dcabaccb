// The page: the bar at the top, the panels, and saving their layout.

import { Connection } from "./connection.js";
import { OPENS_MENU, button, element, fill, iconButton, openMenu, set, write } from "./elements.js";
import { Layout } from "./layout.js";
import { PANELS } from "./panels/index.js";
import { isDark } from "./theme.js";
import { Timeline } from "./timeline.js";

const KEEP = "lcmtools.layout."; // prefix of a view's name in the browser's storage
const THEME = "lcmtools.theme";
const NAMED = "lcmtools.layouts"; // the layouts with a name, of all views
const LAST = "lcmtools.last"; // the last two own layouts that this tab has put into its address
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
const question = element("form", { class: "question", role: "alert", hidden: true, onsubmit: (/** @type {Event} */ event) => event.preventDefault() });
/** True while the layout of the address is shown, which does not replace one's own unless the person says so. */
let isShared = false;

/** @type {ReturnType<typeof setTimeout> | undefined} */
let timer;
/** The last address after # that this page has set. */
let written = "";
/** @type {string[]} */
let last = [];

document.body.append(
  element(
    "header",
    { class: "bar" },
    element("h1", {}, "lcmtools"),
    bus,
    link,
    element("span", { class: "space" }),
    menuButton("add", "Add panel", openPanels),
    iconButton("undo", "Undo the last change of the layout", undo),
    menuButton("layouts", "Layouts", openLayouts),
    iconButton("link", "Copy the address of this arrangement", copyAddress),
    iconButton("theme", "Light or dark", changeTheme),
  ),
  trouble,
  question,
  layout.element,
  new Timeline(connection).element,
  spoken,
);
showTheme(read(THEME));
addEventListener("online", () => connection.retry());
document.addEventListener("visibilitychange", () => document.hidden || connection.retry());
connection.addEventListener("change", showLink);
connection.addEventListener("change", begin);
addEventListener("hashchange", () => location.hash !== written && showOwnOrShared());
addEventListener("keydown", (event) => {
  const isTyping = event.target instanceof Element && event.target.matches("input, textarea");
  if (event.key === "z" && (event.ctrlKey || event.metaKey) && !event.shiftKey && !isTyping) undo();
});
addEventListener("pagehide", keep);

/** Show the panels once, when the server has sent the view. */
function begin() {
  if (!connection.hello) return;
  connection.removeEventListener("change", begin);
  showOwnOrShared();
}

/** Show the layout of the address, else one's own; ask before the one replaces the other. */
function showOwnOrShared() {
  const [address, kept] = [hashText(), read(viewName())];
  const [shared, own] = [parsed(address), parsed(kept)];
  // A page that is reloaded just after a change can have its address and history from before it.
  const isOwn = history.state?.isOwn || address === kept || parsed(read(LAST, true))?.includes(address);
  isShared = Boolean(shared && own) && !isOwn;
  question.hidden = true;
  change((isShared ? shared : own) ?? shared ?? first(), "");
  if (!isShared) return;
  ask("This layout is from the address. Yours is kept.", null, {
    "Use this one": () => {
      isShared = false;
      keep();
    },
    "Back to mine": () => {
      isShared = false;
      change(own, "your own layout is shown");
    },
  });
}

/**
 * Show another layout.
 * @param {any} value
 * @param {string} text for screen readers
 */
function change(value, text) {
  layout.show(value);
  keep();
  announce(text);
}

/**
 * Ask something below the top until a button is pressed; Enter presses the first one.
 * @param {string} text
 * @param {HTMLInputElement | null} input
 * @param {Record<string, () => void>} answers
 */
function ask(text, input, answers) {
  const buttons = Object.entries(answers).map(([label, run], index) => {
    const answer = () => {
      question.hidden = true;
      run();
    };
    return button(label, answer, { type: index ? "button" : "submit" });
  });
  fill(question, element("span", {}, text), input, buttons);
  question.hidden = false;
  input?.focus();
}

function undo() {
  keep(); // a change of which nothing is remembered yet
  const isUndone = layout.undo();
  if (isUndone) keep();
  announce(isUndone ? "the last change is undone" : "there is no change to undo");
}

/** Return the layouts with a name. */
function named() {
  const found = parsed(read(NAMED));
  return /** @type {Record<string, any>} */ (found && typeof found === "object" ? found : {});
}

/** @param {Event} event */
function openLayouts(event) {
  const opener = /** @type {HTMLButtonElement} */ (event.currentTarget);
  const layouts = Object.entries(named());
  openMenu(opener, [
    ...layouts.map(([name, value]) => ({ label: name, run: () => change(value, `the layout ${name} is shown`) })),
    { label: "Save as …", run: askName },
    {
      label: "Delete …",
      disabled: !layouts.length,
      run: () => openMenu(opener, layouts.map(([name]) => ({ label: `Delete ${name}`, run: () => storeNamed(name) }))),
    },
    { label: "Reset layout", run: () => change(first(), "the layout is reset") },
  ]);
}

function askName() {
  const input = element("input", { "aria-label": "Name of the layout", placeholder: "Name", required: true, maxlength: 60 });
  ask("Save this layout as", input, {
    Save: () => {
      const name = input.value.trim();
      if (!name) askName();
      else if (!Object.hasOwn(named(), name)) storeNamed(name, layout.kept());
      else ask(`Replace the layout ${name}?`, null, { Replace: () => storeNamed(name, layout.kept()), Cancel: () => {} });
    },
    Cancel: () => {},
  });
}

/**
 * Store a layout with a name; without a layout, delete it.
 * @param {string} name
 * @param {any} [value]
 */
function storeNamed(name, value) {
  const all = new Map(Object.entries(named()));
  if (value) all.set(name, value);
  else all.delete(name);
  const isStored = store(NAMED, JSON.stringify(Object.fromEntries(all)));
  if (!isStored) ask("This browser stores nothing for this page.", null, { Close: () => {} });
  else announce(`the layout ${name} is ${value ? "saved" : "deleted"}`);
}

/** Return the view of one panel that the server wants; null for all panels. */
function view() {
  const wanted = connection.hello?.view;
  return wanted?.panel ? wanted : null;
}

/** Return the initial layout of this view. */
const first = () => view() ?? DEFAULT;

/** Return the name under which this view's layout is saved. */
const viewName = () => KEEP + (view() ? JSON.stringify(view()) : "all");

function hashText() {
  try {
    return decodeURIComponent(location.hash.slice(1));
  } catch {
    return ""; // a truncated address
  }
}

/** @param {string | null} text */
function parsed(text) {
  try {
    return JSON.parse(text || "null");
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
  layout.remember();
  const text = JSON.stringify(layout.kept());
  if (!isShared) {
    store(viewName(), text);
    if (text !== last.at(-1)) last = [...last.slice(-1), text];
    store(LAST, JSON.stringify(last), true);
  }
  history.replaceState({ isOwn: !isShared }, "", `#${encodeURIComponent(text)}`);
  written = location.hash;
}

/** @param {string} name @param {boolean} [isOfTab] */
function read(name, isOfTab) {
  try {
    return (isOfTab ? sessionStorage : localStorage).getItem(name);
  } catch {
    return null; // storage is disabled
  }
}

/**
 * Store a text; return false if storage is disabled or full.
 * @param {string} name
 * @param {string} value
 * @param {boolean} [isOfTab] true: for this tab alone, until it is closed
 */
function store(name, value, isOfTab) {
  try {
    (isOfTab ? sessionStorage : localStorage).setItem(name, value);
    return true;
  } catch {
    return false;
  }
}

/** @param {Event} event */
function openPanels(event) {
  const entries = Object.entries(PANELS).map(([name, { title, detail }]) => {
    return { label: title, detail, run: () => layout.add(name, {}) };
  });
  openMenu(/** @type {HTMLButtonElement} */ (event.currentTarget), entries);
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
  connection.changed(); // drawings update their colours
}

function showLink() {
  const { hello, isOpen, refusal, state } = connection;
  write(bus, hello ? hello.bus : "");
  set(bus, "title", hello ? `${hello.source} ${hello.bus}` : null);
  const rights = hello?.source === "log" ? "log" : connection.canCommand ? "connected" : "watching only";
  write(link, isOpen ? rights : "no server");
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

/** @param {"add" | "layouts"} name @param {string} label @param {(event: Event) => void} onclick */
function menuButton(name, label, onclick) {
  const made = iconButton(name, label, onclick, OPENS_MENU);
  made.append(element("span", {}, label));
  return made;
}
