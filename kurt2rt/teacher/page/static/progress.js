// Progress of teaching: the share of the last minute that the robot drove by itself, and what its task counts.

import { setText } from "./decision.js";
import { text } from "./texts.js";

const MINUTE_S = 60;
const CLEAN_PERCENT = 98; // a press or a question takes more

const $ = (id) => document.getElementById(id);

// Returns the progress of a simulated robot in its task, such as "2.3 laps"; empty for a real robot.
function measured({ progress, unit }) {
  if (!unit) return "";
  return `${progress.toFixed(unit === "m" ? 0 : 1)} ${unit}`;
}

export class Progress {
  #suggest;
  #held = {}; // whether each reason held in the state before

  // `suggest` is called with a sentence when the robot has driven a minute without a question, and its first lap.
  constructor(suggest) {
    this.#suggest = suggest;
  }

  // `simulation`: its last report; null for a real robot.
  show({ progress: { seconds, driven_percent: driven, asks } }, simulation) {
    $("drove").value = driven ?? 0;
    setText($("drove-text"), driven === null ? "" : `${driven} %`);
    setText($("measure"), simulation ? measured(simulation) : "");
    const { progress = 0, unit = "" } = simulation ?? {};
    this.#reach("cleanMinute", seconds >= MINUTE_S && asks === 0 && driven >= CLEAN_PERCENT);
    this.#reach("firstLap", progress >= 1 && unit !== "" && unit !== "m", { round: unit.slice(0, -1) });
  }

  #reach(reason, holds, fields = {}) {
    if (holds && this.#held[reason] === false) this.#suggest(text(reason, fields)); // not what was so before the page opened
    this.#held[reason] = holds;
  }
}
