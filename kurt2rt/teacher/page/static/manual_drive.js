// Manual drive with a deadman switch: speeds are sent 20 times a second while a press lasts.

const PRESS_MS = 50;
const DEAD_SHARE = 0.12;
const TURN_SHARE = 0.6;

export class Drive extends EventTarget {
  #link;
  #timer = null;
  #pressId = 0;
  #speeds = [0, 0];
  most = 0.3; // m/s

  constructor(link) {
    super();
    this.#link = link;
    for (const end of ["blur", "pagehide", "freeze"]) addEventListener(end, () => this.release());
    document.addEventListener("visibilitychange", () => this.release());
  }

  get held() {
    return this.#timer !== null;
  }

  // Begins or continues a press; x to the right, y forward, each -1 to 1.
  press(x, y) {
    const fastest = Math.max(1, Math.abs(y + TURN_SHARE * x), Math.abs(y - TURN_SHARE * x));
    const speed = (share) => Math.round((share / fastest) * this.most * 100) / 100;
    this.#speeds = [speed(y + TURN_SHARE * x), speed(y - TURN_SHARE * x)];
    if (!this.held) {
      this.#pressId = this.#link.nextPress();
      this.#timer = setInterval(() => this.#send(), PRESS_MS);
      this.#send();
    }
    this.#publish();
  }

  release() {
    if (!this.held) return;
    clearInterval(this.#timer);
    this.#timer = null;
    this.#speeds = [0, 0];
    this.#link.release();
    this.#publish();
  }

  #send() {
    if (!this.#link.press(this.#pressId, ...this.#speeds)) this.release();
  }

  #publish() {
    this.dispatchEvent(new CustomEvent("change", { detail: { held: this.held, speeds: this.#speeds } }));
  }
}

// Connects the circle under a thumb to the drive.
export function driveCircle(circle, knob, drive) {
  let pointer = null;

  const move = (event) => {
    const box = circle.getBoundingClientRect();
    const radius = box.width / 2;
    let x = (event.clientX - box.left - radius) / (radius * 0.8);
    let y = -(event.clientY - box.top - radius) / (radius * 0.8);
    const length = Math.hypot(x, y);
    if (length > 1) [x, y] = [x / length, y / length];
    if (length < DEAD_SHARE) [x, y] = [0, 0];
    // Nearly straight counts as straight: a thumb is not precise.
    if (Math.abs(x) < 0.15) x = 0;
    if (Math.abs(y) < 0.15) y = 0;
    knob.style.transform = `translate(${x * radius * 0.62}px, ${-y * radius * 0.62}px)`;
    drive.press(x, y);
  };
  const end = (event) => {
    if (event.pointerId === undefined || event.pointerId === pointer) {
      pointer = null;
      drive.release();
    }
  };

  circle.addEventListener("pointerdown", (event) => {
    if (pointer !== null || circle.closest("[inert]")) return;
    pointer = event.pointerId;
    circle.setPointerCapture(pointer);
    event.preventDefault();
    move(event);
  });
  circle.addEventListener("pointermove", (event) => {
    if (event.pointerId === pointer && drive.held) move(event);
  });
  for (const name of ["pointerup", "pointercancel", "lostpointercapture"]) circle.addEventListener(name, end);
  circle.addEventListener("contextmenu", (event) => {
    event.preventDefault();
    pointer = null;
    drive.release();
  });
  drive.addEventListener("change", (event) => {
    circle.classList.toggle("held", event.detail.held);
    if (!event.detail.held) {
      knob.style.transform = "";
    }
  });
}
