// The mid level in words and arrows: its behaviour, the reason, the symbols that the robot passed; and surprise.

import { words } from "./actions.js";
import { glyph } from "./glyphs.js";

export const BASIC = "basic";
export const MID = "mid";
const HISTORY = "history";
const LOUD_FROM = 4; // times the usual distance
const SURPRISED_TICKS = 300;

// Returns a distance in words; for histories the number of differing symbols.
export function differs({ distance, radius }, [kind, length]) {
  if (distance === null) return "none is near";
  return kind === HISTORY
    ? `${distance.toFixed(0)} of ${length} differ`
    : `${distance.toFixed(2)} off, R ${radius.toFixed(2)}`;
}

export function waySentence(state, hello) {
  const { mid, goal } = state;
  const way = words(mid.behaviour || "the only behaviour");
  if (mid.overridden) return `${way} by the teacher's choice, until it has finished`;
  if (mid.rla === null) return `${way}; the mid level has not decided yet`;
  const because = goal && state.plan.length ? `it leads to ${goal}, mid-level RLA ${mid.rla}` : `mid-level RLA ${mid.rla}`;
  return `${way} because ${because}: ${differs(mid, hello.mid)}`;
}

// Returns a surprise as text, loud from a ratio on; null without one.
export function surprise({ surprise: it, tick }) {
  if (!it || tick - it.tick > SURPRISED_TICKS || tick < it.tick) return null;
  const whose = `${it.level === MID ? "mid-level RLA" : "RLA"} ${it.rla}`;
  const far = it.times === null ? "" : ` ${it.times.toFixed(1)} ×`; // times the usual distance
  return { loud: it.times === null || it.times >= LOUD_FROM, text: `surprise${far} after ${whose}${it.new ? ", new" : ""}` };
}

// Returns a symbol as an arrow, or its first letters.
export function symbol(word) {
  const cell = document.createElement("i");
  const picture = word && glyph(word);
  if (picture) cell.append(picture);
  else cell.textContent = word ? words(word).slice(0, 4) : "·";
  cell.title = words(word) || "none yet";
  return cell;
}

// Returns a place in words: features with value 1 by name, the heading as an arrow.
function place(features) {
  const line = document.createElement("p");
  const values = new Map(features.map((each) => [each.slice(0, each.lastIndexOf(" ")), Number(each.slice(each.lastIndexOf(" ") + 1))]));
  const [east, north] = [values.get("east"), values.get("north")];
  const parts = [...values].map(([name, value]) => {
    if (name.endsWith("_m")) return `${words(name.slice(0, -2))} ${value.toFixed(2)} m`;
    if (name === "east" && north !== undefined) return "→↗↑↖←↙↓↘"[Math.round((Math.atan2(north, east) / Math.PI) * 4 + 8) % 8];
    if (name === "north" && east !== undefined) return "";
    return value === 1 ? words(name) : value === 0 ? "" : `${words(name)} ${value.toFixed(2)}`;
  });
  line.textContent = parts.filter(Boolean).join(", ");
  return line;
}

// Returns the last symbols, oldest first; below each the symbol of the nearest RLA, if `there` has any.
export function strip(here, there, [kind]) {
  if (kind !== HISTORY) return [here, there].filter((words) => words.length).map(place);
  return here
    .map((word, i) => {
      const pair = document.createElement("div");
      pair.append(symbol(word));
      if (there.length) {
        pair.append(symbol(there[i] ?? ""));
        pair.classList.toggle("differs", word !== there[i]);
      }
      return pair;
    })
    .reverse();
}
