// A laptop's keys. Letting go of a key, or of the window, lets go of the robot.

const DIRECTIONS = {
  ArrowUp: [0, 1], KeyW: [0, 1], ArrowDown: [0, -1], KeyS: [0, -1],
  ArrowLeft: [-1, 0], KeyA: [-1, 0], ArrowRight: [1, 0], KeyD: [1, 0],
};

export function keyboard({ drive, stop, go, act, reward, undo, help, mayDrive }) {
  const down = new Set();

  const steer = () => {
    const sum = [0, 0];
    for (const code of down) DIRECTIONS[code].forEach((value, i) => (sum[i] += value));
    if (down.size && (sum[0] || sum[1]) && mayDrive()) drive.hold(...sum);
    else drive.release();
  };

  addEventListener("keydown", (event) => {
    const typing = event.target.matches?.("input, textarea, select");
    if (event.ctrlKey || event.metaKey || event.altKey || typing) return;
    if (event.code in DIRECTIONS) {
      event.preventDefault();
      if (event.repeat) return;
      down.add(event.code);
      steer();
      return;
    }
    if (event.repeat) return;
    const digit = /^Digit([1-9])$|^Numpad([1-9])$/.exec(event.code);
    const does =
      event.code === "Space" ? stop
      : event.code === "Enter" || event.code === "NumpadEnter" ? go
      : event.key === "+" ? () => reward(1)
      : event.key === "-" || event.key === "−" ? () => reward(-1)
      : event.key === "?" ? help
      : event.key.toLowerCase() === "u" ? undo
      : digit ? () => act(Number(digit[1] ?? digit[2]) - 1)
      : null;
    if (!does) return;
    // Space and Enter would also press the button that has the focus.
    event.preventDefault();
    if (event.target.matches?.("button")) event.target.blur();
    does();
  });
  addEventListener("keyup", (event) => {
    if (down.delete(event.code)) steer();
  });
  const forget = () => {
    down.clear();
    drive.release();
  };
  addEventListener("blur", forget);
  document.addEventListener("visibilitychange", forget);
  // A press that ended for another reason needs a new one, not a key that is still down.
  drive.addEventListener("change", (event) => {
    if (!event.detail.held) down.clear();
  });
}
