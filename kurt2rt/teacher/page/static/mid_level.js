// Buttons that teach the mid level a behaviour, and its present choice.

import { words } from "./actions.js";
import { glyph } from "./glyphs.js";
import { BASIC, MID, strip, symbol, waySentence } from "./mid_text.js";
import { setText, when } from "./decision.js";

const TURNED_MS = 400;

const $ = (id) => document.getElementById(id);

export class MidLevelPad {
  #choose;
  #buttons = new Map();
  #hello = null;
  #chosen = MID; // by the teacher; a question overrides it
  #level = BASIC;
  #turned = null; // timer
  #shown = "";
  names = [];

  // `choose` gets the behaviour and its kind: teach, also (an alternative) or once.
  constructor(choose) {
    this.#choose = choose;
    for (const button of $("levels").children) {
      button.addEventListener("click", () => {
        this.#chosen = button.dataset.level;
        this.#turn(this.#chosen);
      });
    }
    for (const button of $("meant").children) {
      button.addEventListener("click", () => this.#mean(button.dataset.meant));
    }
  }

  build(hello) {
    this.#hello = hello;
    this.names = hello.mid ? hello.behaviours : [];
    $("levels").hidden = !hello.mid;
    document.body.classList.toggle("has-mid", Boolean(hello.mid));
    this.#buttons.clear();
    this.#shown = "";
    $("ways").replaceChildren(...this.names.map((name) => this.#button(name)));
    this.#turn(hello.mid ? this.#chosen : BASIC);
    this.#mean("teach");
  }

  // Level that the buttons teach.
  get level() {
    return this.#level;
  }

  // True just after a question has changed the buttons: a touch may have been meant for those before.
  get justTurned() {
    return this.#turned !== null;
  }

  #button(name) {
    const button = document.createElement("button");
    button.type = "button";
    button.dataset.way = name;
    const picture = glyph(name);
    if (picture) button.append(picture);
    const label = document.createElement("b");
    label.textContent = words(name);
    button.append(label);
    button.addEventListener("click", () => this.choose(name));
    this.#buttons.set(name, button);
    return button;
  }

  choose(name) {
    const meant = $("meant").querySelector("[aria-pressed=true]").dataset.meant;
    this.#choose(name, meant);
    this.#mean("teach"); // an old choice must not change the next lesson
  }

  #mean(meant) {
    for (const each of $("meant").children) each.setAttribute("aria-pressed", String(each.dataset.meant === meant));
  }

  #turn(level) {
    clearTimeout(this.#turned);
    this.#turned = null;
    $("teach").classList.remove("turned");
    this.#level = level;
    for (const each of $("levels").children) each.setAttribute("aria-pressed", String(each.dataset.level === level));
    $("teach").classList.toggle("ways", level === MID);
  }

  // Shows the level of a question.
  #turnOver(level) {
    this.#turn(level);
    $("teach").classList.add("turned");
    this.#turned = setTimeout(() => {
      this.#turned = null;
      $("teach").classList.remove("turned");
    }, TURNED_MS);
  }

  show(state) {
    const { mid } = state;
    $("mid").hidden = !mid || mid.asks; // the question is shown instead
    if (!mid || !this.#hello.mid) return;
    const level = state.cause === "unknown" ? state.asks_at : this.#chosen;
    if (level !== this.#level) this.#turnOver(level);
    setText($("mid-sentence"), waySentence(state, this.#hello));
    $("mid-sentence").title = [mid.taught_by && `taught by ${mid.taught_by}`, when(mid.taught_at)].filter(Boolean).join(", ");
    const key = JSON.stringify([mid.here, mid.behaviour]);
    if (key !== this.#shown) {
      this.#shown = key;
      $("strip").replaceChildren(...strip(mid.here, [], this.#hello.mid), this.#next(mid));
      $("strip").setAttribute("aria-label", `passed: ${[...mid.here].reverse().filter(Boolean).map(words).join(", ") || "nothing yet"}`);
    }
    for (const [name, button] of this.#buttons) {
      button.classList.toggle("current", !mid.asks && name === mid.behaviour);
      button.classList.toggle("nearest", mid.asks && name === mid.nearest_behaviour);
    }
  }

  #next(mid) {
    const pair = document.createElement("div");
    pair.className = "next";
    pair.append(symbol(mid.behaviour));
    return pair;
  }

  markOutcome(name, outcome) {
    const button = this.#buttons.get(name);
    if (!button) return;
    button.classList.remove("pending", "saved", "refused");
    if (outcome) button.classList.add(outcome);
  }
}
