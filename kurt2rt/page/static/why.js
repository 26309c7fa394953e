// Who moves the wheels and why: a sentence, the distance against R, and while it asks, what is different.

import { words } from "./actions.js";
import { Trace } from "./trace.js";

const MONTHS = ["Jan", "Feb", "Mar", "Apr", "May", "Jun", "Jul", "Aug", "Sep", "Oct", "Nov", "Dec"];
export const WITHDRAWN = "ask"; // the action of an RLA whose action was withdrawn
const VALUES_FROM_PHASE = 3;
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

export function sentence(state) {
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
      if (state.nearest_action === WITHDRAWN && state.distance <= state.radius) {
        return `RLA ${state.nearest}${of(state)} went wrong too often, teach me anew`;
      }
      return state.nearest === null ? `I know nothing${of(state)} yet, teach me` : "I don't know this situation, teach me";
    case "stopped":
      return `Stands: ${state.stopped_because || "stopped"}. GO lets it drive on`;
    case "unattended":
      return "Stands: no teacher looks at it";
    case "blind":
      return "Stands: its infra-red sensors are silent";
    case "unsaved":
      return "Stands: lessons cannot be saved";
    default:
      return `Stands: ${words(state.cause)}`;
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

  show(state) {
    const asks = state.cause === "unknown";
    this.#box.classList.toggle("asks", asks);
    setText(this.#sentence, sentence(state));
    const known = state.nearest !== null && state.distance !== null && state.radius > 0;
    const share = known ? state.distance / state.radius : 0;
    this.#gauge.classList.toggle("beyond", share > 1);
    this.#gauge.classList.toggle("none", !known);
    this.#fill.style.width = `${Math.min(1, share * GAUGE_SHARE) * 100}%`;
    const its = state.nearest_action === WITHDRAWN ? "its action was withdrawn" : words(state.nearest_action ?? "–");
    setText(this.#nearest, known ? `nearest: RLA ${state.nearest}, ${its}` : "touch the action that is right here");
    const value = state.value === null || state.phase < VALUES_FROM_PHASE ? "" : ` · worth ${signed(state.value)}`;
    setText(this.#text, known ? `${state.distance.toFixed(0)} of R ${state.radius.toFixed(0)}${value}` : "no RLA yet");
    this.#trace.see(state.tick, known ? share : null);
    if (asks) this.#show(state.question);
    else this.#trace.draw();
  }

  // Pairs of bars: dark is here, hollow is the nearest RLA's condition.
  #show(question) {
    const key = JSON.stringify(question.map(([name, here, there]) => [name, Math.round(here), Math.round(there)]));
    if (key === this.#shown) return;
    this.#shown = key;
    const most = Math.max(1, ...question.flatMap(([, here, there]) => [Math.abs(here), Math.abs(there)]));
    this.#differences.replaceChildren(
      ...question.map(([name, here, there]) => {
        const pair = document.createElement("div");
        pair.className = "pair";
        pair.title = `${name}: ${here.toFixed(0)} here, ${there.toFixed(0)} there`;
        pair.setAttribute("role", "img");
        pair.setAttribute("aria-label", pair.title);
        const bars = document.createElement("div");
        for (const [kind, value] of [["here", here], ["there", there]]) {
          const bar = document.createElement("i");
          bar.className = kind;
          bar.style.height = `${Math.max(3, (Math.abs(value) / most) * 100)}%`;
          bars.append(bar);
        }
        const label = document.createElement("small");
        label.textContent = short(name);
        pair.append(bars, label);
        return pair;
      }),
    );
  }
}

function signed(value) {
  return (Math.round(value * 100) / 100 || 0).toFixed(2).replace("-", "−"); // never −0.00
}

function short(name) {
  return name
    .replace(" (10 s average)", " ø")
    .replace("maximum", "max")
    .replace("minimum", "min")
    .replace(/^orientation \w+ /, "")
    .replace("wheel speed", "wheel");
}

export function setText(element, text) {
  if (element.textContent !== text) element.textContent = text;
}
