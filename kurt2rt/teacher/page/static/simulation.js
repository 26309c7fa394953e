// Menu of a simulated robot: world, task, speed, start again.

import { words } from "./actions.js";
import { twice } from "./lessons.js";
import { setText } from "./decision.js";
import { text } from "./texts.js";

const $ = (id) => document.getElementById(id);
const FASTEST = 10;
const HIGHEST_NUMBER = 999999999;
const KEEPS_UP = 0.9; // share of the chosen speed that a computer which holds it reaches
const SLOW_MS = 3000;

export class Simulation {
  #sendCommand;
  #showMessage;
  #inControl;
  #slowMs = null; // since when the computer does not hold the speed; null: it does
  #run = ""; // world, task and their alternatives, as displayed
  simulation = null; // newest report

  // `sendCommand` resolves with the answer.
  constructor({ sendCommand, showMessage, inControl }) {
    this.#sendCommand = sendCommand;
    this.#showMessage = showMessage;
    this.#inControl = inControl;
    for (const id of ["sim-world", "sim-number", "sim-task"]) $(id).addEventListener("input", () => this.#showChoice());
    $("sim-change").addEventListener("click", () => this.#change());
    const speeds = Array.from({ length: FASTEST }, (_, i) => i + 1);
    $("sim-speed").replaceChildren(...speeds.map((times) => option(String(times), times === 1 ? "Real time" : `${times} times as fast`)));
    $("sim-speed").addEventListener("input", () => sendCommand("/simulation/speed", { times: Number($("sim-speed").value) }, "speed"));
    $("sim-back").addEventListener("click", () => sendCommand("/world/start", {}, "back to the start"));
    const fresh = () => sendCommand("/simulation/run", { world: null, task: null, fresh: true }, "a new knowledge file");
    twice($("sim-fresh"), "Sure? The old file is kept", fresh);
  }

  build(hello) {
    $("simulation").hidden = !hello.simulated;
    this.simulation = null;
  }

  update(simulation) {
    this.simulation = simulation;
    const { world, task, speed } = simulation;
    $("sim-speed").value = String(speed);
    this.#keepUp(simulation);
    // A choice in progress is kept although the speed is reported each second.
    const run = JSON.stringify([world, task, simulation.worlds, simulation.tasks]);
    if (run === this.#run) return;
    this.#run = run;
    const number = world.match(/-(\d+)$/)?.[1];
    const listed = world.replace(/-\d+$/, "-N");
    const generated = simulation.worlds.includes(listed) && listed !== world;
    const all = simulation.worlds.includes(listed) ? simulation.worlds : [world, ...simulation.worlds];
    $("sim-world").replaceChildren(...all.map((name) => option(name, worldTitle(name))));
    $("sim-world").value = generated ? listed : world;
    if (generated) $("sim-number").value = number;
    const tasks = simulation.tasks.map((each) => each.name);
    const known = tasks.includes(task) ? tasks : [task, ...tasks];
    $("sim-task").replaceChildren(...known.map((name) => option(name, words(name))));
    $("sim-task").value = task;
    this.#showChoice();
  }

  // Goes back to a speed that this computer holds, and says so.
  async #keepUp({ speed, reached }) {
    if (speed === 1 || reached >= KEEPS_UP * speed) this.#slowMs = null;
    else this.#slowMs ??= performance.now();
    if (this.#slowMs === null || performance.now() - this.#slowMs < SLOW_MS || !this.#inControl()) return;
    this.#slowMs = null;
    const times = Math.max(1, Math.floor(reached));
    const answer = await this.#sendCommand("/simulation/speed", { times }, "speed");
    const holds = times === 1 ? "real time" : `${times} times real time`;
    if (answer.accepted) this.#showMessage("saved", text("speedHeld", { speed, holds }));
  }

  get #world() {
    const chosen = $("sim-world").value;
    return chosen.replace(/-N$/, `-${Number($("sim-number").value)}`);
  }

  #showChoice() {
    if (!this.simulation) return;
    const { world, task, tasks } = this.simulation;
    const generated = $("sim-world").value.endsWith("-N"); // such as rooms, for any whole number
    $("sim-number").hidden = !generated;
    const number = Number($("sim-number").value);
    const valid = !generated || ($("sim-number").value !== "" && Number.isInteger(number) && number >= 0 && number <= HIGHEST_NUMBER);
    const chosen = $("sim-task").value;
    setText($("sim-what"), tasks.find((each) => each.name === chosen)?.what ?? "");
    $("sim-change").disabled = !valid || (this.#world === world && chosen === task);
  }

  #change() {
    const { world, task } = this.simulation;
    const chosen = $("sim-task").value;
    // Without a chosen world, the task brings its own.
    const args = { world: this.#world === world ? null : this.#world, task: chosen === task ? null : chosen, fresh: false };
    this.#sendCommand("/simulation/run", args, "the next run");
  }
}

function worldTitle(name) {
  if (name.endsWith("-N")) return `${name[0].toUpperCase()}${name.slice(1, -2)} no.`;
  return `World ${name.length === 1 ? name.toUpperCase() : words(name)}`;
}

function option(value, text) {
  const made = document.createElement("option");
  made.value = value;
  made.textContent = text;
  return made;
}
