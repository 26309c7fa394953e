// Buttons of the robot's actions: a touch answers a question, or corrects a robot that drives; a held one does both
// on the way.

import { glyph } from "./glyphs.js";
import { holdButton } from "./hold_to_correct.js";

export const STAND = "stand"; // the action that turns no wheel
export const WITHDRAWN = "ask"; // the action of an RLA whose action was withdrawn

// Grid place of each known action: row, first column, number of columns. Left is left.
const PLACES = {
  curve_left: [1, 1, 1], bear_left: [1, 2, 1], forward: [1, 3, 1], bear_right: [1, 4, 1], curve_right: [1, 5, 1],
  spin_left: [2, 1, 1], quarter_turn_left: [2, 2, 1], stand: [2, 3, 1], quarter_turn_right: [2, 4, 1], spin_right: [2, 5, 1],
  along_left_wall: [3, 1, 2], back: [3, 3, 1], along_right_wall: [3, 4, 2],
};
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
  names = [];

  // `choose` is called for a tap; `press` is the TapOrHold of the buttons.
  constructor(box, choose, press) {
    this.#box = box;
    this.#choose = choose;
    this.#press = press;
  }

  build(names) {
    if (names.join() === this.names.join()) return;
    this.names = names;
    this.#buttons.clear();
    this.#box.replaceChildren(...names.map((name) => this.#button(name)));
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
      button.classList.toggle("wide", place[2] > 1);
    }
    holdButton(button, name, this.#press);
    button.addEventListener("click", () => this.#choose(name));
    this.#buttons.set(name, button);
    return button;
  }

  // Marks the action that drives, and the action of the nearest RLA.
  show(state) {
    for (const [name, button] of this.#buttons) {
      button.classList.toggle("current", name === state.action && state.stands.reason === "drives");
      button.classList.toggle("nearest", state.stands.asks && name === state.nearest_action);
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
