// Who moves the wheels and why: a sentence, the distance against R, and while it asks, what is different.

import { WITHDRAWN, words } from "./actions.js";
import { differs, MID, strip, surprise } from "./mid.js";
import { differenceList } from "./sensors.js";
import { Trace } from "./trace.js";

const MONTHS = ["Jan", "Feb", "Mar", "Apr", "May", "Jun", "Jul", "Aug", "Sep", "Oct", "Nov", "Dec"];
const VALUES_FROM_PHASE = 3;
const CALM_MS = 500; // readings flicker by a centimetre with every picture; no person can read that
const GAUGE_SHARE = 0.7; // where R stands on the gauge

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

// Whether the robot says itself why it stands; what it does not know is put below as a question, with the nearest RLA.
function standsFor(state) {
  const { needs_go: waits, reason } = state.stands;
  return waits || !["drives", "asks", "asks the way"].includes(reason);
}

function worthNow({ nearest_value: value }) {
  return typeof value === "number" ? `: worth ${signed(value)} now` : "";
}

export function sentence(state) {
  if (standsFor(state)) return state.stands.text;
  switch (state.cause) {
    case "rla":
      return `RLA ${state.rla}${of(state)} does ${words(state.action)}${taught(state)}`;
    case "held":
      return `RLA ${state.rla} keeps ${words(state.action)} for its least time; RLA ${state.nearest} is nearest now`;
    case "teacher":
      return state.action && state.action !== "by hand"
        ? `${state.teacher ?? "A teacher"} lets it run ${words(state.action)}`
        : `${state.teacher ?? "A teacher"} drives by hand`;
    case "unknown":
      if (state.asks_at === MID) {
        if (state.nearest_action === WITHDRAWN && state.distance <= state.radius) {
          return `Which way? Mid-level RLA ${state.nearest} was blamed, teach me again`;
        }
        if (state.nearest === null) return "Which way? I know none yet, teach me";
        return state.distance === null ? "Where am I? Say at which goal" : "Which way? I don't know, teach me";
      }
      if (state.nearest_action === WITHDRAWN && state.distance <= state.radius) {
        return `RLA ${state.nearest}${of(state)} was blamed${worthNow(state)}, teach me again`;
      }
      if (state.nearest !== null && state.distance !== null && state.distance <= state.radius) {
        return `RLA ${state.nearest}${of(state)}: ${words(state.nearest_action)} is lost here, teach me another`;
      }
      return state.nearest === null ? `I know nothing${of(state)} yet, teach me` : "I don't know this situation, teach me";
    default:
      return state.stands.text;
  }
}

export class Why {
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
    const which = asks && state.asks_at === MID && state.mid; // the mid level asks which way
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
    const nowhere = which && state.nearest !== null && state.distance === null; // it was set down elsewhere
    const untaught = nowhere ? "goals: touch “is here”" : which ? "touch the way that is right here" : "touch the action that is right here";
    setText(this.#nearest, known ? `nearest: ${rla} ${state.nearest}, ${its}` : untaught);
    const value = state.value === null || state.phase < VALUES_FROM_PHASE ? "" : ` · worth ${signed(state.value)}`;
    const off = which ? differs(state, hello.mid) : known ? `${state.distance.toFixed(0)} of R ${state.radius.toFixed(0)}${value}` : "no RLA yet";
    setText(this.#text, off);
    this.#surprise(state);
    this.#trace.see(state.tick, known && !which ? share : null);
    if (!asks) this.#shownMs = -Infinity; // the next question is shown at once
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

  // What the robot has come by, and below it the way that the nearest mid-level RLA knows.
  #compare(mid, introduced) {
    const key = JSON.stringify([introduced, mid.here, mid.there]);
    if (key === this.#shown) return;
    this.#shown = key;
    this.#differences.replaceChildren(...strip(mid.here, mid.there, introduced));
  }

  // Each sensor that makes a difference, by its place: what it reads here and what it read when that was taught.
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
