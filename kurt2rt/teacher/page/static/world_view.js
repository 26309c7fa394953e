// The simulated world from above with the robot in it; robot and walls can be dragged to another place.

import { BLUE, body, INK, PALE, PAPER, RED, sheet, TRAIL } from "./canvas.js";
import { drawSensing } from "./robot_view.js";
import { Trail } from "./trail.js";

const GRAB_PX = 26;
const CLICK_PX = 8;
const HANDLE_M = 0.46;
const MARGIN_PX = 8; // round the whole room
const HANDLE_PX = 12; // round the robot and the middle of its handle
const FILLED = 0.72; // least share of the box that the room takes
const TURN_GAIN = 1.2; // a room is turned if the whole of it gets larger by this
const LEAST_PX_PER_M = 60; // of a large world, so that the robot stays to be seen
const BUTTON_PX = 54; // at the right end of the box
const NEW_MS = 10_000; // of the way, drawn darker

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

  // True if there is a room to draw, and a robot in it.
  get ready() {
    return Boolean(this.#world && this.#state?.place);
  }

  // Draws the room and the robot, in rewind that of the picked moment; `asked`: state whose question is shown.
  draw(asked) {
    const drawn = sheet(this.#canvas);
    if (!drawn) return;
    const { paint } = drawn;
    const { scale, turned, x, y, middle } = this.#view(drawn.width, drawn.height);
    paint.save();
    paint.translate(...middle);
    paint.scale(scale, -scale);
    if (turned) paint.rotate(-Math.PI / 2);
    paint.translate(-x, -y);
    this.#room(paint, scale);
    this.#traces(paint, scale);
    const { place } = this.#state;
    const dragged = this.#grab?.what === "robot" || this.#grab?.what === "heading";
    if (dragged || this.#rewind.state) this.#ghost(paint, scale, place.x_m, place.y_m, place.heading_rad);
    if (dragged) this.#ghost(paint, scale, this.#grab.x, this.#grab.y, this.#grab.heading, 1);
    else this.#robot(paint, scale, this.#rewind.state ?? this.#state, asked);
    paint.restore();
  }

  // Returns scale, turn and middle of the picture: the whole room if that fills the box, else what of it round the
  // robot fills it. A room is turned if much of a box would stay empty otherwise.
  #view(width, height) {
    const [sizeX, sizeY] = this.#world.size;
    const [boxX, boxY] = [width - 2 * MARGIN_PX, height - 2 * MARGIN_PX];
    const whole = (across, up) => Math.min(boxX / across, boxY / up);
    const turned = whole(sizeY, sizeX) > TURN_GAIN * whole(sizeX, sizeY);
    const [across, up] = turned ? [sizeY, sizeX] : [sizeX, sizeY];
    const scale = Math.max(whole(across, up), FILLED * Math.max(width / across, height / up), LEAST_PX_PER_M);
    const { place } = this.#rewind.state ?? this.#state;
    const [handleX, handleY] = handle(place);
    const free = Math.max(0, width - across * scale - 2 * MARGIN_PX);
    return {
      scale,
      turned,
      x: within([place.x_m, handleX], sizeX, (turned ? height : width) / 2, scale),
      y: within([place.y_m, handleY], sizeY, (turned ? width : height) / 2, scale),
      middle: [width / 2 - Math.min(free, BUTTON_PX) / 2, height / 2],
      ...this.#grab?.seen, // a picture that moves would take what is dragged with it
    };
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

  // Draws the way of the last minute, its last seconds darker, and the points of questions.
  #traces(paint, scale) {
    const { points } = this.#trail;
    const newest = points.at(-1)?.[0];
    paint.strokeStyle = TRAIL;
    paint.lineWidth = 2.5 / scale;
    paint.globalAlpha = 0.3;
    way(paint, points);
    paint.globalAlpha = 1;
    way(paint, points.filter(([ms]) => newest - ms < NEW_MS));
    paint.fillStyle = RED;
    for (const [x, y] of this.#trail.asked) {
      paint.beginPath();
      paint.arc(x, y, 4 / scale, 0, 7);
      paint.fill();
    }
  }

  #robot(paint, scale, state, asked) {
    const { x_m: x, y_m: y, heading_rad: heading } = state.place;
    paint.save();
    paint.translate(x, y);
    paint.rotate(heading);
    this.#handle(paint, scale);
    drawSensing(paint, scale, this.#hello, state, asked);
    paint.restore();
  }

  // Draws the robot's outline where it is dragged to, or pale where it is.
  #ghost(paint, scale, x, y, heading, alpha = 0.25) {
    const [length, width] = this.#hello.outline;
    paint.save();
    paint.globalAlpha = alpha;
    paint.translate(x, y);
    paint.rotate(heading);
    this.#handle(paint, scale);
    body(paint, length, width, { fill: PALE, line: BLUE, lineWidth: 2.5 / scale });
    paint.restore();
  }

  // Draws the handle in the direction of the heading, by which the robot is turned.
  #handle(paint, scale) {
    paint.strokeStyle = BLUE;
    paint.lineWidth = 2 / scale;
    paint.beginPath();
    paint.moveTo(0, 0);
    paint.lineTo(HANDLE_M, 0);
    paint.stroke();
    paint.beginPath();
    paint.arc(HANDLE_M, 0, 7 / scale, 0, 7);
    paint.fillStyle = PAPER;
    paint.fill();
    paint.stroke();
  }

  // Returns the touched point of the world in metres, and the view.
  #point(event) {
    const box = this.#canvas.getBoundingClientRect();
    const view = this.#view(box.width, box.height);
    const right = (event.clientX - box.left - view.middle[0]) / view.scale;
    const up = -(event.clientY - box.top - view.middle[1]) / view.scale;
    return view.turned ? [view.x - up, view.y + right, view] : [view.x + right, view.y + up, view];
  }

  #grabAt(event) {
    if (!this.ready || !event.isPrimary) return;
    const [x, y, seen] = this.#point(event);
    if (this.#rewind.open) {
      this.#rewind.pick(x, y);
      event.preventDefault();
      return;
    }
    const place = this.#state.place;
    const reach = GRAB_PX / seen.scale;
    const [handleX, handleY] = handle(place);
    const start = { px: event.clientX, py: event.clientY, fromX: x, fromY: y, seen };
    const robot = { ...start, x: place.x_m, y: place.y_m, heading: place.heading_rad };
    const toHandle = Math.hypot(x - handleX, y - handleY);
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

function handle({ x_m: x, y_m: y, heading_rad: heading }) {
  return [x + HANDLE_M * Math.cos(heading), y + HANDLE_M * Math.sin(heading)];
}

// Returns the middle of the picture along one side of the room: that of the room if it fits, else the robot's place
// with no more outside than a margin. Robot and handle are always inside.
function within([place, handle], size, halfPx, scale) {
  const [half, margin, edge] = [halfPx, MARGIN_PX, HANDLE_PX].map((px) => px / scale);
  const middle = size + 2 * margin <= 2 * half ? size / 2 : between(half - margin, place, size + margin - half);
  return between(Math.max(place, handle) + edge - half, middle, Math.min(place, handle) - edge + half);
}

function between(least, value, most) {
  return Math.min(Math.max(value, least), most);
}

function way(paint, points) {
  paint.beginPath();
  let previous = null;
  for (const [, x, y] of points) {
    // No line to a place where the robot was put.
    if (previous && Math.hypot(x - previous[0], y - previous[1]) < 0.3) paint.lineTo(x, y);
    else paint.moveTo(x, y);
    previous = [x, y];
  }
  paint.stroke();
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
