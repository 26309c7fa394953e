// Gamepad: the left stick drives by hand while a shoulder button, the deadman switch, is held.

import { text } from "./texts.js";

const POLL_MS = 40;
const DEADMAN = [4, 5, 6, 7]; // both shoulders of the standard mapping (W3C Gamepad, 8)
const PRESSED_FROM = 0.5;
const DEAD_SHARE = 0.12;

const deadzone = (value) => (Math.abs(value) < DEAD_SHARE ? 0 : value);

function deadman(pad) {
  return DEADMAN.some((i) => pad.buttons[i] && (pad.buttons[i].pressed || pad.buttons[i].value >= PRESSED_FROM));
}

export function gamepad({ drive, mayDrive, showMessage }) {
  let driving = null; // index of the gamepad that drives
  let spent = new Set(); // gamepads whose press was ended: their button has to be released first
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
    if (driving !== null && !there.some((pad) => pad.index === driving)) end(); // disconnected without an event
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
        spent.add(pad.index); // pressed while it may not drive
        continue;
      }
      driving = pad.index;
      drive.press(deadzone(pad.axes[0] ?? 0), -deadzone(pad.axes[1] ?? 0));
    }
    if (!there.length) {
      clearInterval(timer);
      timer = null;
    }
  };

  addEventListener("gamepadconnected", ({ gamepad: pad }) => {
    if (pad.mapping !== "standard") return showMessage("refused", text("gamepadUnknown"));
    showMessage("saved", text("gamepadReady"));
    if (driving === pad.index) end();
    // A button that is held while the gamepad connects was not pressed to drive.
    spent.add(pad.index);
    timer ??= setInterval(poll, POLL_MS);
  });
  addEventListener("gamepaddisconnected", ({ gamepad: pad }) => {
    if (driving === pad.index) end();
    spent.delete(pad.index);
  });
  for (const lost of ["blur", "pagehide"]) addEventListener(lost, end);
  document.addEventListener("visibilitychange", end);
  // After a press was ended for another reason, such as a lost link, a new press is needed.
  drive.addEventListener("change", ({ detail }) => {
    if (detail.held || driving === null) return;
    spent.add(driving);
    driving = null;
  });
}
