// Explanation of the newest decision, asked of the robot when its sentence is touched.

import { setText } from "./decision.js";

const $ = (id) => document.getElementById(id);

export class Explanation {
  #link;

  constructor(link) {
    this.#link = link;
    $("why").addEventListener("click", () => this.toggle());
    $("close-explanation").addEventListener("click", () => $("explanation").close());
    $("explain-again").addEventListener("click", () => this.#ask());
  }

  toggle() {
    const table = $("explanation");
    if (table.open) return table.close();
    for (const other of document.querySelectorAll("dialog[open]")) other.close();
    table.show(); // not modal, so that STOP and GO stay free
    this.#ask();
  }

  async #ask() {
    const answer = await this.#link.why();
    setText($("explanation-says"), answer.text);
    $("explanation-lines").replaceChildren(...(answer.lines ?? []).map((text) => element("p", text)));
    const features = answer.features ?? [];
    $("explanation-features").hidden = features.length === 0;
    $("explanation-features").replaceChildren(
      row("th", "of the distance", "here", answer.rla ?? "", ""),
      ...features.map(({ name, here, there, share }) => {
        const line = row("td", name, here, there, `${Math.round(share * 100)} %`);
        line.lastChild.style.setProperty("--share", share);
        return line;
      }),
    );
  }
}

function element(kind, text) {
  const made = document.createElement(kind);
  made.textContent = text;
  return made;
}

function row(kind, ...texts) {
  const line = document.createElement("tr");
  line.append(...texts.map((text) => element(kind, text)));
  return line;
}
