// What the sensors see now next to the condition of the nearest RLA, while the robot asks.

import { BASIC } from "./mid_text.js";
import { INK, sheet } from "./canvas.js";
import { drawSensing } from "./robot_view.js";
import { asks } from "./decision.js";
import { differenceList } from "./sensors.js";

const CAPTION_PX = 15;
const REACH_M = 0.5; // of the ground round the body

export class Compare {
  #link;
  #box = document.getElementById("why");
  #canvas = document.getElementById("compare");
  #question = ""; // which RLA is nearest to what is asked; empty without a question
  #taught = null; // counts of each sensor in its condition, by the sensor's name

  constructor(link) {
    this.#link = link;
  }

  // Asks the robot for the condition once the state whose question is shown is nearest to another RLA.
  update(state) {
    const { nearest, nearest_image: image, lessons } = state;
    const compares = asks(state) && state.asks_at === BASIC && nearest !== null;
    const question = compares ? `${nearest} ${image} ${lessons}` : "";
    if (question !== this.#question) {
      this.#question = question;
      this.#taught = null;
      if (question) this.#ask(question, nearest);
    }
    this.#box.classList.toggle("drawn", this.#taught !== null);
    if (!this.#taught) return;
    const lines = [...differenceList(state.question).children].map((each) => each.textContent);
    this.#canvas.setAttribute("aria-label", `Now, and as taught: ${lines.join("; ")}`);
  }

  async #ask(question, nearest) {
    const { taught } = await this.#link.why();
    if (question === this.#question && taught?.rla === nearest) this.#taught = taught.counts;
  }

  // Draws both; `asked`: state whose differing sensors are marked.
  draw(hello, state, asked) {
    const drawn = this.#taught && sheet(this.#canvas);
    if (!drawn) return;
    const { paint, width, height } = drawn;
    const stood = { bumpers: 0, left_m_s: 0, right_m_s: 0, infrared: hello.sensors.map(([name]) => this.#taught[name] ?? 0) };
    this.#half(paint, hello, state, asked, { x: 0, width: width / 2, height, caption: "now" });
    this.#half(paint, hello, stood, asked, { x: width / 2, width: width / 2, height, caption: "as taught" });
  }

  #half(paint, hello, state, asked, { x, width, height, caption }) {
    paint.save();
    paint.beginPath();
    paint.rect(x, 0, width, height);
    paint.clip();
    paint.fillStyle = INK;
    paint.font = "600 12px system-ui, sans-serif";
    paint.textAlign = "center";
    paint.fillText(caption, x + width / 2, 12);
    const scale = (height - CAPTION_PX) / (hello.outline[0] + 2 * REACH_M);
    paint.translate(x + width / 2, (height + CAPTION_PX) / 2);
    paint.scale(scale, -scale);
    paint.rotate(Math.PI / 2); // forward is up
    drawSensing(paint, scale, hello, state, asked);
    paint.restore();
  }
}
