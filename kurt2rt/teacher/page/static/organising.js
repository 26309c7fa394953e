// What organises a lesson: training phase, the behaviour to follow, session, who teaches.

import { words } from "./actions.js";
import { twice } from "./lessons.js";
import { setText } from "./why.js";

const PHASES = ["Supervised", "Corrections", "Reinforcement", "Critic", "Autonomous"];
const AUTONOMOUS = 5;
// What each phase changes.
const PHASES_SAY = [
  "Where it knows nothing it stands and asks; your answer is a rule.",
  "It drives by its rules, and you also correct it while it drives.",
  "Right and wrong change what its rules are worth; one that is worth too little is asked for again.",
  "Right and wrong teach its critic to judge by itself.",
  "It drives without a teacher and asks nobody; a critic that is trusted repairs its rules.",
];

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

export class Organising {
  #tell;
  #session = null; // name of the one that is on
  phaseNames = PHASES;

  // `tell` gives an order and resolves with its answer.
  constructor(tell) {
    this.#tell = tell;
    $("session-button").addEventListener("click", () => this.#beginOrEnd());
    $("hand-over").addEventListener("click", () => tell("hand_over", { to: null }, "hand over"));
  }

  build(hello) {
    this.phaseNames = namesOf(hello.phases);
    $("phases").replaceChildren(...this.phaseNames.map((name, i) => this.#phase(i + 1, name)));
    $("behaviours").hidden = hello.behaviours.length < 2 || Boolean(hello.mid); // then the mid level's pad has them
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
    this.#session = state.session;
    setText($("session-button"), state.session === null ? "Begin" : "End");
    const name = $("session-name");
    name.disabled = state.session !== null;
    if (state.session !== null) name.value = state.session;
    else if (!name.value) name.value = newSession();
    setText($("who"), state.teacher === null ? "nobody teaches" : `${state.teacher} teaches`);
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
    const enter = () => this.#tell("phase", { phase: number }, `phase ${number}`);
    // From then on it drives with nobody looking: not by a slip of the thumb.
    if (number === AUTONOMOUS) twice(button, "sure?", enter);
    else button.addEventListener("click", enter);
    return button;
  }

  // What the robot is to follow, where a task teaches several behaviours.
  #behaviour(name) {
    const button = document.createElement("button");
    button.type = "button";
    button.dataset.behaviour = name;
    button.textContent = words(name);
    button.addEventListener("click", () => this.#tell("pursue", { behaviour: name }, words(name)));
    return button;
  }

  async #beginOrEnd() {
    if (this.#session !== null) {
      const answer = await this.#tell("end_session");
      if (answer.accepted) $("session-name").value = newSession();
    } else {
      this.#tell("begin_session", { name: $("session-name").value.trim() || newSession() });
    }
  }
}
