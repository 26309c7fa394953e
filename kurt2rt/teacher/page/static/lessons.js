// The last lessons, each with an undo button that needs a second tap.

import { words } from "./actions.js";
import { when } from "./decision.js";
import { text } from "./texts.js";

const SURE_MS = 3000;

// Makes a button act on its second tap within three seconds; `asked` is called at the first.
export function twice(button, question, act, asked = () => {}) {
  const label = button.querySelector(".word") ?? button;
  const first = label.textContent;
  let timer = null;
  const reset = () => {
    clearTimeout(timer);
    timer = null;
    label.textContent = first;
    button.classList.remove("sure");
  };
  button.addEventListener("click", () => {
    if (timer === null) {
      label.textContent = question;
      button.classList.add("sure");
      timer = setTimeout(reset, SURE_MS);
      asked();
    } else {
      reset();
      act();
    }
  });
}

export class Lessons {
  #list = document.getElementById("lesson-list");
  #undo;
  #lessons = null;
  #device = "";
  after = 0; // number of the newest command whose lesson is in the list

  constructor(undo) {
    this.#undo = undo;
  }

  // The newest valid lesson; undefined without one.
  get newest() {
    return this.#lessons?.find((lesson) => !lesson.undone);
  }

  // Returns the newest listed lesson of a teacher; undefined without one.
  newestOf(teacher) {
    return this.#lessons?.find((lesson) => lesson.teacher === teacher);
  }

  // `device`: name of this page's device.
  show(lessons, after, device) {
    this.after = after;
    this.#device = device;
    if (JSON.stringify(lessons) === JSON.stringify(this.#lessons)) return; // a first tap on Undo is not forgotten
    this.#lessons = lessons;
    if (!lessons.length) {
      const none = document.createElement("li");
      none.textContent = "No lessons yet.";
      this.#list.replaceChildren(none);
      return;
    }
    const rows = (lesson) => [this.#row(lesson), ...lesson.against.map((each) => this.#contradiction(each))];
    this.#list.replaceChildren(...lessons.flatMap(rows));
  }

  // A lesson that none of its neighbours agrees with; it can be undone alone, also if a hold gave it.
  #contradiction({ command_id: id, rla, action, nearest, actions }) {
    const row = document.createElement("li");
    row.className = "contradicts";
    const told = document.createElement("span");
    told.textContent = text("contradicts", { rla, action: words(action), others: actions.map(words).join(", "), nearest });
    row.append(told, this.#undoButton(id, `RLA ${rla}, ${words(action)}`));
    return row;
  }

  #undoButton(id, of) {
    const button = document.createElement("button");
    button.type = "button";
    button.textContent = "Undo";
    button.setAttribute("aria-label", `Undo: ${of}`);
    twice(button, "Sure?", () => this.#undo(id));
    return button;
  }

  #row({ command_id: id, text: lesson, teacher, phase, stamp, undone }) {
    const row = document.createElement("li");
    row.classList.toggle("undone", undone);
    const told = document.createElement("span");
    const what = document.createElement("b");
    what.textContent = words(lesson);
    const who = document.createElement("small");
    who.textContent = [teacher === this.#device ? "you" : teacher, `phase ${phase}`, when(stamp) || "not saved yet"].join(" · ");
    told.append(what, who);
    row.append(told);
    if (undone) {
      const mark = document.createElement("em");
      mark.textContent = "undone";
      row.append(mark);
    } else {
      row.append(this.#undoButton(id, lesson));
    }
    return row;
  }
}
