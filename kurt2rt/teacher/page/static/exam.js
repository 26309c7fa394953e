// Exam of a simulated robot: started here, driven by another process of the robot's program, shown as a picture.

import { setText } from "./decision.js";

const $ = (id) => document.getElementById(id);

export class Exam {
  #sendCommand;
  #running = false;
  #own = false; // started from this page: its result opens by itself
  #shown = "";

  // `sendCommand` resolves with the answer.
  constructor(sendCommand) {
    this.#sendCommand = sendCommand;
    $("examine").addEventListener("click", () => this.begin());
    $("show-exam").addEventListener("click", () => $("exam-result").show()); // not modal: STOP and GO stay free
    $("close-exam").addEventListener("click", () => $("exam-result").close());
  }

  build(hello) {
    $("exam").hidden = !hello.simulated;
  }

  update(exam) {
    this.#running = exam.running;
    $("examine").disabled = exam.running;
    $("exam-progress").hidden = !exam.running;
    $("exam-progress").value = exam.share;
    const share = Math.round(exam.share * 100);
    setText($("exam-says"), exam.running ? `${share} %: ${exam.text}` : exam.trouble || exam.text || "No exam yet.");
    $("show-exam").hidden = exam.running || !exam.picture;
    if (exam.running || !exam.picture || exam.picture === this.#shown) return;
    this.#shown = exam.picture;
    this.#fill(exam);
    if (this.#own) $("exam-result").show();
    this.#own = false;
  }

  // True if the robot may be examined now.
  get available() {
    return !$("exam").hidden && !this.#running;
  }

  async begin() {
    const answer = await this.#sendCommand("/exam", {}, "exam");
    this.#own = answer.accepted;
  }

  #fill(exam) {
    setText($("exam-verdict"), exam.text);
    $("exam-worlds").replaceChildren(
      ...exam.verdicts.map(({ world, passed, text, judged }) => {
        const row = document.createElement("li");
        const verdict = document.createElement("b");
        verdict.textContent = `World ${world}: ${judged === false ? "not judged" : passed ? "passed" : "failed"}`;
        const told = document.createElement("span");
        told.textContent = text;
        row.append(verdict, told);
        return row;
      }),
    );
    const picture = $("exam-picture");
    picture.alt = `Floor plans with the robot's drive in blue and the teacher's own in grey. ${exam.text}`;
    picture.src = `/files/${encodeURIComponent(exam.picture)}`;
  }
}
