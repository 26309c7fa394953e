// The robot from above: its readings as beams, its bumpers, its wheel speeds, and its way within the next second.

import { between, BLUE, body, DIFFERS, FAINT, FAR, GREY, INK, NEAR, PALE, PAPER, RED, SHADE, sheet } from "./canvas.js";
import { differing, farthest, rays } from "./sensors.js";

const HALF_BEAM_RAD = 0.09;
const AHEAD_S = 1;
const POSES = 12; // of the body within that time

// Far is pale blue, near is red; dark enough for the sun.
function colour(metres) {
  return between(FAR, NEAR, Math.min(1, Math.max(0, (0.45 - metres) / 0.3)));
}

// Draws the robot alone; sensors that differ in the question of the state `asked` are marked as in the picture of `kurt2rt why`.
export function drawRobot(canvas, hello, state, asked) {
  const drawn = sheet(canvas);
  if (!drawn) return;
  const { paint, width, height } = drawn;
  const [length, breadth] = hello.outline;
  const margin = 58; // for the wheel speeds
  const reach = farthest(hello) + 0.03;
  const scale = Math.min((width - 2 * margin) / (breadth + 2 * reach), (height - 8) / (length + 2 * reach));

  wheel(paint, 30, height, state.left_m_s, hello.max_m_s, "L");
  wheel(paint, width - 30, height, state.right_m_s, hello.max_m_s, "R");

  paint.save();
  paint.translate(width / 2, height / 2);
  paint.scale(scale, -scale);
  paint.rotate(Math.PI / 2); // forward is up
  rings(paint, length, breadth, scale);
  drawSensing(paint, scale, hello, state, asked);
  paint.restore();
}

// Draws the robot in its own frame, in metres: its beams, where it drives within the next second, body and bumpers.
export function drawSensing(paint, scale, hello, state, asked) {
  const [length, breadth] = hello.outline;
  const seen = rays(hello, state);
  const marked = differing(asked, hello);
  for (const ray of seen) beam(paint, ray, scale, marked.has(ray.name));
  ahead(paint, hello, state, seen);
  body(paint, length, breadth, { fill: PALE, line: BLUE, lineWidth: 2.5 / scale });
  bumpers(paint, length, breadth, state.bumpers, scale);
}

// Paints the ground that the body covers within the next second at the present wheel speeds; red from the moment at
// which it meets a point that a sensor sees now.
function ahead(paint, hello, state, seen) {
  const [length, breadth] = hello.outline;
  const poses = posesAhead(hello, state);
  const within = ([x, y], [px, py, angle]) => {
    const [dx, dy] = [x - px, y - py];
    const along = dx * Math.cos(angle) + dy * Math.sin(angle);
    const aside = dy * Math.cos(angle) - dx * Math.sin(angle);
    return Math.abs(along) < length / 2 && Math.abs(aside) < breadth / 2;
  };
  const met = poses.findIndex((pose) => seen.some(({ nothing, end }) => !nothing && within(end, pose)));
  const free = met < 0 ? poses.length : met;
  for (const [part, colour] of [[poses.slice(0, free), BLUE], [poses.slice(free), RED]]) {
    paint.beginPath();
    for (const [x, y, angle] of part) {
      paint.save();
      paint.translate(x, y);
      paint.rotate(angle);
      paint.rect(-length / 2, -breadth / 2, length, breadth);
      paint.restore();
    }
    paint.fillStyle = colour;
    paint.globalAlpha = colour === RED ? 0.4 : 0.2;
    paint.fill();
  }
  paint.globalAlpha = 1;
}

// Returns the poses [x, y, angle] of the next second in the robot's frame; none of a robot that stands.
function posesAhead({ track_m: track }, { left_m_s: left, right_m_s: right }) {
  if (!left && !right) return [];
  const way = ((left + right) / 2) * (AHEAD_S / POSES);
  const half = ((right - left) / track / 2) * (AHEAD_S / POSES);
  let [x, y, angle] = [0, 0, 0];
  return Array.from({ length: POSES }, () => {
    angle += half;
    [x, y] = [x + way * Math.cos(angle), y + way * Math.sin(angle)];
    angle += half;
    return [x, y, angle];
  });
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

function beam(paint, { x, y, angle, metres, nothing }, scale, marked) {
  const paintedIn = marked ? DIFFERS : colour(metres);
  paint.beginPath();
  paint.moveTo(x, y);
  paint.arc(x, y, metres, angle - HALF_BEAM_RAD, angle + HALF_BEAM_RAD);
  paint.closePath();
  paint.fillStyle = paintedIn;
  paint.globalAlpha = marked ? 0.55 : nothing ? 0.12 : 0.3;
  paint.fill();
  paint.globalAlpha = 1;
  if (nothing) return;
  paint.beginPath();
  paint.arc(x, y, metres, angle - HALF_BEAM_RAD * 1.5, angle + HALF_BEAM_RAD * 1.5);
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
  const top = 74; // below the button
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
