// How the robot's program is: a small line in the bar, which opens to a table; what is wrong is in colour.

import { setText } from "./why.js";

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

  // The report of the last second, in the robot's own words.
  see(report) {
    this.#report = report;
    if ($("health-table").open) this.#fill();
  }

  // The line in the bar: how late the loop is, or what is wrong, the worst by its name.
  show(state) {
    const troubles = this.#report?.troubles ?? [];
    const old = Boolean(this.#report?.tick) && state.tick - this.#report.tick > OLD_TICKS;
    const [line, missed] = [$("health"), $("missed")];
    line.classList.toggle("warns", troubles.length > 0 || old);
    line.classList.toggle("urgent", troubles.some(({ urgent }) => urgent));
    const late = `late ${state.late_p99_ms?.toFixed(state.late_p99_ms < 1 ? 2 : 1) ?? "–"} ms`;
    setText($("late"), old ? "no report" : named(troubles) || late);
    setText(missed, troubles.length || old ? "" : `, missed ${state.missed_ticks}`);
  }

  // What is wrong for which the robot stands, or that puts lessons at risk, but for what the picture says itself.
  urgent(state) {
    const troubles = this.#report?.troubles ?? [];
    return troubles.filter(({ what, urgent }) => urgent && !state.trouble.includes(what)).map(({ what }) => what);
  }

  // Not modal: STOP and GO stay free.
  #open(table) {
    this.#fill();
    for (const other of document.querySelectorAll("dialog[open]")) other.close();
    table.show();
  }

  #fill() {
    const report = this.#report;
    if (report === this.#shown) return;
    this.#shown = report;
    setText($("health-says"), report?.says || "nothing is known yet");
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

// The first trouble, which is the worst; dots for more that are not of its kind.
function named(troubles) {
  const names = new Set(troubles.map(({ name }) => name));
  const [worst] = names;
  return names.size > 1 ? `${worst}, …` : worst;
}
