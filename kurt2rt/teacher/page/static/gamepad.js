// A gamepad: its left stick drives by hand, and only while a shoulder button is held.

const POLL_MS = 40;
const DEADMAN = [4, 5, 6, 7]; // both shoulders of the standard mapping (W3C Gamepad, 8)
const PRESSED_FROM = 0.5;
const DEAD_SHARE = 0.12;

const deadzone = (value) => (Math.abs(value) < DEAD_SHARE ? 0 : value);

function deadman(pad) {
  return DEADMAN.some((i) => pad.buttons[i] && (pad.buttons[i].pressed || pad.buttons[i].value >= PRESSED_FROM));
}

export function gamepad({ drive, mayDrive, say }) {
  let driving = null; // index of the gamepad that holds the robot
  let spent = new Set(); // gamepads whose press ended otherwise: their button has to be let go first
  let timer = null;

  const pads = () => [...navigator.getGamepads()].filter((pad) => pad?.connected && pad.mapping === "standard");

  const end = () => {
    if (driving === null) return;
    spent.add(driving);
    driving = null;
    drive.release();
  };

  const poll = () => {
    const there = pads();
    if (driving !== null && !there.some((pad) => pad.index === driving)) end(); // gone without a word
    for (const pad of there) {
      const held = deadman(pad);
      if (!held) {
        spent.delete(pad.index);
        if (driving === pad.index) {
          driving = null;
          drive.release();
        }
        continue;
      }
      if (spent.has(pad.index)) continue;
      const mayBegin = driving === null && !drive.held && document.hasFocus();
      if (!mayDrive() || (driving !== pad.index && !mayBegin)) {
        if (driving === pad.index) end();
        spent.add(pad.index); // pressed when it was not its turn
        continue;
      }
      driving = pad.index;
      drive.hold(deadzone(pad.axes[0] ?? 0), -deadzone(pad.axes[1] ?? 0));
    }
    if (!there.length) {
      clearInterval(timer);
      timer = null;
    }
  };

  addEventListener("gamepadconnected", ({ gamepad: pad }) => {
    if (pad.mapping !== "standard") return say("refused", "gamepad: its buttons are not known; use another one");
    say("saved", "gamepad: hold a shoulder button, then the left stick drives");
    if (driving === pad.index) end();
    // A button that is held already was not pressed to drive.
    spent.add(pad.index);
    timer ??= setInterval(poll, POLL_MS);
  });
  addEventListener("gamepaddisconnected", ({ gamepad: pad }) => {
    if (driving === pad.index) end();
    spent.delete(pad.index);
  });
  for (const lost of ["blur", "pagehide"]) addEventListener(lost, end);
  document.addEventListener("visibilitychange", end);
  // A press that ended for another reason, such as a lost link, needs a new one.
  drive.addEventListener("change", ({ detail }) => {
    if (detail.held || driving === null) return;
    spent.add(driving);
    driving = null;
  });
}
