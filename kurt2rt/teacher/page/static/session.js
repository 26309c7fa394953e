// Training phase, behaviour to follow, session and teacher.

import { words } from "./actions.js";
import { twice } from "./lessons.js";
import { text } from "./texts.js";
import { setText } from "./decision.js";

const PHASES = ["Supervised", "Corrections", "Reinforcement", "Critic", "Autonomous"];
const AUTONOMOUS = 5;
const PHASES_SAY = PHASES.map((_, i) => text(`phase${i + 1}`));

const $ = (id) => document.getElementById(id);

function namesOf(phases) {
  return PHASES.map((name, i) => {
    const given = phases?.[i];
    return typeof given === "string" && given ? given[0].toUpperCase() + given.slice(1) : name;
  });
}

function newSession() {
  const two = (number) => String(number).padStart(2, "0");
  const now = new Date();
  return `${now.getFullYear()}-${two(now.getMonth() + 1)}-${two(now.getDate())} ${two(now.getHours())}:${two(now.getMinutes())}`;
}

const LESSON_SPEEDS = [100, 80, 60, 40, 20]; // in per cent

function lessonSpeed(percent) {
  return new Option(percent === 100 ? "full" : `${percent} %`, String(percent));
}

export class SessionPanel {
  #sendCommand;
  #session = null; // name of the present session
  phaseNames = PHASES;

  // `sendCommand` resolves with the answer.
  constructor(sendCommand) {
    this.#sendCommand = sendCommand;
    $("session-button").addEventListener("click", () => this.#beginOrEnd());
    $("hand-over").addEventListener("click", () => sendCommand("/release", { to: null }, "hand over"));
    $("lesson-speed").replaceChildren(...LESSON_SPEEDS.map(lessonSpeed));
    $("lesson-speed").addEventListener("input", () => {
      sendCommand("/lesson/speed", { percent: Number($("lesson-speed").value) }, "lesson speed");
    });
  }

  build(hello) {
    this.phaseNames = namesOf(hello.phases);
    $("phases").replaceChildren(...this.phaseNames.map((name, i) => this.#phase(i + 1, name)));
    $("behaviours").hidden = hello.behaviours.length < 2 || Boolean(hello.mid); // the mid level's buttons have them
    $("behaviours").replaceChildren(...hello.behaviours.map((name) => this.#behaviour(name)));
  }

  show(state, inCharge) {
    for (const button of $("phases").children) {
      button.setAttribute("aria-pressed", String(Number(button.dataset.phase) === state.phase));
    }
    for (const button of $("behaviours").children) {
      button.setAttribute("aria-pressed", String(button.dataset.behaviour === state.behaviour));
    }
    setText($("phase-says"), PHASES_SAY[state.phase - 1] ?? "");
    const speed = $("lesson-speed");
    const percent = String(Math.round(100 * state.lesson_speed));
    if (![...speed.options].some((option) => option.value === percent)) speed.append(lessonSpeed(Number(percent)));
    if (document.activeElement !== speed) speed.value = percent;
    speed.disabled = !inCharge;
    this.#session = state.session;
    setText($("session-button"), state.session === null ? "Begin" : "End");
    const name = $("session-name");
    name.disabled = state.session !== null;
    if (state.session !== null) name.value = state.session;
    else if (!name.value) name.value = newSession();
    setText($("who"), state.teacher === null ? "no teacher" : state.yours ? "You teach" : `${state.teacher} teaches`);
    $("hand-over").disabled = !inCharge;
    $("take-here").disabled = inCharge;
  }

  #phase(number, name) {
    const button = document.createElement("button");
    button.type = "button";
    button.dataset.phase = number;
    button.title = PHASES_SAY[number - 1] ?? "";
    const digit = document.createElement("b");
    digit.textContent = `${number} `;
    const label = document.createElement("small");
    label.className = "word";
    label.textContent = name;
    button.append(digit, label);
    const setPhase = () => this.#sendCommand("/phase", { phase: number }, `phase ${number}`);
    // Phase 5 needs a second tap: from then on the robot drives without supervision.
    if (number === AUTONOMOUS) twice(button, "sure?", setPhase);
    else button.addEventListener("click", setPhase);
    return button;
  }

  // Button of one behaviour, for a task of several.
  #behaviour(name) {
    const button = document.createElement("button");
    button.type = "button";
    button.dataset.behaviour = name;
    button.textContent = words(name);
    button.addEventListener("click", () => this.#sendCommand("/pursue", { behaviour: name }, words(name)));
    return button;
  }

  async #beginOrEnd() {
    if (this.#session !== null) {
      const answer = await this.#sendCommand("/session/end", {}, "end session");
      if (answer.accepted) $("session-name").value = newSession();
    } else {
      this.#sendCommand("/session/begin", { name: $("session-name").value.trim() || newSession() }, "begin session");
    }
  }
}
