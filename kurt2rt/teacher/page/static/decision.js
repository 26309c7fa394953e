// The newest decision: a sentence, the distance relative to R, and the differences while the robot asks.

import { WITHDRAWN, words } from "./actions.js";
import { differs, MID, strip, surprise } from "./mid_text.js";
import { differenceList } from "./sensors.js";
import { Trace } from "./trace.js";

const MONTHS = ["Jan", "Feb", "Mar", "Apr", "May", "Jun", "Jul", "Aug", "Sep", "Oct", "Nov", "Dec"];
const VALUES_FROM_PHASE = 3;
const CALM_MS = 1000; // a text stays for so long at least, so that it can be read
const ASKED = ["unknown", "doubt", "touches"]; // causes by which a state has a question
const LIKE = [[0.3, "just like"], [1, "quite like"], [1.6, "a bit like"], [Infinity, "far from"]]; // up to which share of R
const BEYOND = 1.01; // share of R of a situation that noise puts within R while the robot asks
const GAUGE_SHARE = 0.7; // position of R on the gauge

export function when(stamp) {
  if (!stamp) return "";
  const date = new Date(stamp);
  if (Number.isNaN(date.getTime())) return "";
  const two = (number) => String(number).padStart(2, "0");
  return `${date.getDate()} ${MONTHS[date.getMonth()]} ${two(date.getHours())}:${two(date.getMinutes())}`;
}

function of(state) {
  return state.behaviour ? ` of ${words(state.behaviour)}` : "";
}

function taught(state) {
  const parts = [state.taught_by && `by ${state.taught_by}`, when(state.taught_at)].filter(Boolean);
  return parts.length ? `, taught ${parts.join(", ")}` : "";
}

// RLA 17, or RLA 17 mirrored: the RLA answers on the other side than it was taught.
function driver({ rla, image }) {
  return `RLA ${rla}${image && ` ${image}`}`;
}

function nearest({ nearest: rla, nearest_image: image }) {
  return driver({ rla, image });
}

// Returns whether the robot's own text says why it stands; a question is worded here, with the nearest RLA.
function standsFor(state) {
  const { needs_go: waits, reason } = state.stands;
  return waits || !["drives", "asks", "doubts", "asks the way"].includes(reason);
}

function valueNow({ nearest_value: value }) {
  return typeof value === "number" ? ` (value ${signed(value)})` : "";
}

export function sentence(state) {
  if (standsFor(state)) return state.stands.text;
  switch (state.cause) {
    case "rla":
      return `${driver(state)}${of(state)} does ${words(state.action)}${taught(state)}`;
    case "held":
      return `${driver(state)} keeps ${words(state.action)} for its shortest time; ${nearest(state)} is nearest now`;
    case "teacher":
      return state.action && state.action !== "by hand"
        ? `${state.yours ? "You run" : `${state.teacher ?? "A teacher"} runs`} ${words(state.action)}`
        : `${state.yours ? "You drive" : `${state.teacher ?? "A teacher"} drives`} by hand`;
    case "doubt":
      return `I doubt ${nearest(state)}${of(state)} here, which says ${words(state.nearest_action)}, teach me`;
    case "unknown":
      if (state.asks_at === MID) {
        if (state.nearest_action === WITHDRAWN && state.distance <= state.radius) {
          return `Which way? Mid-level RLA ${state.nearest} was marked wrong, teach me again`;
        }
        if (state.nearest === null) return "Which way? I know none yet, teach me";
        return state.distance === null ? "Where am I? Touch “is here” at a goal" : "Which way? I don't know, teach me";
      }
      if (state.nearest_action === WITHDRAWN && state.distance <= state.radius) {
        return `${nearest(state)}${of(state)} was marked wrong${valueNow(state)}, teach me again`;
      }
      if (state.nearest !== null && state.distance !== null && state.distance <= state.radius) {
        return `${nearest(state)}${of(state)}: I no longer have ${words(state.nearest_action)}, teach me another action`;
      }
      return state.nearest === null ? `I know nothing${of(state)} yet, teach me` : "I don't know this situation, teach me";
    default:
      return state.stands.text;
  }
}

// Returns whether the robot stands and waits for an answer, and not for a GO.
export function asks({ stands }) {
  return stands.asks && !stands.needs_go;
}

function asksWay(state) {
  return Boolean(asks(state) && state.asks_at === MID && state.mid);
}

function known(state) {
  return state.nearest !== null && state.distance !== null && state.radius > 0;
}

// Returns the distance of the nearest RLA as a share of R.
function shareOf({ distance, radius }) {
  return distance / radius;
}

// Changes with each act of a person: GO, a stop, a press, a lesson, another phase, robot or behaviour.
function actsOf({ stands, by_hand: byHand, lessons, phase, behaviour }, { boot }) {
  return JSON.stringify([boot, stands.needs_go, byHand, lessons, phase, behaviour]);
}

// Returns how like the nearest RLA's condition the situation is, in words; the numbers are in the explanation.
function likeness(state, least = 0) {
  const [, like] = LIKE.find(([most]) => Math.max(least, shareOf(state)) <= most);
  return `${like} ${nearest(state)}`;
}

// Returns the sentence of a state, and which RLA is nearest.
function headline(state) {
  const flickers = asks(state) && !ASKED.includes(state.cause) && !standsFor(state);
  const says = flickers ? "I don't know this situation, teach me" : sentence(state);
  const its = state.nearest_action === WITHDRAWN ? "its action was withdrawn" : words(state.nearest_action ?? "–");
  if (known(state)) return [says, `${asksWay(state) ? `nearest: mid-level ${nearest(state)}` : likeness(state, flickers ? BEYOND : 0)}: ${its}`];
  if (!asksWay(state)) return [says, "touch the action that is right here"];
  // Without a distance the robot was put elsewhere.
  const nowhere = state.nearest !== null && state.distance === null;
  return [says, nowhere ? "goals: touch “is here”" : "touch the way that is right here"];
}

// Returns the texts of a state that change with each reading.
function numbersOf(state, hello) {
  const value = state.value === null || state.phase < VALUES_FROM_PHASE ? "" : ` · value ${signed(state.value)}`;
  const off = known(state) ? `${likeness(state)}${value}` : "no RLA yet";
  const basic = asks(state) ? state.question.map((line) => line.slice(3)) : null;
  return {
    off: asksWay(state) ? differs(state, hello.mid) : off,
    guard: state.guard.length ? `guard: ${state.guard.join(", ")}` : "",
    question: asksWay(state) ? [hello.mid, state.mid.here, state.mid.there] : basic,
  };
}

// Chooses the states that are put into words, so that a text stays for a second at least.
class Calm {
  state = null;
  changed = false; // whether the newest choice changed the words
  #words = "";
  #sinceMs = -Infinity;

  // `words`: texts of the state. `atOnce`: they are shown even if the last ones are new.
  choose(state, words, atOnce) {
    const next = JSON.stringify(words);
    const nowMs = performance.now();
    this.changed = next !== this.#words;
    if (this.changed && !atOnce && nowMs - this.#sinceMs < CALM_MS) {
      this.changed = false;
      return this.state;
    }
    if (this.changed) this.#sinceMs = nowMs;
    this.#words = next;
    this.state = state;
    return state;
  }
}

export class Decision {
  #headline = new Calm();
  #numbers = new Calm();
  #acts = "";
  #guard = document.getElementById("guard");
  #box = document.getElementById("why");
  #nearest = document.getElementById("nearest");
  #trace = new Trace(document.getElementById("trace"));
  #sentence = document.getElementById("sentence");
  #fill = document.getElementById("gauge-fill");
  #gauge = document.getElementById("gauge");
  #text = document.getElementById("gauge-text");
  #differences = document.getElementById("differences");
  #shown = "";

  // The state whose question is shown; null before the first.
  get worded() {
    return this.#numbers.state;
  }

  show(state, hello) {
    this.#trace.add(state.tick, known(state) && !asksWay(state) ? shareOf(state) : null);
    this.#surprise(state);
    const acts = actsOf(state, hello);
    const acted = acts !== this.#acts;
    this.#acts = acts;
    const worded = this.#headline.state;
    const asked = worded !== null && asks(worded);
    // While a question is open, noise lets the robot drive for moments; those states have no words of their own.
    if (asked && asks(state) && !ASKED.includes(state.cause) && !acted) return;
    // A person is shown at once what they changed, and that the robot begins to ask.
    const atOnce = acted || (asks(state) && !asked);
    this.#say(this.#headline.choose(state, headline(state), atOnce));
    this.#count(this.#numbers.choose(state, numbersOf(state, hello), atOnce || this.#headline.changed), hello);
  }

  #say(state) {
    const [says, nearest] = headline(state);
    this.#box.classList.toggle("stands", standsFor(state));
    this.#box.classList.toggle("asks", asks(state));
    this.#box.classList.toggle("which", asksWay(state));
    setText(this.#sentence, says);
    setText(this.#nearest, nearest);
  }

  #count(state, hello) {
    const { off, guard, question } = numbersOf(state, hello);
    const share = known(state) ? shareOf(state) : 0;
    this.#gauge.classList.toggle("beyond", share > 1);
    this.#gauge.classList.toggle("none", !known(state));
    this.#fill.style.width = `${Math.min(1, share * GAUGE_SHARE) * 100}%`;
    setText(this.#text, off);
    setText(this.#guard, guard);
    if (asksWay(state)) this.#differ(question, () => strip(state.mid.here, state.mid.there, hello.mid));
    else if (question) this.#differ(question, () => [differenceList(state.question)]);
    else this.#trace.draw();
  }

  #surprise(state) {
    const it = surprise(state);
    const line = document.getElementById("surprise");
    line.hidden = !it;
    if (!it) return;
    line.classList.toggle("loud", it.loud);
    setText(line, it.text);
  }

  // Shows what differs: the symbols that the robot passed and below them the nearest condition, or each differing
  // sensor by its place, with the reading here and the taught one.
  #differ(found, parts) {
    const key = JSON.stringify(found);
    if (key === this.#shown) return;
    this.#shown = key;
    this.#differences.replaceChildren(...parts());
  }
}

function signed(value) {
  return (Math.round(value * 100) / 100 || 0).toFixed(2).replace("-", "−"); // never −0.00
}

export function setText(element, text) {
  if (element.textContent !== text) element.textContent = text;
}
