// How far teaching has come: the share driven without help, questions a minute, and rules, of which several lessons may make one.

import { setText } from "./why.js";

const MINUTE_S = 60;

export function progress({ progress, rlas }) {
  const { seconds, driven_percent: driven, asks } = progress;
  const parts = [`rules ${rlas}`]; // lessons are counted in the bar
  if (driven !== null) parts.unshift(`by itself ${driven} %`, seconds < MINUTE_S ? `asks ${asks} in ${seconds} s` : `asks ${asks} a minute`);
  return parts.join(" · ");
}

export function showProgress(state) {
  const line = document.getElementById("progress");
  setText(line, progress(state));
  line.title = "In the last minute: how much of the time its own rules drove it, and how often it began to ask";
}
