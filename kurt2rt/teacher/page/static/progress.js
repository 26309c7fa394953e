// Progress of teaching: fraction driven without help, questions a minute, number of rules.

import { setText } from "./decision.js";

const MINUTE_S = 60;
const CLEAN_PERCENT = 98; // a press or a question takes more

// Returns the progress of a simulated robot in its task, such as "laps 2.3"; empty for a real robot.
export function measured({ progress, unit }) {
  if (!unit) return "";
  return unit === "m" ? `distance ${progress.toFixed(0)} m` : `${unit} ${progress.toFixed(1)}`;
}

export function progress({ progress, rlas }, measure = "") {
  const { seconds, driven_percent: driven, asks } = progress;
  const parts = [`rules ${rlas}`]
  if (driven !== null) parts.unshift(`by itself ${driven} %`, seconds < MINUTE_S ? `asks ${asks} in ${seconds} s` : `asks ${asks} a minute`);
  if (measure) parts.push(measure);
  if (seconds >= MINUTE_S && asks === 0 && driven >= CLEAN_PERCENT) parts.push(measure ? "a clean minute: exam?" : "a clean minute");
  return parts.join(" · ");
}

export function showProgress(state, measure) {
  const line = document.getElementById("progress");
  setText(line, progress(state, measure));
  line.title =
    "In the last minute: time driven by its own rules, and how often it stood and asked, because no rule was near enough. " +
    "Progress in the task is since the start of the run";
}
