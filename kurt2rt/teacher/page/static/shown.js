// Show it: the last drive by hand, cut into actions. The teacher takes out what was wrong, and teaches the rest.

import { words } from "./actions.js";
import { setText } from "./decision.js";
import { glyph } from "./glyphs.js";

export class Shown {
  #box = document.getElementById("shown");
  #list = document.getElementById("shown-list");
  #button = document.getElementById("teach-shown");
  #shown = null;
  #key = "";
  #dropped = null; // number of the drive that the teacher does not want to teach
  #tickS = 0.01;
  #chosen = new Set();

  // `teach` sends the press and the indexes of the chosen segments.
  constructor(teach) {
    document.getElementById("drop-shown").addEventListener("click", () => {
      this.#dropped = this.#shown.press_id;
      this.#box.hidden = true;
    });
    this.#button.addEventListener("click", () => teach(this.#shown.press_id, [...this.#chosen].sort((a, b) => a - b)));
  }

  setHello({ period_s: period }) {
    this.#tickS = period;
    this.#key = ""; // another robot may show the same
    this.#dropped = null;
  }

  // Offers the teacher's own drive while the robot stands.
  show({ shown, stands }, device) {
    const offered = shown && shown.teacher === device && shown.press_id !== this.#dropped;
    const own = offered && stands.reason !== "drives" ? shown : null;
    const key = JSON.stringify(own);
    if (key === this.#key) return;
    this.#key = key;
    this.#shown = own;
    this.#box.hidden = !own;
    if (!own) return;
    this.#chosen = new Set(own.actions.keys());
    this.#list.replaceChildren(...own.actions.map((action, i) => this.#segment(action, own.ticks[i], i)));
    this.#count();
  }

  #segment(action, ticks, i) {
    const button = document.createElement("button");
    button.type = "button";
    const seconds = `${(ticks * this.#tickS).toFixed(1)} s`;
    button.setAttribute("aria-label", `${words(action)}, ${seconds}`);
    button.setAttribute("aria-pressed", "true");
    const label = document.createElement("small");
    label.textContent = seconds;
    button.append(glyph(action) ?? words(action), label);
    button.addEventListener("click", () => {
      if (!this.#chosen.delete(i)) this.#chosen.add(i);
      button.setAttribute("aria-pressed", String(this.#chosen.has(i)));
      this.#count();
    });
    return button;
  }

  #count() {
    this.#button.disabled = !this.#chosen.size;
    const all = this.#chosen.size === this.#shown.actions.length;
    setText(this.#button, all ? "Teach what I showed" : `Teach ${this.#chosen.size} of ${this.#shown.actions.length}`);
  }
}
