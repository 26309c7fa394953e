// Rewind: the last ten seconds of driving; the teacher picks the moment that went wrong and touches the right action.

import { sentence, setText } from "./decision.js";
import { text } from "./texts.js";

const KEPT_TICKS = 1000; // of driving; the robot keeps 1200, and drives some more until it has stopped
const BRAKING_TICKS = 100; // a robot that is stopped stands within a second
const PICK_M = 0.6; // farthest touch from the path

export class Rewind {
  #bar = document.getElementById("rewind-bar");
  #time = document.getElementById("rewind-time");
  #go = document.getElementById("rewind-go");
  #says = document.getElementById("rewind-says");
  #boot = null;
  #states = []; // of driving, oldest first, each with the ticks driven before it
  #driven = 0; // ticks driven up to the newest state, a gap between two pictures counted in full
  #before = null; // newest state, also of a robot that stands
  #opened = null; // newest state of driving when rewind was entered; the slider shows driven time before it
  #tickS = 0.01;
  #onChange;
  open = false;

  // `stop` stops the robot; `onChange` draws the page again.
  constructor({ stop, onChange }) {
    this.#onChange = onChange;
    document.getElementById("rewind").addEventListener("click", () => {
      stop();
      this.enter();
    });
    document.getElementById("rewind-close").addEventListener("click", () => this.leave());
    this.#go.addEventListener("click", () => this.#go.setAttribute("aria-pressed", String(!this.drivesOn)));
    this.#time.addEventListener("input", () => this.#show());
  }

  // Forgets the states of another start of the robot program.
  setHello({ boot, period_s: period }) {
    this.#time.step = period * 10;
    this.#tickS = period;
    if (boot === this.#boot) return;
    this.#boot = boot;
    this.#states = [];
    this.#before = null;
    this.leave();
  }

  // True if the robot is to drive on after the lesson, as after an answer; the teacher chose it with "then go".
  get drivesOn() {
    return this.#go.getAttribute("aria-pressed") === "true";
  }

  // True once the robot was seen to drive.
  get ready() {
    return this.#states.length > 0;
  }

  // Keeps a state of a driving robot; leaves the past when the robot drives on.
  add(state) {
    const before = this.#before ?? state;
    this.#before = state;
    if (turns(before) || turns(state)) this.#driven += state.tick - before.tick;
    if (!turns(state)) return;
    if (this.open && state.tick - this.#opened.tick < BRAKING_TICKS) return;
    this.leave();
    this.#states.push({ ...state, driven: this.#driven });
    while (this.#driven - this.#states[0].driven > KEPT_TICKS) this.#states.shift();
  }

  // Shows the newest moment of driving, until `leave`.
  enter() {
    if (!this.#states.length) return;
    this.open = true;
    this.#opened = this.#states.at(-1);
    this.#bar.hidden = false;
    this.#time.min = -(this.#opened.driven - this.#states[0].driven) * this.#tickS;
    this.#time.max = 0;
    this.#time.value = 0;
    this.#time.focus();
    this.#show();
  }

  leave() {
    if (!this.open) return;
    this.open = false;
    this.#bar.hidden = true;
    if (document.activeElement === this.#time) this.#time.blur();
    this.#onChange();
  }

  // The state of the picked moment; null outside rewind.
  get state() {
    if (!this.open) return null;
    const driven = this.#opened.driven + Number(this.#time.value) / this.#tickS;
    const away = (each) => Math.abs(each.driven - driven);
    return this.#states.reduce((best, each) => (away(each) < away(best) ? each : best));
  }

  // Picks the moment whose place is nearest to a touched point of the world, in metres; false if none is near.
  pick(x, y) {
    const away = ({ place }) => (place ? Math.hypot(place.x_m - x, place.y_m - y) : Infinity);
    const nearest = this.#states.reduce((best, each) => (away(each) < away(best) ? each : best));
    if (away(nearest) > PICK_M) return false;
    this.#time.value = (nearest.driven - this.#opened.driven) * this.#tickS;
    this.#show();
    return true;
  }

  #show() {
    const { state } = this;
    const seconds = ((this.#opened.driven - state.driven) * this.#tickS).toFixed(1);
    const says = text("rewound", { seconds, sentence: sentence(state) });
    setText(this.#says, says);
    this.#time.setAttribute("aria-valuetext", says);
    this.#onChange();
  }
}

function turns({ left_m_s: left, right_m_s: right }) {
  return Boolean(left || right);
}
