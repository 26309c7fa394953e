// Time line: the last minute of driving with its bumps, questions and lessons. A touch stops the robot and shows that
// moment; the action that is touched then corrects it.

import { asks, sentence, setText } from "./decision.js";
import { text } from "./texts.js";

const KEPT_TICKS = 6000; // of driving; the robot keeps 6200, and drives some more until it has stopped
const LEAST_TICKS = 1000; // length of the time line of a robot that has driven less
const BRAKING_TICKS = 100; // a robot that is stopped stands within a second
const PICK_M = 0.6; // farthest touch from the path
const PICK_PX = 12; // farthest touch from a mark
const APART_TICKS = 50; // of two marks of a kind that are nearer only the first is made
const STEP_S = 0.2;
const MARKS = { bump: "✕", question: "?", lesson: "✓" };

export class Rewind {
  #bar = document.getElementById("rewind-bar");
  #time = document.getElementById("rewind-time");
  #row = document.getElementById("marks");
  #go = document.getElementById("rewind-go");
  #says = document.getElementById("rewind-says");
  #boot = null;
  #states = []; // of driving, oldest first, each with the ticks driven before it
  #marks = []; // oldest first
  #driven = 0; // ticks driven up to the newest state, a gap between two pictures counted in full
  #before = null; // newest state, also of a robot that stands
  #opened = null; // newest state of driving when rewind was entered; the slider shows driven time before it
  #touched = false; // the slider's next input is that of a touch, and no drag
  #tickS = 0.01;
  #onChange;
  open = false;

  // `stop` stops the robot; `onChange` draws the page again.
  constructor({ stop, onChange }) {
    this.#onChange = onChange;
    const look = () => {
      if (this.open) return;
      stop();
      this.enter();
    };
    document.getElementById("rewind").addEventListener("click", look);
    document.getElementById("rewind-close").addEventListener("click", () => this.leave());
    this.#go.addEventListener("click", () => this.#go.setAttribute("aria-pressed", String(!this.drivesOn)));
    this.#time.addEventListener("pointerdown", () => {
      look();
      this.#touched = true;
    });
    this.#time.addEventListener("input", () => {
      look(); // by a key
      if (this.#touched) this.#snap();
      this.#touched = false;
      this.#show();
    });
    for (const button of this.#bar.querySelectorAll("[data-step]")) {
      button.addEventListener("click", () => {
        this.#time.value = Number(this.#time.value) + Number(button.dataset.step) * STEP_S;
        this.#show();
      });
    }
  }

  // Forgets the states of another start of the robot program.
  setHello({ boot, period_s: period }) {
    this.#time.step = period * 10;
    this.#tickS = period;
    if (boot === this.#boot) return;
    this.#boot = boot;
    this.#states = [];
    this.#marks = [];
    this.#row.replaceChildren();
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
    if (state.bumpers && !before.bumpers) this.#mark("bump");
    if (asks(state) && !asks(before)) this.#mark("question");
    if (state.lessons > before.lessons) this.#mark("lesson");
    this.#keep(state);
    while (this.#states.length && this.#driven - this.#states[0].driven > KEPT_TICKS) this.#states.shift();
    while (this.#marks.length && this.#driven - this.#marks[0].driven > KEPT_TICKS) this.#marks.shift().drawn.remove();
    this.#row.style.setProperty("--to", this.#end);
    this.#row.style.setProperty("--span", this.#span);
  }

  #keep(state) {
    if (!turns(state) || (this.open && state.tick - this.#opened.tick < BRAKING_TICKS)) return;
    this.leave();
    this.#states.push({ ...state, driven: this.#driven });
  }

  // Shows the newest moment of driving, until `leave`.
  enter() {
    if (!this.#states.length) return;
    this.open = true;
    this.#opened = this.#states.at(-1);
    this.#bar.hidden = false;
    this.#time.min = -this.#span * this.#tickS;
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
    const driven = this.#picked;
    const away = (each) => Math.abs(each.driven - driven);
    return this.#states.reduce((best, each) => (away(each) < away(best) ? each : best));
  }

  // Picks the moment whose place is nearest to a touched point of the world, in metres; false if none is near.
  pick(x, y) {
    const away = ({ place }) => (place ? Math.hypot(place.x_m - x, place.y_m - y) : Infinity);
    const nearest = this.#states.reduce((best, each) => (away(each) < away(best) ? each : best));
    if (away(nearest) > PICK_M) return false;
    this.#picked = nearest.driven;
    this.#show();
    return true;
  }

  // Ticks driven up to the right end of the time line, and its length in ticks.
  get #end() {
    return this.open ? this.#opened.driven : this.#driven;
  }

  get #span() {
    return Math.max(LEAST_TICKS, this.#end - (this.#states[0]?.driven ?? this.#end));
  }

  // Ticks driven up to the picked moment.
  get #picked() {
    return this.#opened.driven + Number(this.#time.value) / this.#tickS;
  }

  set #picked(driven) {
    this.#time.value = (driven - this.#opened.driven) * this.#tickS;
  }

  // Marks the newest moment; a lesson about an earlier one marks that.
  #mark(kind) {
    const driven = kind === "lesson" && this.open ? this.state.driven : this.#driven;
    if (this.#marks.some((each) => each.kind === kind && Math.abs(each.driven - driven) < APART_TICKS)) return;
    const drawn = document.createElement("i");
    drawn.className = kind;
    drawn.textContent = MARKS[kind];
    drawn.style.setProperty("--at", driven);
    this.#row.append(drawn);
    this.#marks.push({ kind, driven, drawn });
  }

  // Returns the marks within `ticks` of the picked moment, nearest first.
  #near(ticks) {
    const away = ({ driven }) => Math.abs(Math.min(driven, this.#opened.driven) - this.#picked);
    return this.#marks.filter((each) => away(each) <= ticks).sort((a, b) => away(a) - away(b));
  }

  // Picks the mark under a finger.
  #snap() {
    const [mark] = this.#near((PICK_PX / this.#time.clientWidth) * this.#span);
    if (mark) this.#picked = mark.driven;
  }

  #show() {
    const { state } = this;
    const seconds = ((this.#opened.driven - state.driven) * this.#tickS).toFixed(1);
    const kinds = new Set(this.#near(Number(this.#time.step) / this.#tickS).map(({ kind }) => kind));
    const did = Object.keys(MARKS).filter((kind) => kinds.has(kind)).map((kind) => text(kind)).join(" and ");
    const what = sentence({ ...state, taught_by: "", taught_at: "" });
    const says = text("rewound", { seconds, marked: did && text("marked", { did }), sentence: what });
    setText(this.#says, says);
    this.#time.setAttribute("aria-valuetext", says);
    this.#onChange();
  }
}

function turns({ left_m_s: left, right_m_s: right }) {
  return Boolean(left || right);
}
