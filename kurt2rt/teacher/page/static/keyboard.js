// Keys of a laptop. Releasing a key or leaving the window ends the drive.

const DIRECTIONS = {
  ArrowUp: [0, 1], KeyW: [0, 1], ArrowDown: [0, -1], KeyS: [0, -1],
  ArrowLeft: [-1, 0], KeyA: [-1, 0], ArrowRight: [1, 0], KeyD: [1, 0],
};

const hasFocus = () => document.activeElement !== null && document.activeElement !== document.body;

export function keyboard({ drive, stop, resume, act, press, actionOf, reward, undo, rewind, why, help, mayDrive }) {
  const down = new Set();
  let digitDown = null; // code of the digit that is down
  let digitAct = null; // what a tap of it does
  let digitHolds = false; // whether it may be held

  const steer = () => {
    const sum = [0, 0];
    for (const code of down) DIRECTIONS[code].forEach((value, i) => (sum[i] += value));
    if (down.size && (sum[0] || sum[1]) && mayDrive()) drive.press(...sum);
    else drive.release();
  };

  addEventListener("keydown", (event) => {
    const slider = event.target.matches?.("input[type=range]");
    const typing = !slider && event.target.matches?.("input, textarea, select");
    if (event.ctrlKey || event.metaKey || event.altKey) {
      releaseAll(); // the browser may swallow the keyup of keys held with these
      return;
    }
    if (typing) return;
    if (slider && event.code.startsWith("Arrow")) return; // the arrows move the slider
    if (event.code in DIRECTIONS) {
      event.preventDefault();
      if (event.repeat) return;
      down.add(event.code);
      steer();
      return;
    }
    const enter = event.code === "Enter" || event.code === "NumpadEnter";
    const dialog = document.querySelector("dialog[open]");
    // Enter belongs to the focused element; only without one it is GO.
    if (enter && (dialog || hasFocus())) return;
    if (event.code === "Escape" && dialog) {
      dialog.close();
      return;
    }
    const digit = /^Digit([1-9])$|^Numpad([1-9])$/.exec(event.code);
    if (digit) {
      event.preventDefault();
      if (event.repeat || digitDown !== null) return;
      digitDown = event.code;
      const i = Number(digit[1] ?? digit[2]) - 1;
      const action = actionOf(i);
      if (action === null) act(i); // this digit can only be tapped
      else press.begin(action);
      digitAct = () => act(i);
      digitHolds = action !== null;
      return;
    }
    const does =
      event.code === "Space" ? stop
      : enter ? resume
      : event.key === "+" ? () => reward(1)
      : event.key === "-" || event.key === "−" ? () => reward(-1)
      : event.key === "0" ? () => reward(0)
      : event.key === "?" ? help
      : event.key.toLowerCase() === "u" ? undo
      : event.key.toLowerCase() === "r" ? rewind
      : event.key.toLowerCase() === "y" ? why
      : null;
    if (!does) return;
    event.preventDefault();
    if (!event.repeat) does();
  });
  addEventListener("keyup", (event) => {
    // Space has stopped the robot; it must not press the focused button too.
    if (event.code === "Space" && event.target.matches?.("button")) event.preventDefault();
    if (down.delete(event.code)) steer();
    if (event.code === digitDown) {
      digitDown = null;
      if (digitHolds && press.end()) digitAct();
    }
  });
  const releaseAll = () => {
    down.clear();
    digitDown = null;
    press.cancel();
    drive.release();
  };
  addEventListener("blur", releaseAll);
  // The browser's menu swallows the keyup.
  document.addEventListener("contextmenu", releaseAll);
  document.addEventListener("visibilitychange", releaseAll);
  // After a press was ended for another reason, a key that is still down does not drive.
  drive.addEventListener("change", (event) => {
    if (!event.detail.held) down.clear();
  });
}
