// The inner critic: buttons that teach it, its opinion, its agreement with the teacher, its last change.

import { words } from "./actions.js";
import { setText, when } from "./decision.js";

export const CRITIC = "critic"; // its name as a teacher
const TAUGHT_IN = 4;
const SIGNS = { [-1]: "−", 0: "0", 1: "+" };
const CALM_MS = 400; // the opinion may change with every state, too fast to read

const $ = (id) => document.getElementById(id);

function missing([bad, good]) {
  const parts = [bad && `${bad} bad`, good && `${good} good`].filter(Boolean);
  return parts.join(" and ");
}

// Returns its agreement with the teacher in words.
export function agreement(state, trustedFrom) {
  if (state.agreement === null) {
    return `needs ${missing(state.signals_missing) || "a few"} signals from you`;
  }
  const share = (Math.floor(state.agreement * 100) / 100).toFixed(2); // rounded down, so that it does not show a bound that it misses
  return state.trusted ? `agrees with you ${share}` : `agrees ${share}, needs ${trustedFrom.toFixed(2)}`;
}

// Returns its activity in phase 5; empty while it only listens.
export function role({ role, bad_share: bad }) {
  const percent = Math.floor((bad ?? 0) * 100); // rounded down, so that it does not show the bound from which on it is needed
  switch (role) {
    case "listens":
      return "";
    case "measures":
      return "measures the driving";
    case "not needed":
      return `not needed: ${percent} % of the driving was bad`;
    default:
      return role;
  }
}

export function lastChange(lesson) {
  if (!lesson) return "has changed nothing lately";
  return `${lesson.undone ? "undone" : "changed last"}: ${[lesson.text, when(lesson.stamp)].filter(Boolean).join(", ")}`;
}

export class Critic {
  #choose;
  #names = []; // [{ name, value }], the worst first
  #trustedFrom = 1;
  #buttons = new Map();
  #opinion = { text: "", sinceMs: -Infinity };

  constructor(choose) {
    this.#choose = choose;
  }

  build({ appraisals, trusted_from: trustedFrom }) {
    this.#trustedFrom = trustedFrom;
    this.#names = appraisals.map(([name, value]) => ({ name, value })).sort((one, other) => one.value - other.value);
    this.#buttons.clear();
    $("appraisals").replaceChildren(...this.#names.map((each) => this.#button(each)));
    $("agreement-mark").style.left = `${trustedFrom * 100}%`;
    $("key-neutral").hidden = $("key-neutral").previousElementSibling.hidden = !this.#names.length;
  }

  #button({ name, value }) {
    const button = document.createElement("button");
    button.type = "button";
    button.dataset.appraisal = name;
    button.title = `Teach the critic: this was ${words(name)}`;
    const sign = document.createElement("b");
    sign.textContent = SIGNS[value];
    const label = document.createElement("small");
    label.textContent = words(name);
    button.append(sign, label);
    button.addEventListener("click", () => this.#choose(name));
    this.#buttons.set(name, button);
    return button;
  }

  // Returns whether the buttons teach the critic.
  teaches(state) {
    return this.#names.length > 0 && state.phase === TAUGHT_IN;
  }

  nameOf(value) {
    return this.#names.find((each) => each.value === value)?.name;
  }

  show(state, lesson) {
    const seen = this.#names.length > 0 && state.phase >= TAUGHT_IN;
    $("critic").hidden = !seen;
    $("rewards").classList.toggle("appraises", this.teaches(state));
    if (!seen) return;
    this.#showOpinion(state);
    const known = state.agreement !== null;
    $("trust").className = !known ? "unknown" : state.trusted ? "trusted" : "low";
    setText($("trusted"), state.trusted ? "trusted" : state.phase > TAUGHT_IN ? "only listens" : "not trusted yet");
    $("agreement-fill").style.width = `${(state.agreement ?? 0) * 100}%`;
    setText($("agreement-text"), agreement(state, this.#trustedFrom));
    const does = role(state);
    $("role").hidden = !does;
    setText($("role"), does);
    $("changed").hidden = state.phase === TAUGHT_IN;
    setText($("changed"), lastChange(lesson));
  }

  #showOpinion({ opinion, opinion_of: rla }) {
    const name = this.nameOf(opinion);
    const text = `critic: ${name === undefined ? "does not know this" : `thinks ${words(name)}`}`;
    const nowMs = performance.now();
    if (text === this.#opinion.text || nowMs - this.#opinion.sinceMs < CALM_MS) return;
    this.#opinion = { text, sinceMs: nowMs };
    setText($("opinion"), text);
    $("opinion").title = rla === null ? "" : `appraisal RLA ${rla}`;
    for (const [each, button] of this.#buttons) button.classList.toggle("current", each === name);
  }
}
