// The robot from above: its readings as beams, its bumpers, its wheel speeds.

import { between, BLUE, body, DIFFERS, FAINT, FAR, GREY, INK, NEAR, PAPER, RED, SHADE, sheet } from "./canvas.js";
import { differing, distance, farthest } from "./sensors.js";

const HALF_BEAM_RAD = 0.09;
const BEHIND_PX = 12; // from the point that a sensor sees to its text

// Far is pale blue, near is red; dark enough for the sun.
function colour(metres) {
  return between(FAR, NEAR, Math.min(1, Math.max(0, (0.45 - metres) / 0.3)));
}

// Draws the robot; sensors that differ in the question of the state `asked` are marked as in the picture of `kurt2rt why`.
export function drawRobot(canvas, hello, state, asked) {
  const drawn = sheet(canvas);
  if (!drawn || !hello || !state || !asked) return; // nothing is worded before the first frame
  const { paint, width, height } = drawn;
  const [length, breadth] = hello.outline;
  const margin = 58; // for the wheel speeds
  const reach = farthest(hello) + 0.03;
  const scale = Math.min((width - 2 * margin) / (breadth + 2 * reach), (height - 8) / (length + 2 * reach));

  wheel(paint, 30, height, state.left_m_s, hello.max_m_s, "L");
  wheel(paint, width - 30, height, state.right_m_s, hello.max_m_s, "R");

  paint.save();
  paint.translate(width / 2, height / 2);
  paint.scale(scale, scale);
  paint.rotate(-Math.PI / 2); // forward is up
  paint.scale(1, -1); // y is to the left
  rings(paint, length, breadth, scale);
  const marked = differing(asked, hello);
  hello.sensors.forEach(([name, , x, y, heading], i) => {
    const metres = distance(hello, state.infrared[i] ?? 0);
    beam(paint, x, y, (heading * Math.PI) / 180, metres, scale, metres >= farthest(hello), marked.has(name));
  });
  body(paint, length, breadth, { fill: PAPER, line: INK, lineWidth: 3 / scale });
  bumpers(paint, length, breadth, state.bumpers, scale);
  paint.restore();
  hello.sensors.forEach(([name, , x, y, heading], i) => {
    if (!marked.has(name)) return;
    const metres = distance(hello, state.infrared[i] ?? 0);
    const angle = (heading * Math.PI) / 180;
    const away = metres >= farthest(hello) ? metres * 0.7 : metres + BEHIND_PX / scale;
    label(paint, width / 2 - (y + away * Math.sin(angle)) * scale, height / 2 - (x + away * Math.cos(angle)) * scale, marked.get(name));
  });
}

// Paints the reading of a marked sensor next to the point that it sees.
function label(paint, x, y, text) {
  paint.font = "700 13px system-ui, sans-serif";
  paint.textAlign = "center";
  paint.lineWidth = 4;
  paint.strokeStyle = PAPER;
  paint.strokeText(text, x, y + 4);
  paint.fillStyle = DIFFERS;
  paint.fillText(text, x, y + 4);
}

function rings(paint, length, breadth, scale) {
  paint.lineWidth = 1 / scale;
  paint.strokeStyle = FAINT;
  for (const metres of [0.2, 0.4, 0.6]) {
    paint.beginPath();
    paint.roundRect(-length / 2 - metres, -breadth / 2 - metres, length + 2 * metres, breadth + 2 * metres, metres);
    paint.stroke();
  }
}

function beam(paint, x, y, heading, metres, scale, nothing, marked) {
  const paintedIn = marked ? DIFFERS : colour(metres);
  paint.beginPath();
  paint.moveTo(x, y);
  paint.arc(x, y, metres, heading - HALF_BEAM_RAD, heading + HALF_BEAM_RAD);
  paint.closePath();
  paint.fillStyle = paintedIn;
  paint.globalAlpha = marked ? 0.55 : nothing ? 0.12 : 0.3;
  paint.fill();
  paint.globalAlpha = 1;
  if (nothing) return;
  paint.beginPath();
  paint.arc(x, y, metres, heading - HALF_BEAM_RAD * 1.5, heading + HALF_BEAM_RAD * 1.5);
  paint.strokeStyle = paintedIn;
  paint.lineWidth = 5 / scale;
  paint.lineCap = "butt";
  paint.stroke();
}

// Bits in the robot file's order: front left, centre, right, rear left, centre, right.
function bumpers(paint, length, breadth, bits, scale) {
  for (let i = 0; i < 6; i += 1) {
    if (!(bits & (1 << i))) continue;
    const x = (i < 3 ? 1 : -1) * (length / 2 + 0.02);
    const y = (1 - (i % 3)) * (breadth / 3);
    paint.beginPath();
    paint.moveTo(x, y - breadth / 7);
    paint.lineTo(x, y + breadth / 7);
    paint.strokeStyle = RED;
    paint.lineWidth = 9 / scale;
    paint.stroke();
  }
}

function wheel(paint, x, height, speed, most, name) {
  paint.textAlign = "center";
  paint.font = "600 15px system-ui, sans-serif";
  paint.fillStyle = INK;
  const top = 74; // below the view button
  if (height < top + 80) {
    paint.fillText(speed.toFixed(2), x, height - 8); // no room for a bar
    return;
  }
  const middle = (top + height - 28) / 2;
  const half = Math.max(10, Math.min(middle - top, 90));
  paint.fillStyle = SHADE;
  paint.beginPath();
  paint.roundRect(x - 8, middle - half, 16, 2 * half, 4);
  paint.fill();
  const tip = Math.max(-1, Math.min(1, speed / (most || 0.6))) * half;
  if (Math.abs(tip) > 1) {
    paint.fillStyle = BLUE;
    const head = Math.sign(tip) * Math.min(12, Math.abs(tip));
    paint.fillRect(x - 6, middle, 12, -(tip - head));
    paint.beginPath();
    paint.moveTo(x, middle - tip);
    paint.lineTo(x - 13, middle - tip + head);
    paint.lineTo(x + 13, middle - tip + head);
    paint.fill();
  }
  paint.fillStyle = INK;
  paint.fillRect(x - 12, middle - 1, 24, 2);
  paint.fillText(speed.toFixed(2), x, middle + half + 20);
  paint.fillStyle = GREY;
  paint.font = "600 12px system-ui, sans-serif";
  paint.fillText(name, x, middle - half - 7);
}
