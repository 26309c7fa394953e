// Health of the robot's program: a dot in the bar, which opens a table; a fault has its name there, in colour.

import { setText } from "./decision.js";

const OLD_TICKS = 500; // a report is made each second

const $ = (id) => document.getElementById(id);

export class Health {
  #report = null;
  #shown = null;

  constructor() {
    const table = $("health-table");
    $("link").addEventListener("click", () => (table.open ? table.close() : this.#open(table)));
    $("close-health").addEventListener("click", () => table.close());
  }

  // Takes the report of the last second, in the robot's own words.
  update(report) {
    this.#report = report;
    setText($("rules"), report.rules);
    if ($("health-table").open) this.#fill();
  }

  // Shows the name of the worst fault, next to the dot.
  show(state) {
    const troubles = this.#report?.troubles ?? [];
    const old = Boolean(this.#report?.tick) && state.tick - this.#report.tick > OLD_TICKS;
    const line = $("health");
    line.classList.toggle("warns", troubles.length > 0 || old);
    line.classList.toggle("urgent", troubles.some(({ urgent }) => urgent));
    setText(line, old ? "no report" : named(troubles) ?? "");
  }

  // Returns the faults that stop the robot or put lessons at risk, without the one in the state itself.
  urgent(state) {
    const troubles = this.#report?.troubles ?? [];
    return troubles.filter(({ what, urgent }) => urgent && !state.trouble.includes(what)).map(({ what }) => what);
  }

  // Not modal, so that STOP and GO stay free.
  #open(table) {
    this.#fill();
    for (const other of document.querySelectorAll("dialog[open]")) other.close();
    table.show();
  }

  #fill() {
    const report = this.#report;
    if (report === this.#shown) return;
    this.#shown = report;
    setText($("health-says"), report?.says || "no report yet");
    $("health-troubles").replaceChildren(
      ...(report?.troubles ?? []).map(({ text, urgent }) => {
        const line = document.createElement("li");
        line.className = urgent ? "urgent" : "warns";
        line.textContent = text;
        return line;
      }),
    );
    $("health-rows").replaceChildren(
      ...(report?.rows ?? []).flatMap(({ name, text, level }) => {
        const [subject, words] = [document.createElement("dt"), document.createElement("dd")];
        subject.textContent = name;
        words.textContent = text;
        words.className = level;
        return [subject, words];
      }),
    );
  }
}

// Returns the name of the first and worst fault; dots if there are faults of other kinds.
function named(troubles) {
  const names = new Set(troubles.map(({ name }) => name));
  const [worst] = names;
  return names.size > 1 ? `${worst}, …` : worst;
}
