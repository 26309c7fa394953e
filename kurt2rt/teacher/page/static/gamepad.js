// Gamepad: the left stick drives by hand while a shoulder button, the deadman switch, is held; a direction button is
// an action to hold (hold to correct).

import { text } from "./texts.js";

const POLL_MS = 40;
const DEADMAN = [4, 5, 6, 7]; // both shoulders of the standard mapping (W3C Gamepad, 8)
const PRESSED_FROM = 0.5;
// Buttons of the standard mapping -> actions; the first that the robot has. The cross, then X and B.
const ACTIONS = new Map([
  [12, ["forward"]], [13, ["back"]],
  [14, ["curve_left", "bear_left"]], [15, ["curve_right", "bear_right"]],
  [2, ["spin_left", "quarter_turn_left"]], [1, ["spin_right", "quarter_turn_right"]],
]);
const DEAD_SHARE = 0.12;

const deadzone = (value) => (Math.abs(value) < DEAD_SHARE ? 0 : value);

const isDown = (button) => Boolean(button && (button.pressed || button.value >= PRESSED_FROM));

function deadman(pad) {
  return DEADMAN.some((i) => isDown(pad.buttons[i]));
}

export function gamepad({ drive, hold, actions, mayDrive, mayHold, showMessage }) {
  let driving = null; // index of the gamepad that drives
  let spent = new Set(); // gamepads whose press was ended: their button has to be released first
  let timer = null;
  let holding = null; // the pad and the button that holds an action: [index, button]
  const heldBefore = new Set(); // buttons that were down already, or whose hold was ended

  const key = (pad, i) => `${pad.index} ${i}`;
  const actionOf = (i) => ACTIONS.get(i).find((name) => actions().includes(name));

  const endHold = () => {
    if (holding === null) return;
    heldBefore.add(holding.join(" "));
    holding = null;
    hold.release();
  };

  const pollHold = (pad) => {
    for (const i of ACTIONS.keys()) {
      const mine = holding?.[0] === pad.index && holding[1] === i;
      if (!isDown(pad.buttons[i])) {
        heldBefore.delete(key(pad, i));
        if (mine) {
          holding = null;
          hold.release();
        }
      } else if (mine) {
        if (!mayHold()) endHold();
      } else if (!heldBefore.has(key(pad, i))) {
        heldBefore.add(key(pad, i));
        const action = actionOf(i);
        if (!action || holding !== null || hold.held || drive.held || !mayHold() || !document.hasFocus()) continue;
        holding = [pad.index, i];
        hold.press(action);
      }
    }
  };

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
    if (holding !== null && !there.some((pad) => pad.index === holding[0])) endHold();
    for (const pad of there) {
      pollHold(pad);
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
    for (const i of ACTIONS.keys()) if (isDown(pad.buttons[i])) heldBefore.add(key(pad, i));
    timer ??= setInterval(poll, POLL_MS);
  });
  addEventListener("gamepaddisconnected", ({ gamepad: pad }) => {
    if (driving === pad.index) end();
    if (holding?.[0] === pad.index) endHold();
    spent.delete(pad.index);
  });
  for (const lost of ["blur", "pagehide"]) {
    addEventListener(lost, end);
    addEventListener(lost, endHold);
  }
  document.addEventListener("visibilitychange", end);
  document.addEventListener("visibilitychange", endHold);
  hold.addEventListener("change", ({ detail }) => {
    if (!detail.held) endHold();
  });
  // After a press was ended for another reason, such as a lost link, a new press is needed.
  drive.addEventListener("change", ({ detail }) => {
    if (detail.held || driving === null) return;
    spent.add(driving);
    driving = null;
  });
}
