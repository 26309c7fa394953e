// Goals: named places, the goal that the robot seeks, and its status.

import { twice } from "./lessons.js";
import { setText } from "./decision.js";
import { words } from "./actions.js";

const $ = (id) => document.getElementById(id);

export class Goals {
  #sendCommand;
  #names = "";
  #goal = null;

  // `sendCommand` resolves with the answer.
  constructor(sendCommand) {
    this.#sendCommand = sendCommand;
    $("name-situation").addEventListener("click", () => this.#name());
    $("stop-seeking").addEventListener("click", () => sendCommand("/seek/stop", {}, "stop seeking"));
  }

  build(hello) {
    $("tab-goals").hidden = !hello.seeks;
    document.body.classList.toggle("seeks", hello.seeks);
  }

  list(names) {
    const key = JSON.stringify(names);
    if (key === this.#names) return;
    this.#names = key;
    if (!names.length) {
      const none = document.createElement("li");
      none.textContent = "No place has a name yet. Name the place where the robot is.";
      $("goal-list").replaceChildren(none);
      return;
    }
    $("goal-list").replaceChildren(...names.map((name) => this.#row(name)));
    this.#mark();
  }

  show(state) {
    setText($("goal-now"), state.goal ? state.plan_says || `seeks ${state.goal}` : "no goal");
    setText($("plan"), state.plan.length ? `then ${state.plan.map(words).join(", ")}` : "");
    $("stop-seeking").disabled = !state.goal;
    if (state.goal === this.#goal) return;
    this.#goal = state.goal;
    this.#mark();
  }

  #mark() {
    for (const row of $("goal-list").children) row.classList.toggle("sought", row.dataset.name === this.#goal);
  }

  #row(name) {
    const row = document.createElement("li");
    row.dataset.name = name;
    const label = document.createElement("span");
    const what = document.createElement("b");
    what.textContent = name;
    label.append(what);
    const here = document.createElement("button");
    here.type = "button";
    here.textContent = "Is here";
    here.setAttribute("aria-label", `Is here: the robot stands at ${name}`);
    twice(here, "Sure?", () => this.#sendCommand("/here", { name }, `robot is at ${name}`));
    const seek = document.createElement("button");
    seek.type = "button";
    seek.textContent = "Seek";
    seek.setAttribute("aria-label", `Seek ${name}`);
    seek.addEventListener("click", () => this.#sendCommand("/seek", { goal: name }, `seek ${name}`));
    row.append(label, here, seek);
    return row;
  }

  async #name() {
    const name = $("situation-name").value.trim();
    if (!name) {
      $("situation-name").focus();
      return;
    }
    const answer = await this.#sendCommand("/name", { name }, `this is ${name}`);
    if (answer.accepted) $("situation-name").value = "";
  }
}
