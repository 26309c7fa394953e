// The teacher's page: it shows the robot's messages and sends the teacher's touches.

import { ActionPad, STAND, WITHDRAWN, words } from "./actions.js";
import { Bubbles } from "./bubbles.js";
import { onTheme } from "./canvas.js";
import { Compare } from "./compare.js";
import { Critic, CRITIC } from "./critic.js";
import { Decision, setText } from "./decision.js";
import { Exam } from "./exam.js";
import { Explanation } from "./explanation.js";
import { Files } from "./files.js";
import { gamepad } from "./gamepad.js";
import { Goals } from "./goals.js";
import { HoldToCorrect, TapOrHold } from "./hold_to_correct.js";
import { Health } from "./health.js";
import { keyboard } from "./keyboard.js";
import { Lessons, twice } from "./lessons.js";
import { Link } from "./link.js";
import { Drive, driveCircle } from "./manual_drive.js";
import { MidLevelPad } from "./mid_level.js";
import { BASIC, MID } from "./mid_text.js";
import { Progress } from "./progress.js";
import { Rewind } from "./rewind.js";
import { drawRobot } from "./robot_view.js";
import { Shown } from "./shown.js";
import { SessionPanel } from "./session.js";
import { Simulation } from "./simulation.js";
import { text } from "./texts.js";
import { WorldView } from "./world_view.js";

const $ = (id) => document.getElementById(id);
const TABS = ["teach", "drive", "goals", "lessons", "more"];
const CONTROLLED = ["teach", "drive", "goals", "more", "behaviours", "levels"]; // inert while this page has no control
const FASTEST_BY_HAND_M_S = 0.6;
const MESSAGE_MS = 8000;
const STATE_MS = 1000;
const OFFER_MS = 30000;
const LIST_MS = 5000;
const LONG_ANSWER = 80; // characters, beyond two lines of a phone

const link = new Link();
const drive = new Drive(link);
const decision = new Decision();
const hold = new HoldToCorrect(link);
const buttonPress = new TapOrHold(hold, mayHold);
const actionPad = new ActionPad($("actions"), teach, buttonPress);
const lessons = new Lessons((lesson) => sendCommand("/undo", { lesson }));
const midPad = new MidLevelPad(teachBehaviour);
const goals = new Goals(sendCommand);
const critic = new Critic(appraise);
const health = new Health();
const explanation = new Explanation(link);
const compare = new Compare(link);
const session = new SessionPanel(sendCommand);
const files = new Files(sendCommand, showMessage);
const exam = new Exam(sendCommand);
const progress = new Progress(suggestExam);
const simulation = new Simulation({ sendCommand, showMessage, inControl });
const shownDrive = new Shown((pressId, segments) => sendCommand("/shown", { press_id: pressId, segments }, "teach what was shown"));
const rewind = new Rewind({ stop, onChange: draw });
const world = new WorldView($("world-view"), (path, fields) => sendCommand(path, fields), rewind);

let hello = null;
let page = { seat: "elsewhere", device: "", robot: "" };

// ---- Commands

const TEACHES = ["/answer", "/correct", "/shown", "/reward", "/appraise", "/undo", "/name"];
let pendingLessons = 0; // commands of TEACHES without an answer
let answered = 0; // number of the newest answered one
let taughtNothing = false; // whether the newest of them but undo was accepted and gave no lesson

// Sends a command and shows its outcome: pending, then saved or refused. Resolves with the answer.
async function sendCommand(path, fields = {}, doing = path.split("/").pop()) {
  showMessage("pending", `${doing} …`);
  if (!TEACHES.includes(path)) return showAnswer(await link.command(path, fields));
  pendingLessons += 1;
  const answer = await link.command(path, fields);
  pendingLessons -= 1;
  answered = Math.max(answered, answer.done ?? 0);
  if (path !== "/undo") taughtNothing = answer.accepted && !answer.extra.lesson;
  return showAnswer(answer);
}

function showAnswer(answer) {
  const { accepted, why, text: said } = answer;
  if (accepted) showMessage("saved", words(said) || "done");
  else showMessage("refused", said || `refused: ${why}`);
  navigator.vibrate?.(answer.accepted ? 20 : [30, 40, 30]);
  return answer;
}

let hideTimer = null;

// `offer`: label of a button next to the sentence, and what its touch does.
function showMessage(outcome, sentence, offer = null) {
  const line = $("said");
  $("offer").hidden = !offer;
  if (offer) [$("offer").textContent, $("offer").onclick] = offer;
  line.className = outcome;
  line.classList.toggle("long", sentence.length > LONG_ANSWER);
  setText(line, sentence);
  clearTimeout(hideTimer);
  if (outcome === "pending") return;
  hideTimer = setTimeout(() => {
    setText(line, "\u00a0");
    $("offer").hidden = true;
  }, offer ? OFFER_MS : MESSAGE_MS);
}

// ---- Hold to correct

let heldHere = null; // id of the lessons of this page's last hold

// A hold does not let a stopped robot drive; a long touch is a tap there, and for the action that stands.
function mayHold(action) {
  return action !== STAND && inControl() && link.fresh && !rewind.open && !link.state.stands.needs_go;
}

hold.addEventListener("change", ({ detail }) => {
  actionPad.markHeld(detail.action, detail.held);
  if (detail.held) heldHere = null;
  else if (heldHere === null) showMessage("saved", text("held", { action: words(detail.action), lessons: 0 }));
});

// Shows the lessons of this page's hold while it lasts, and offers to undo them together when it is over.
function showHold({ hold: told }) {
  if (!told || told.teacher !== page.device) return;
  if (hold.held && told.on) heldHere = told.lesson;
  if (heldHere !== told.lesson) return;
  const fields = { action: words(told.action), lessons: told.lessons };
  if (told.on) {
    showMessage("pending", text("holding", fields));
  } else {
    heldHere = undefined;
    showMessage("saved", text("held", fields), told.lessons ? ["Undo", () => sendCommand("/undo", { lesson: told.lesson })] : null);
  }
}

function teach(action) {
  if (!link.state) return;
  if (action === STAND && !touchedAgain()) {
    showMessage("asks", text("standAgain"));
    return;
  }
  if (rewind.open) {
    correctEarlier(action);
    return;
  }
  // Beyond R, at a withdrawn action and in doubt the touch is an answer: it also confirms the action of the RLA.
  const { nearest, nearest_action: its, distance, radius, asks_at: at, cause } = link.state;
  // While the mid level asks, the state has its nearest RLA; a correction of the basic level is always valid.
  const asks = at === BASIC && (cause === "doubt" || nearest === null || its === WITHDRAWN || distance === null || distance > radius);
  // A person corrects late; the robot knows by how much.
  sendLesson(actionPad, action, asks ? "/answer" : "/correct", asks ? {} : { late: true }, asks);
}

let standTouchedMs = -Infinity;

// True for the second touch within a few seconds: a rule to stand is one that a robot alone never leaves.
function touchedAgain() {
  const before = standTouchedMs;
  standTouchedMs = performance.now();
  return standTouchedMs - before < MESSAGE_MS;
}

// Corrects the picked moment; with "then go" the robot drives on, unless it was stopped since this touch.
async function correctEarlier(action) {
  const { picture, stops } = link;
  const answer = await sendLesson(actionPad, action, "/correct", { decision_tick: rewind.state.tick }, false);
  if (!answer?.accepted || !rewind.open || !rewind.drivesOn || link.stops !== stops) return;
  const went = await link.command("/resume", {}, picture);
  if (went.accepted) rewind.leave();
  else showAnswer(went);
}

// Teaches the mid level; `meant`: teach (right here), also (an alternative) or once (no lesson).
function teachBehaviour(behaviour, meant) {
  if (!link.state?.mid) return;
  if (meant === "once") {
    if (!refuseEarly(behaviour)) sendCommand("/pursue", { behaviour }, `${words(behaviour)}, this once`);
    return;
  }
  const { nearest, nearest_behaviour: its, distance, radius } = link.state.mid;
  const asks = nearest === null || its === WITHDRAWN || distance === null || distance > radius;
  const alternative = !asks && meant === "also";
  if (asks || alternative) sendLesson(midPad, behaviour, "/answer", { level: MID, alternative }, asks);
  else sendLesson(midPad, behaviour, "/correct", { level: MID }, false);
}

// Sends a lesson of a pad's button and returns the answer; `asks`: it answers a question.
async function sendLesson(pad, action, path, fields, asks) {
  if (refuseEarly(action)) return null;
  if (asks) setAnswering(true);
  pad.markOutcome(action, "pending");
  const answer = await sendCommand(path, { action, ...fields }, `${path.slice(1)}: ${words(action)}`);
  pad.markOutcome(action, answer.accepted ? "saved" : "refused");
  setTimeout(() => pad.markOutcome(action, null), 900);
  if (!asks) return answer;
  if (answer.accepted || answer.why === "unknown") await stateAfter(answer.tick ?? -1);
  setAnswering(false);
  return answer;
}

// Refuses a second answer to a question, which would make a second RLA, and an answer to one that has just changed.
function refuseEarly(action) {
  if (!answering && !midPad.justTurned) return false;
  showMessage("busy", text(answering ? "awaitPicture" : "questionChanged", { action: words(action) }));
  return true;
}

let answering = false;

function setAnswering(is) {
  answering = is;
  for (const id of ["actions", "ways"]) $(id).setAttribute("aria-busy", String(is));
}

// Resolves with the first new state that is newer than a tick, or after a second.
function stateAfter(tick) {
  return new Promise((resolve) => {
    const end = () => {
      clearTimeout(timer);
      link.removeEventListener("state", see);
      resolve();
    };
    const see = ({ detail }) => detail.tick > tick && end();
    const timer = setTimeout(end, STATE_MS);
    link.addEventListener("state", see);
  });
}

// Resolves with the newest valid lesson once the list has all lessons of this page; undefined without one.
async function newestLesson() {
  const until = performance.now() + LIST_MS;
  while (pendingLessons || lessons.after < answered) {
    if (performance.now() > until) return undefined;
    await new Promise((resolve) => setTimeout(resolve, 50));
  }
  return lessons.newest;
}

let undoCandidate = null;

// The first tap names the lesson; later lessons stay.
async function prepareUndo() {
  undoCandidate = newestLesson();
  const lesson = await undoCandidate;
  // An accepted press that gave no lesson leaves nothing of itself to undo.
  if (lesson) showMessage("asks", text(taughtNothing ? "undoEarlier" : "undoAgain", { lesson: lesson.text }));
}

async function undoLast() {
  const lesson = await undoCandidate;
  if (lesson) sendCommand("/undo", { lesson: lesson.command_id });
  else showMessage("refused", text("nothingToUndo"));
}

function suggestExam(because) {
  const offer = exam.available && inControl() ? ["Exam", () => exam.begin()] : null;
  showMessage("saved", offer ? `${because} Exam?` : because, offer);
}

// Sends a reward, or in phase 4 an appraisal for the critic.
function reward(value) {
  if (link.state && critic.teaches(link.state)) {
    const name = critic.nameOf(value);
    if (name !== undefined) appraise(name);
  } else if (value) {
    sendCommand("/reward", { value }, value > 0 ? "right" : "wrong");
  }
}

function appraise(appraisal) {
  sendCommand("/appraise", { appraisal }, `to the critic: ${words(appraisal)}`);
}

const resume = () => {
  rewind.leave();
  return sendCommand("/resume", {}, "go");
};

function releaseAll() {
  drive.release();
  hold.release();
}

async function stop() {
  releaseAll();
  showMessage("pending", "stop …");
  showAnswer(await link.stop());
}

// ---- Messages of the server

link.addEventListener("page", ({ detail }) => {
  page = detail;
  showControl();
});

link.addEventListener("hello", ({ detail }) => {
  hello = detail;
  session.build(hello);
  actionPad.build(hello.actions);
  midPad.build(hello);
  goals.build(hello);
  critic.build(hello);
  world.setHello(hello);
  rewind.setHello(hello);
  shownDrive.setHello(hello);
  files.build(hello);
  exam.build(hello);
  setText($("what"), hello.what || `Task ${words(hello.task)}`);
  simulation.build(hello);
  setText($("robot-name"), `${hello.robot}, task ${hello.task}, at ${page.robot}`);
  setText($("keys-actions"), (hello.mid ? "the ways, or " : "") + hello.actions.slice(0, 9).map((name, i) => `${i + 1} ${words(name)}`).join(", "));
  applyPace();
});

link.addEventListener("world", ({ detail }) => {
  world.world = detail;
});
link.addEventListener("simulation", ({ detail }) => simulation.update(detail));
link.addEventListener("exam", ({ detail }) => exam.update(detail));
link.addEventListener("health", ({ detail }) => health.update(detail));
link.addEventListener("situations", ({ detail }) => goals.list(detail.situations));
link.addEventListener("lessons", ({ detail }) => lessons.show(detail.lessons, detail.after, page.device));
link.addEventListener("let_go", ({ detail }) => {
  const ended = hold.held ? "holdEnded" : "driveEnded";
  heldHere = undefined;
  releaseAll();
  showMessage("refused", detail.text || text(ended));
});
link.addEventListener("silent", ({ detail }) => setText($("no-picture-why"), detail.text));
link.addEventListener("open", () => {
  answered = 0; // a new server counts from 0
  setText($("no-picture-why"), text("awaitRobot"));
});
// A STOP without an answer is shown as pending.
link.addEventListener("stoppending", ({ detail: pending }) => {
  $("stop").classList.toggle("wished", pending);
  setText($("stop"), pending ? "STOP …" : "STOP");
});
link.addEventListener("closed", () => {
  setText($("no-picture-why"), text("awaitServer"));
  page = { ...page, seat: "elsewhere" };
});
link.addEventListener("stopped", ({ detail }) => showAnswer(detail));
link.addEventListener("freshness", showFreshness);

link.addEventListener("state", ({ detail: state }) => {
  world.update(state);
  rewind.add(state);
  requestAnimationFrame(show);
});

let shown = null;

function show() {
  const state = link.state;
  if (!state || !hello || shown === state) return;
  shown = state;
  const slow = state.speed_share < 1 ? `, slow, ${Math.round(100 * state.speed_share)} %` : "";
  setText($("phase"), `${state.phase}, ${session.phaseNames[state.phase - 1] ?? ""}${slow}`);
  setText($("clock"), clock(state.clock_s));
  setText($("session"), state.session ?? "no session");
  $("rewind").disabled = $("rewind-time").disabled = !rewind.ready || !inControl();
  $("go").disabled = !state.stands.needs_go || state.by_hand || !inControl();
  showLink(state);
  progress.show(state, simulation.simulation);
  decision.show(state, hello);
  compare.update(decision.worded);
  announce(state);
  actionPad.show(state);
  shownDrive.show(state, page.device);
  midPad.show(state);
  goals.show(state);
  critic.show(state, lessons.newestOf(CRITIC));
  showWarnings(state);
  health.show(state);
  showHold(state);
  if (state.refused && drive.held) showMessage("refused", state.refused);
  session.show(state, inControl());
  showControl();
  draw();
}

let announced = "";

// Announces a question to a screen reader, once each time that the robot begins to ask.
function announce(state) {
  const { asks: does, needs_go: waits, reason } = state.stands;
  const asks = does && !waits ? `${reason} ${state.behaviour}` : "";
  if (asks === announced) return;
  announced = asks;
  setText($("announce"), asks ? $("sentence").textContent : "");
}

// Draws the robot in its room, or alone where no room is known.
function draw() {
  const asked = rewind.state ?? decision.worded;
  if (!hello || !link.state || !asked) return; // nothing is worded before the first frame
  $("robot-view").hidden = world.ready;
  $("world-view").hidden = !world.ready;
  compare.draw(hello, link.state, asked);
  if (world.ready) world.draw(asked);
  else drawRobot($("robot-view"), hello, rewind.state ?? link.state, asked);
}

function showLink(state) {
  const { age_ms: age, rtt_ms: rtt, pictures_per_s: rate } = state.link;
  const both = rtt === null ? null : rtt + (link.pageRttMs ?? 0);
  const parts = [`${Math.round(rate ?? 0)}/s`, both === null ? "" : `${both.toFixed(0)} ms`, age > 150 ? `${age} ms old` : ""];
  setText($("link-text"), parts.filter(Boolean).join(" · "));
}

function showFreshness() {
  const lost = !link.fresh;
  document.body.classList.toggle("no-picture", lost);
  for (const id of CONTROLLED) $(id).inert = lost || !inControl();
  if (lost) {
    releaseAll();
    setText($("link-text"), "no word");
    $("go").disabled = true;
  }
}

function showWarnings(state) {
  const lines = state.trouble ? [state.trouble] : [];
  lines.push(...health.urgent(state));
  if (state.unsaved) lines.push(`${state.unsaved} lessons not saved yet`);
  const box = $("warnings");
  if (lines.join("\n") === [...box.children].map((each) => each.textContent).join("\n")) return;
  box.replaceChildren(
    ...lines.map((text) => {
      const line = document.createElement("span");
      line.textContent = text;
      return line;
    }),
  );
}

function clock(seconds) {
  const whole = Math.floor(seconds);
  return `${Math.floor(whole / 60)}:${String(whole % 60).padStart(2, "0")}`;
}

// ---- Control

function inControl() {
  return page.seat === "here" && link.state?.teacher === page.device;
}

function showControl() {
  const state = link.state;
  const box = $("claim");
  box.hidden = inControl() || !state;
  document.body.classList.toggle("watches", !inControl());
  for (const id of CONTROLLED) $(id).inert = !inControl() || !link.fresh;
  if (box.hidden) return;
  releaseAll();
  const another = state.teacher && state.teacher !== page.device;
  const { teacher } = state;
  const reason = another ? "otherTeacher" : { elsewhere: "controlElsewhere", free: "controlFree" }[page.seat] ?? "noTeacher";
  setText($("claim-text"), text(reason, { teacher }));
  setText($("claim-button"), text(another ? "takeOver" : page.seat === "here" ? "takeRobot" : "takeControl", { teacher }));
}

async function take() {
  const { accepted } = await sendCommand("/take", {}, "take");
  if (accepted) showMessage("saved", text("taken"));
}
$("claim-button").addEventListener("click", take);
$("take-here").addEventListener("click", take);

// ---- Touch

$("stop").addEventListener("pointerdown", (event) => {
  // At the touch itself, not when the finger is lifted.
  event.preventDefault();
  stop();
});
$("stop").addEventListener("click", (event) => {
  if (event.detail === 0) stop(); // from a keyboard or a screen reader: no touch came before it
});
$("go").addEventListener("click", resume);
$("praise").addEventListener("click", () => reward(1));
$("blame").addEventListener("click", () => reward(-1));
twice($("undo-last"), "sure?", undoLast, prepareUndo);

driveCircle($("stick"), $("knob"), drive);
drive.addEventListener("change", ({ detail }) => {
  const [left, right] = detail.speeds;
  setText($("speeds"), detail.held ? `left ${left.toFixed(2)}, right ${right.toFixed(2)} m/s` : text("holdCircle"));
});

for (const button of $("pace").querySelectorAll("button")) {
  button.addEventListener("click", () => {
    for (const each of $("pace").querySelectorAll("button")) each.setAttribute("aria-pressed", String(each === button));
    applyPace();
  });
}

function applyPace() {
  const share = Number($("pace").querySelector("[aria-pressed=true]").dataset.share);
  drive.most = share * Math.min(FASTEST_BY_HAND_M_S, hello?.max_m_s ?? FASTEST_BY_HAND_M_S);
}

function showTab(name) {
  releaseAll();
  for (const each of TABS) {
    $(each).hidden = each !== name;
    $(`tab-${each}`).setAttribute("aria-selected", String(each === name));
  }
}
TABS.forEach((name) => {
  $(`tab-${name}`).addEventListener("click", (event) => {
    showTab(name);
    if (event.detail > 0) event.currentTarget.blur(); // after a click the arrow keys steer
  });
  $(`tab-${name}`).addEventListener("keydown", (event) => {
    if (name === "drive") return; // there the arrow keys steer
    const step = { ArrowRight: 1, ArrowLeft: -1 }[event.key];
    if (!step) return;
    event.stopPropagation();
    const tabs = TABS.filter((each) => !$(`tab-${each}`).hidden);
    const next = tabs[(tabs.indexOf(name) + step + tabs.length) % tabs.length];
    showTab(next);
    $(`tab-${next}`).focus();
  });
});

new ResizeObserver(draw).observe($("stage"));
onTheme(draw);
new Bubbles();

// Not modal, so that STOP and GO stay free.
const help = () => ($("keys").open ? $("keys").close() : $("keys").show());
$("show-keys").addEventListener("click", help);
$("close-keys").addEventListener("click", () => $("keys").close());

keyboard({
  drive,
  stop,
  resume: () => !$("go").disabled && resume(),
  act: (i) => {
    if (!inControl()) return;
    if (midPad.level === MID) midPad.names[i] && midPad.choose(midPad.names[i]);
    else if (actionPad.names[i]) teach(actionPad.names[i]);
  },
  press: new TapOrHold(hold, mayHold),
  actionOf: (i) => (inControl() && midPad.level !== MID ? actionPad.names[i] ?? null : null),
  reward: (value) => inControl() && reward(value),
  undo: () => inControl() && $("undo-last").checkVisibility() && $("undo-last").click(),
  rewind: () => $("rewind").click(),
  why: () => explanation.toggle(),
  help,
  mayDrive: () => inControl() && link.fresh,
});
gamepad({ drive, hold, actions: () => actionPad.names, mayDrive: () => inControl() && link.fresh, mayHold, showMessage });

// ---- The screen stays on where the browser allows it.

async function stayAwake() {
  if (document.visibilityState !== "visible" || !navigator.wakeLock) return;
  try {
    await navigator.wakeLock.request("screen");
  } catch {
    // Refused, for example because of a low battery: the screen's time-out ends presence, and the robot stops.
  }
}
document.addEventListener("visibilitychange", stayAwake);
stayAwake();

link.start();
