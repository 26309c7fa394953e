// The newest decision: a sentence, the distance relative to R, and the differences while the robot asks.

import { WITHDRAWN, words } from "./actions.js";
import { differs, MID, strip, surprise } from "./mid_text.js";
import { differenceList } from "./sensors.js";
import { Trace } from "./trace.js";

const MONTHS = ["Jan", "Feb", "Mar", "Apr", "May", "Jun", "Jul", "Aug", "Sep", "Oct", "Nov", "Dec"];
const VALUES_FROM_PHASE = 3;
const CALM_MS = 500; // readings change by a centimetre with every state, too fast to read
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
      return `RLA ${state.rla}${of(state)} does ${words(state.action)}${taught(state)}`;
    case "held":
      return `RLA ${state.rla} keeps ${words(state.action)} for its shortest time; RLA ${state.nearest} is nearest now`;
    case "avoids":
      return `RLA ${state.rla} does ${words(state.action)}; RLA ${state.nearest} is nearest, but would meet an obstacle`;
    case "teacher":
      return state.action && state.action !== "by hand"
        ? `${state.teacher ?? "A teacher"} runs ${words(state.action)}`
        : `${state.teacher ?? "A teacher"} drives by hand`;
    case "doubt":
      return `I doubt RLA ${state.nearest}${of(state)} here, which says ${words(state.nearest_action)}, teach me`;
    case "unknown":
      if (state.asks_at === MID) {
        if (state.nearest_action === WITHDRAWN && state.distance <= state.radius) {
          return `Which way? Mid-level RLA ${state.nearest} was marked wrong, teach me again`;
        }
        if (state.nearest === null) return "Which way? I know none yet, teach me";
        return state.distance === null ? "Where am I? Touch “is here” at a goal" : "Which way? I don't know, teach me";
      }
      if (state.nearest_action === WITHDRAWN && state.distance <= state.radius) {
        return `RLA ${state.nearest}${of(state)} was marked wrong${valueNow(state)}, teach me again`;
      }
      if (state.nearest !== null && state.distance !== null && state.distance <= state.radius) {
        return `RLA ${state.nearest}${of(state)}: I no longer have ${words(state.nearest_action)}, teach me another action`;
      }
      return state.nearest === null ? `I know nothing${of(state)} yet, teach me` : "I don't know this situation, teach me";
    default:
      return state.stands.text;
  }
}

export class Decision {
  #box = document.getElementById("why");
  #nearest = document.getElementById("nearest");
  #trace = new Trace(document.getElementById("trace"));
  #sentence = document.getElementById("sentence");
  #fill = document.getElementById("gauge-fill");
  #gauge = document.getElementById("gauge");
  #text = document.getElementById("gauge-text");
  #differences = document.getElementById("differences");
  #shown = "";
  #shownMs = -Infinity;

  show(state, hello) {
    const asks = state.stands.asks && !state.stands.needs_go;
    this.#box.classList.toggle("stands", standsFor(state));
    const which = asks && state.asks_at === MID && state.mid;
    this.#box.classList.toggle("asks", asks);
    this.#box.classList.toggle("which", Boolean(which));
    setText(this.#sentence, sentence(state));
    const known = state.nearest !== null && state.distance !== null && state.radius > 0;
    const share = known ? state.distance / state.radius : 0;
    this.#gauge.classList.toggle("beyond", share > 1);
    this.#gauge.classList.toggle("none", !known);
    this.#fill.style.width = `${Math.min(1, share * GAUGE_SHARE) * 100}%`;
    const its = state.nearest_action === WITHDRAWN ? "its action was withdrawn" : words(state.nearest_action ?? "–");
    const rla = which ? "mid-level RLA" : "RLA";
    const nowhere = which && state.nearest !== null && state.distance === null; // the robot was put elsewhere
    const untaught = nowhere ? "goals: touch “is here”" : which ? "touch the way that is right here" : "touch the action that is right here";
    setText(this.#nearest, known ? `nearest: ${rla} ${state.nearest}, ${its}` : untaught);
    const value = state.value === null || state.phase < VALUES_FROM_PHASE ? "" : ` · value ${signed(state.value)}`;
    const off = which ? differs(state, hello.mid) : known ? `${state.distance.toFixed(0)} of R ${state.radius.toFixed(0)}${value}` : "no RLA yet";
    setText(this.#text, off);
    this.#surprise(state);
    this.#trace.add(state.tick, known && !which ? share : null);
    if (!asks) this.#shownMs = -Infinity; // shows the next question at once
    if (which) this.#compare(state.mid, hello.mid);
    else if (asks) this.#show(state.question);
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

  // Shows the symbols that the robot passed, and below them the condition of the nearest mid-level RLA.
  #compare(mid, introduced) {
    const key = JSON.stringify([introduced, mid.here, mid.there]);
    if (key === this.#shown) return;
    this.#shown = key;
    this.#differences.replaceChildren(...strip(mid.here, mid.there, introduced));
  }

  // Shows each differing sensor by its place, with the reading here and the taught one.
  #show(question) {
    const key = JSON.stringify(question.map((line) => line.slice(3)));
    const nowMs = performance.now();
    if (key === this.#shown || nowMs - this.#shownMs < CALM_MS) return;
    this.#shown = key;
    this.#shownMs = nowMs;
    this.#differences.replaceChildren(differenceList(question));
  }
}

function signed(value) {
  return (Math.round(value * 100) / 100 || 0).toFixed(2).replace("-", "−"); // never −0.00
}

export function setText(element, text) {
  if (element.textContent !== text) element.textContent = text;
}
