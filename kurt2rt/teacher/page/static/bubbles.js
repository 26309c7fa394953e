// Three bubbles of help: on the first visit, and after a touch of "?". They block nothing.

import { setText } from "./decision.js";
import { text } from "./texts.js";

const KEY = "kurt2rt.bubbles";
const GAP_PX = 6;
const BUBBLES = [
  ["why", "bubbleWhy"],
  ["panel", "bubblePanel"],
  ["stop-bar", "bubbleStop"],
];

const $ = (id) => document.getElementById(id);

export class Bubbles {
  #shown = -1; // index of the visible bubble; -1: none

  constructor() {
    $("show-bubbles").addEventListener("click", () => this.#show(0));
    $("bubble-close").addEventListener("click", () => this.#end());
    $("bubble-next").addEventListener("click", () => (this.#shown + 1 < BUBBLES.length ? this.#show(this.#shown + 1) : this.#end()));
    addEventListener("resize", () => this.#place());
    new ResizeObserver(() => this.#place()).observe($("stage"));
    if (!wasSeen()) this.#show(0);
  }

  #show(number) {
    this.#point(false);
    this.#shown = number;
    this.#point(true);
    setText($("bubble-text"), text(BUBBLES[number][1]));
    setText($("bubble-number"), `${number + 1} of ${BUBBLES.length}`);
    setText($("bubble-next"), number + 1 < BUBBLES.length ? "Next" : "Done");
    $("bubble").hidden = false;
    this.#place();
  }

  #end() {
    this.#point(false);
    this.#shown = -1;
    $("bubble").hidden = true;
    try {
      localStorage.setItem(KEY, "seen");
    } catch {
      // Storage is forbidden: the bubbles come again with the next visit.
    }
  }

  #point(on) {
    if (this.#shown >= 0) $(BUBBLES[this.#shown][0]).classList.toggle("pointed-at", on);
  }

  // Places the bubble over the lower end of the picture, which has no buttons.
  #place() {
    if (this.#shown < 0) return;
    const stage = $("stage").getBoundingClientRect();
    const bubble = $("bubble").style;
    bubble.left = `${stage.left + GAP_PX}px`;
    bubble.width = `${Math.min(stage.width - 2 * GAP_PX, 420)}px`;
    bubble.bottom = `${innerHeight - stage.bottom + GAP_PX}px`;
  }
}

function wasSeen() {
  try {
    return localStorage.getItem(KEY) === "seen";
  } catch {
    return false;
  }
}
