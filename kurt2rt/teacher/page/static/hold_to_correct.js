// Hold to correct: an action drives while its button is held, and is a lesson in the situations on the way.

const PRESS_MS = 50;
const HOLD_MS = 300; // a shorter touch is a tap

export class HoldToCorrect extends EventTarget {
  #link;
  #timer = null;
  #pressId = 0;
  action = null; // the held action

  constructor(link) {
    super();
    this.#link = link;
    for (const end of ["blur", "pagehide", "freeze"]) addEventListener(end, () => this.release());
    document.addEventListener("visibilitychange", () => this.release());
  }

  get held() {
    return this.#timer !== null;
  }

  press(action) {
    this.release();
    this.action = action;
    this.#pressId = this.#link.nextPress();
    this.#timer = setInterval(() => this.#send(), PRESS_MS);
    this.#send();
    if (this.held) this.#publish();
  }

  release() {
    if (!this.held) return;
    clearInterval(this.#timer);
    this.#timer = null;
    this.#link.release();
    this.#publish();
  }

  #send() {
    if (!this.#link.hold(this.#pressId, this.action)) this.release();
  }

  #publish() {
    this.dispatchEvent(new CustomEvent("change", { detail: { held: this.held, action: this.action } }));
  }
}

// One button or key that is tapped or held: `begin()` when it goes down, `end()` when it goes up.
export class TapOrHold {
  #hold;
  #mayHold;
  #timer = null;
  #pressed = null; // the action of the button that is down

  constructor(hold, mayHold) {
    this.#hold = hold;
    this.#mayHold = mayHold;
  }

  begin(action) {
    this.cancel();
    this.#pressed = action;
    this.#timer = setTimeout(() => {
      this.#timer = null;
      if (this.#mayHold(action)) this.#hold.press(action);
      else this.#pressed = null;
    }, HOLD_MS);
  }

  // Ends the press; true if it was a tap.
  end() {
    const tapped = this.#timer !== null || this.#pressed === null;
    this.cancel();
    return tapped;
  }

  cancel() {
    clearTimeout(this.#timer);
    this.#timer = null;
    if (this.#pressed !== null && this.#hold.action === this.#pressed) this.#hold.release();
    this.#pressed = null;
  }
}

// Lets a finger tap or hold a button; a hold does not click.
export function holdButton(button, action, press) {
  let pointer = null;
  let wasHeld = false;
  button.addEventListener("pointerdown", (event) => {
    if (pointer !== null || event.button !== 0 || button.closest("[inert]")) return;
    pointer = event.pointerId;
    wasHeld = false;
    button.setPointerCapture(pointer);
    press.begin(action);
  });
  for (const name of ["pointerup", "pointercancel", "lostpointercapture"]) {
    button.addEventListener(name, (event) => {
      if (event.pointerId !== pointer) return;
      pointer = null;
      wasHeld = !press.end();
    });
  }
  button.addEventListener("contextmenu", (event) => event.preventDefault()); // a long touch opens it
  button.addEventListener(
    "click",
    (event) => {
      if (!wasHeld || event.detail === 0) return; // 0: from a keyboard or a screen reader
      wasHeld = false;
      event.stopImmediatePropagation();
    },
    true,
  );
}
