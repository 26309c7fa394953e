// Buttons of the robot's actions: a touch answers a question, or corrects a robot that drives; a held one does both
// on the way.

import { glyph } from "./glyphs.js";
import { holdButton } from "./hold_to_correct.js";

export const STAND = "stand"; // the action that turns no wheel
export const WITHDRAWN = "ask"; // the action of an RLA whose action was withdrawn

// Grid place of each known action: row, first column, number of columns. Left is left.
const PLACES = {
  curve_left: [1, 1, 2], bear_left: [1, 3, 2], forward: [1, 5, 2], bear_right: [1, 7, 2], curve_right: [1, 9, 2],
  spin_left: [2, 1, 2], quarter_turn_left: [2, 3, 2], stand: [2, 5, 2], quarter_turn_right: [2, 7, 2], spin_right: [2, 9, 2],
  along_left_wall: [3, 1, 4], back: [3, 5, 2], along_right_wall: [3, 7, 4],
};
const WITHIN_REACH = 13; // of a thumb on a phone: three rows; the others are folded away
const SHORT = { quarter_turn_left: "turn 90°", quarter_turn_right: "turn 90°" };
const NAMES = { quarter_turn_left: "turn 90° to the left", quarter_turn_right: "turn 90° to the right" };

export function words(action) {
  return action.replaceAll("_", " ");
}

export class ActionPad {
  #box;
  #choose;
  #press;
  #buttons = new Map();
  #more = document.createElement("button"); // opens and folds the rare actions
  names = [];

  // `choose` is called for a tap; `press` is the TapOrHold of the buttons.
  constructor(box, choose, press) {
    this.#box = box;
    this.#choose = choose;
    this.#press = press;
    this.#more.type = "button";
    this.#more.id = "more-actions";
    this.#more.addEventListener("click", () => this.#open(!this.#box.classList.contains("open")));
  }

  build(names) {
    if (names.join() === this.names.join()) return;
    this.names = names;
    this.#buttons.clear();
    this.#box.replaceChildren(...names.map((name) => this.#button(name)), this.#more);
    this.#box.classList.toggle("folds", names.length > WITHIN_REACH);
    this.#open(false);
    const placed = names.filter((name) => PLACES[name]);
    const others = names.filter((name) => !PLACES[name]);
    for (const name of [...placed, ...others].slice(WITHIN_REACH)) this.#buttons.get(name).classList.add("rare");
  }

  #open(open) {
    this.#box.classList.toggle("open", open);
    this.#more.setAttribute("aria-expanded", String(open));
    this.#more.textContent = open ? "fewer" : "more actions";
  }

  #button(name) {
    const button = document.createElement("button");
    button.type = "button";
    button.dataset.action = name;
    button.setAttribute("aria-label", NAMES[name] ?? words(name))
    const picture = glyph(name);
    if (picture) button.append(picture);
    const label = document.createElement("small");
    label.textContent = SHORT[name] ?? words(name);
    button.append(label);
    const place = PLACES[name];
    if (place) {
      button.style.gridRow = place[0];
      button.style.gridColumn = `${place[1]} / span ${place[2]}`;
      button.classList.toggle("wide", place[2] > 2);
    }
    holdButton(button, name, this.#press);
    button.addEventListener("click", () => this.#choose(name));
    this.#buttons.set(name, button);
    return button;
  }

  // Marks the action that drives, and the action of the nearest RLA; the fold, too, if that is a rare one.
  show(state) {
    for (const [name, button] of this.#buttons) {
      button.classList.toggle("current", name === state.action && state.stands.reason === "drives");
      button.classList.toggle("nearest", state.stands.asks && name === state.nearest_action);
    }
    const folded = !this.#box.classList.contains("open");
    for (const mark of ["current", "nearest"]) {
      this.#more.classList.toggle(mark, folded && this.#box.querySelector(`.rare.${mark}`) !== null);
    }
  }

  markHeld(name, held) {
    this.#buttons.get(name)?.classList.toggle("held", held);
  }

  markOutcome(name, outcome) {
    const button = this.#buttons.get(name);
    if (!button) return;
    button.classList.remove("pending", "saved", "refused");
    if (outcome) button.classList.add(outcome);
  }
}
