// Goals: places that have a name, where the robot is sent to, and how it stands with that.

import { twice } from "./lessons.js";
import { setText } from "./why.js";
import { words } from "./actions.js";

const $ = (id) => document.getElementById(id);

export class Goals {
  #tell;
  #names = "";
  #goal = null;

  // `tell` gives an order and resolves with its answer.
  constructor(tell) {
    this.#tell = tell;
    $("name-situation").addEventListener("click", () => this.#name());
    $("stop-seeking").addEventListener("click", () => tell("stop_seeking", {}, "stop seeking"));
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
      none.textContent = "No place has a name yet: name the one where the robot is.";
      $("goal-list").replaceChildren(none);
      return;
    }
    $("goal-list").replaceChildren(...names.map((name) => this.#row(name)));
    this.#mark();
  }

  show(state) {
    setText($("goal-now"), state.goal ? state.plan_says || `seeks ${state.goal}` : "seeks nothing");
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
    twice(here, "Sure?", () => this.#tell("be_at", { name }, `it is at ${name}`));
    const seek = document.createElement("button");
    seek.type = "button";
    seek.textContent = "Seek";
    seek.setAttribute("aria-label", `Seek ${name}`);
    seek.addEventListener("click", () => this.#tell("seek", { name }, `seek ${name}`));
    row.append(label, here, seek);
    return row;
  }

  async #name() {
    const name = $("situation-name").value.trim();
    if (!name) {
      $("situation-name").focus();
      return;
    }
    const answer = await this.#tell("name", { name }, `this is ${name}`);
    if (answer.accepted) $("situation-name").value = "";
  }
}
