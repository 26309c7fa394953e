// The simulated world from above; robot and walls can be dragged to another place.

import { BLUE, body, DIFFERS, FAR, INK, PALE, PAPER, RED, sheet, TRAIL } from "./canvas.js";
import { differing, distance, farthest } from "./sensors.js";
import { Trail } from "./trail.js";

const GRAB_PX = 26;
const CLICK_PX = 8;
const HANDLE_M = 0.46;

export class WorldView {
  #canvas;
  #sendCommand;
  #world = null;
  #hello = null;
  #state = null;
  #trail = new Trail();
  #grab = null;
  #rewind;

  constructor(canvas, sendCommand, rewind) {
    this.#canvas = canvas;
    this.#sendCommand = sendCommand;
    this.#rewind = rewind;
    canvas.addEventListener("pointerdown", (event) => this.#grabAt(event));
    canvas.addEventListener("pointermove", (event) => this.#move(event));
    canvas.addEventListener("pointerup", (event) => this.#release(event));
    for (const lost of ["pointercancel", "lostpointercapture", "contextmenu"]) {
      canvas.addEventListener(lost, (event) => {
        if (lost === "contextmenu") event.preventDefault();
        this.#grab = null;
      });
    }
  }

  setHello(hello) {
    this.#hello = hello;
    this.#trail.restore(hello);
  }

  set world(world) {
    this.#world = world;
  }

  update(state) {
    this.#state = state;
    this.#trail.add(state);
  }

  draw() {
    const drawn = sheet(this.#canvas);
    if (!drawn || !this.#world || !this.#hello || !this.#state?.place) return;
    const { paint } = drawn;
    const view = this.#view(drawn.width, drawn.height);
    paint.save();
    paint.translate(view.left, view.top);
    paint.scale(view.scale, -view.scale);
    this.#room(paint, view.scale);
    this.#traces(paint, view.scale);
    const { place } = this.#state;
    const past = this.#rewind.state?.place;
    if (past) this.#robot(paint, view.scale, past.x_m, past.y_m, past.heading_rad, 1);
    else this.#rays(paint, view.scale, place);
    const dragged = this.#grab?.what === "robot" || this.#grab?.what === "heading";
    this.#robot(paint, view.scale, place.x_m, place.y_m, place.heading_rad, dragged || past ? 0.25 : 1);
    if (dragged) this.#robot(paint, view.scale, this.#grab.x, this.#grab.y, this.#grab.heading, 1);
    paint.restore();
  }

  #view(width, height) {
    const [sizeX, sizeY] = this.#world.size;
    const scale = Math.min((width - 24) / sizeX, (height - 24) / sizeY);
    return { scale, left: (width - sizeX * scale) / 2, top: (height + sizeY * scale) / 2 };
  }

  #room(paint, scale) {
    polygon(paint, this.#world.outline);
    paint.fillStyle = PAPER;
    paint.fill();
    paint.strokeStyle = INK;
    paint.lineWidth = 4 / scale;
    paint.stroke();
    for (const [name, corners] of this.#world.walls) {
      const [dx, dy] = this.#shift(name);
      polygon(paint, corners.map(([x, y]) => [x + dx, y + dy]));
      paint.fillStyle = dx || dy ? BLUE : INK;
      paint.fill();
    }
    for (const [name, x, y, radius] of this.#world.round) {
      const [dx, dy] = this.#shift(name);
      paint.beginPath();
      paint.arc(x + dx, y + dy, radius, 0, 7);
      paint.fillStyle = dx || dy ? BLUE : INK;
      paint.fill();
    }
  }

  #shift(name) {
    return this.#grab?.what === "wall" && this.#grab.name === name ? [this.#grab.dx, this.#grab.dy] : [0, 0];
  }

  // Draws the ray of each sensor; a dot marks the obstacle.
  #rays(paint, scale, { x_m: x, y_m: y, heading_rad: turned }) {
    const marked = differing(this.#state, this.#hello);
    paint.save();
    paint.translate(x, y);
    paint.rotate(turned);
    this.#hello.sensors.forEach(([name, , sx, sy, heading], i) => {
      const metres = distance(this.#hello, this.#state.infrared[i] ?? 0);
      const angle = (heading * Math.PI) / 180;
      const end = [sx + metres * Math.cos(angle), sy + metres * Math.sin(angle)];
      const nothing = metres >= farthest(this.#hello);
      paint.strokeStyle = paint.fillStyle = marked.has(name) ? DIFFERS : FAR;
      paint.lineWidth = (marked.has(name) ? 2.5 : 1) / scale;
      paint.globalAlpha = marked.has(name) ? 1 : nothing ? 0.25 : 0.6;
      paint.beginPath();
      paint.moveTo(sx, sy);
      paint.lineTo(...end);
      paint.stroke();
      if (nothing) return;
      paint.beginPath();
      paint.arc(...end, 3 / scale, 0, 7);
      paint.fill();
    });
    paint.restore();
  }

  #traces(paint, scale) {
    paint.strokeStyle = TRAIL;
    paint.lineWidth = 2.5 / scale;
    paint.beginPath();
    let previous = null;
    for (const [, x, y] of this.#trail.points) {
      // No line to a place where the robot was put.
      if (previous && Math.hypot(x - previous[0], y - previous[1]) < 0.3) paint.lineTo(x, y);
      else paint.moveTo(x, y);
      previous = [x, y];
    }
    paint.stroke();
    paint.fillStyle = RED;
    for (const [x, y] of this.#trail.asked) {
      paint.beginPath();
      paint.arc(x, y, 4 / scale, 0, 7);
      paint.fill();
    }
  }

  #robot(paint, scale, x, y, heading, alpha) {
    const [length, width] = this.#hello.outline;
    paint.save();
    paint.globalAlpha = alpha;
    paint.translate(x, y);
    paint.rotate(heading);
    paint.strokeStyle = BLUE;
    paint.lineWidth = 2 / scale;
    paint.beginPath();
    paint.moveTo(length / 2, 0);
    paint.lineTo(HANDLE_M, 0);
    paint.stroke();
    paint.beginPath();
    paint.arc(HANDLE_M, 0, 7 / scale, 0, 7);
    paint.fillStyle = PAPER;
    paint.fill();
    paint.stroke();
    body(paint, length, width, { fill: PALE, line: BLUE, lineWidth: 2.5 / scale });
    paint.restore();
  }

  #point(event) {
    const box = this.#canvas.getBoundingClientRect();
    const view = this.#view(box.width, box.height);
    return [(event.clientX - box.left - view.left) / view.scale, -(event.clientY - box.top - view.top) / view.scale, view.scale];
  }

  #grabAt(event) {
    if (!this.#world || !this.#state?.place || !event.isPrimary) return;
    const [x, y, scale] = this.#point(event);
    if (this.#rewind.open) {
      this.#rewind.pick(x, y);
      event.preventDefault();
      return;
    }
    const place = this.#state.place;
    const reach = GRAB_PX / scale;
    const handle = [place.x_m + HANDLE_M * Math.cos(place.heading_rad), place.y_m + HANDLE_M * Math.sin(place.heading_rad)];
    const start = { px: event.clientX, py: event.clientY, fromX: x, fromY: y };
    const robot = { ...start, x: place.x_m, y: place.y_m, heading: place.heading_rad };
    const toHandle = Math.hypot(x - handle[0], y - handle[1]);
    const toRobot = Math.hypot(x - place.x_m, y - place.y_m);
    if (toHandle < reach && toHandle < toRobot) this.#grab = { ...robot, what: "heading" };
    else if (toRobot < Math.max(0.22, reach)) this.#grab = { ...robot, what: "robot", offX: place.x_m - x, offY: place.y_m - y };
    else {
      const name = this.#thingAt(x, y, reach * 0.6);
      this.#grab = name === null ? null : { ...start, what: "wall", name, dx: 0, dy: 0 };
    }
    if (this.#grab) {
      this.#canvas.setPointerCapture(event.pointerId);
      event.preventDefault();
    }
  }

  #thingAt(x, y, reach) {
    for (const [name, cx, cy, radius] of this.#world.round) if (Math.hypot(x - cx, y - cy) < radius + reach) return name;
    for (const [name, corners] of this.#world.walls) if (inside(corners, x, y) || toEdge(corners, x, y) < reach) return name;
    return null;
  }

  #move(event) {
    const grab = this.#grab;
    if (!grab) return;
    const [x, y] = this.#point(event);
    if (grab.what === "robot") [grab.x, grab.y] = [x + grab.offX, y + grab.offY];
    else if (grab.what === "heading") grab.heading = Math.atan2(y - grab.y, x - grab.x);
    else [grab.dx, grab.dy] = [x - grab.fromX, y - grab.fromY];
  }

  #release(event) {
    const grab = this.#grab;
    this.#grab = null;
    if (!grab || Math.hypot(event.clientX - grab.px, event.clientY - grab.py) < CLICK_PX) return;
    const round = (value) => Math.round(value * 1000) / 1000;
    if (grab.what === "wall") this.#sendCommand("/world/move", { name: grab.name, dx_m: round(grab.dx), dy_m: round(grab.dy) });
    else this.#sendCommand("/world/place", { x_m: round(grab.x), y_m: round(grab.y), heading_rad: round(grab.heading) });
  }
}

function polygon(paint, corners) {
  paint.beginPath();
  corners.forEach(([x, y], i) => (i ? paint.lineTo(x, y) : paint.moveTo(x, y)));
  paint.closePath();
}

function inside(corners, x, y) {
  let odd = false;
  corners.forEach(([ax, ay], i) => {
    const [bx, by] = corners[(i + 1) % corners.length];
    if (ay > y !== by > y && x < ((bx - ax) * (y - ay)) / (by - ay) + ax) odd = !odd;
  });
  return odd;
}

function toEdge(corners, x, y) {
  return Math.min(
    ...corners.map(([ax, ay], i) => {
      const [bx, by] = corners[(i + 1) % corners.length];
      const squared = (bx - ax) ** 2 + (by - ay) ** 2;
      const along = squared ? Math.min(1, Math.max(0, ((x - ax) * (bx - ax) + (y - ay) * (by - ay)) / squared)) : 0;
      return Math.hypot(x - ax - along * (bx - ax), y - ay - along * (by - ay));
    }),
  );
}
