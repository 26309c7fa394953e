// How far teaching has come: the share driven without help, questions a minute, and rules, of which several lessons may make one.

import { setText } from "./why.js";

const MINUTE_S = 60;

// What a simulated robot did of its task, as "laps 2.3"; nothing for a real one, which is not seen from above.
export function measured({ progress, unit }) {
  if (!unit) return "";
  return unit === "m" ? `way ${progress.toFixed(0)} m` : `${unit} ${progress.toFixed(1)}`;
}

export function progress({ progress, rlas }, measure = "") {
  const { seconds, driven_percent: driven, asks } = progress;
  const parts = [`rules ${rlas}`]; // lessons are counted in the bar
  if (driven !== null) parts.unshift(`by itself ${driven} %`, seconds < MINUTE_S ? `asks ${asks} in ${seconds} s` : `asks ${asks} a minute`);
  if (measure) parts.push(measure);
  return parts.join(" · ");
}

export function showProgress(state, measure) {
  const line = document.getElementById("progress");
  setText(line, progress(state, measure));
  line.title = "In the last minute: how much of the time its own rules drove it, and how often it began to ask; what it did of its task since the run began";
}
