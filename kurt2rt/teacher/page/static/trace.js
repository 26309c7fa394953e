// Distance to the nearest RLA relative to R, over the last 20 s.

import { BLUE, FAINT, GREY, RED, sheet } from "./canvas.js";

const SHOWN_TICKS = 2000;
const MOST_SHARE = 1.5;

export class Trace {
  #canvas;
  #shares = []; // [tick, distance / R, or null]

  constructor(canvas) {
    this.#canvas = canvas;
  }

  add(tick, share) {
    if (this.#shares.length && tick < this.#shares.at(-1)[0]) this.#shares = []; // the robot was restarted
    this.#shares.push([tick, share]);
    while (tick - this.#shares[0][0] > SHOWN_TICKS) this.#shares.shift();
  }

  draw() {
    const drawn = sheet(this.#canvas);
    if (!drawn || !this.#shares.length || drawn.height < 16) return;
    const { paint, width, height } = drawn;
    const newest = this.#shares.at(-1)[0];
    const right = width - 36;
    const y = (share) => height - 2 - (Math.min(share, MOST_SHARE) / MOST_SHARE) * (height - 4);
    paint.lineWidth = 1;
    paint.strokeStyle = FAINT;
    paint.beginPath();
    paint.moveTo(0, height - 1);
    paint.lineTo(right, height - 1);
    paint.stroke();
    paint.setLineDash([4, 4]);
    paint.strokeStyle = GREY;
    paint.beginPath();
    paint.moveTo(0, y(1));
    paint.lineTo(right, y(1));
    paint.stroke();
    paint.setLineDash([]);
    paint.fillStyle = GREY;
    paint.font = "600 12px system-ui, sans-serif";
    paint.fillText("asks", right + 5, y(1) + 4); // beyond this distance
    paint.lineWidth = 2;
    let last = null;
    for (const [tick, share] of this.#shares) {
      const point = share === null ? null : [right - ((newest - tick) / SHOWN_TICKS) * right, y(share)];
      if (last && point) {
        paint.strokeStyle = share > 1 ? RED : BLUE;
        paint.beginPath();
        paint.moveTo(...last);
        paint.lineTo(...point);
        paint.stroke();
      }
      last = point;
    }
  }
}
