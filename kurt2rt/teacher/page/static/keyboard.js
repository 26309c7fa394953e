// A laptop's keys. Letting go of a key, or of the window, lets go of the robot.

const DIRECTIONS = {
  ArrowUp: [0, 1], KeyW: [0, 1], ArrowDown: [0, -1], KeyS: [0, -1],
  ArrowLeft: [-1, 0], KeyA: [-1, 0], ArrowRight: [1, 0], KeyD: [1, 0],
};

const hasFocus = () => document.activeElement !== null && document.activeElement !== document.body;

export function keyboard({ drive, stop, go, act, signal, undo, why, help, mayDrive }) {
  const down = new Set();

  const steer = () => {
    const sum = [0, 0];
    for (const code of down) DIRECTIONS[code].forEach((value, i) => (sum[i] += value));
    if (down.size && (sum[0] || sum[1]) && mayDrive()) drive.hold(...sum);
    else drive.release();
  };

  addEventListener("keydown", (event) => {
    const typing = event.target.matches?.("input, textarea, select");
    if (event.ctrlKey || event.metaKey || event.altKey) {
      forget(); // the browser may swallow the keyup of what is held together with these
      return;
    }
    if (typing) return;
    if (event.code in DIRECTIONS) {
      event.preventDefault();
      if (event.repeat) return;
      down.add(event.code);
      steer();
      return;
    }
    const enter = event.code === "Enter" || event.code === "NumpadEnter";
    const asked = document.querySelector("dialog[open]");
    // Enter belongs to what has the focus, a button most of all; to the robot only where nothing has it.
    if (enter && (asked || hasFocus())) return;
    if (event.code === "Escape" && asked) {
      asked.close();
      return;
    }
    const digit = /^Digit([1-9])$|^Numpad([1-9])$/.exec(event.code);
    const does =
      event.code === "Space" ? stop
      : enter ? go
      : event.key === "+" ? () => signal(1)
      : event.key === "-" || event.key === "−" ? () => signal(-1)
      : event.key === "0" ? () => signal(0)
      : event.key === "?" ? help
      : event.key.toLowerCase() === "u" ? undo
      : event.key.toLowerCase() === "y" ? why
      : digit ? () => act(Number(digit[1] ?? digit[2]) - 1)
      : null;
    if (!does) return;
    event.preventDefault();
    if (!event.repeat) does();
  });
  addEventListener("keyup", (event) => {
    // Space has stopped the robot; it must not press the button that has the focus as well.
    if (event.code === "Space" && event.target.matches?.("button")) event.preventDefault();
    if (down.delete(event.code)) steer();
  });
  const forget = () => {
    down.clear();
    drive.release();
  };
  addEventListener("blur", forget);
  // A menu of the browser's own swallows the keyup.
  document.addEventListener("contextmenu", forget);
  document.addEventListener("visibilitychange", forget);
  // A press that ended for another reason needs a new one, not a key that is still down.
  drive.addEventListener("change", (event) => {
    if (!event.detail.held) down.clear();
  });
}
