// Path of the simulated robot in the last minute, and the points of its questions; kept over a reload of the page.

import { asks } from "./decision.js";

const TRAIL_S = 60;
const EACH_MS = 100;
const MOST_ASKED = 200;
const STORE_EACH_MS = 2000;
const KEY = "kurt2rt.trail";

export class Trail {
  #boot = null; // start of the robot program of this trail
  #asking = false;
  #storedMs = 0;
  points = []; // [ms since 1970, x, y]
  asked = []; // [x, y]

  constructor() {
    addEventListener("pagehide", () => this.#store());
  }

  // Restores the stored trail of this start of the robot program, or starts an empty one.
  restore({ boot }) {
    if (boot === this.#boot) return;
    this.#boot = boot;
    this.#asking = false;
    [this.points, this.asked] = stored(boot);
  }

  add(state) {
    const { place } = state;
    if (!place) return;
    const now = Date.now();
    const last = this.points.at(-1);
    if (!last || now - last[0] >= EACH_MS || now < last[0]) this.points.push([now, round(place.x_m), round(place.y_m)]);
    while (this.points.length && now - this.points[0][0] > TRAIL_S * 1000) this.points.shift();
    const asking = asks(state);
    if (asking && !this.#asking) {
      this.asked.push([round(place.x_m), round(place.y_m)]);
      if (this.asked.length > MOST_ASKED) this.asked.shift();
    }
    this.#asking = asking;
    if (now - this.#storedMs > STORE_EACH_MS) this.#store(now);
  }

  #store(now = Date.now()) {
    if (this.#boot === null) return;
    this.#storedMs = now;
    try {
      sessionStorage.setItem(KEY, JSON.stringify({ boot: this.#boot, points: this.points, asked: this.asked }));
    } catch {
      // Storage is full or forbidden: the trail ends with the page.
    }
  }
}

function stored(boot) {
  try {
    const trail = JSON.parse(sessionStorage.getItem(KEY));
    return trail?.boot === boot ? [trail.points, trail.asked] : [[], []];
  } catch {
    return [[], []]; // storage is forbidden, or has other content
  }
}

function round(metres) {
  return Math.round(metres * 1000) / 1000;
}
