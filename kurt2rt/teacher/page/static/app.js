// The teacher's page: what comes from the robot is shown, what the teacher touches is sent.

import { ActionPad, WITHDRAWN, words } from "./actions.js";
import { Bubbles } from "./bubbles.js";
import { onTheme } from "./canvas.js";
import { Critic, CRITIC } from "./critic.js";
import { Exam } from "./exam.js";
import { Explanation } from "./explanation.js";
import { Files } from "./files.js";
import { gamepad } from "./gamepad.js";
import { Goals } from "./goals.js";
import { Health } from "./health.js";
import { keyboard } from "./keyboard.js";
import { Lessons, twice } from "./lessons.js";
import { Link } from "./link.js";
import { BASIC, MID } from "./mid.js";
import { Organising } from "./organising.js";
import { showProgress } from "./progress.js";
import { drawRobot } from "./robot_view.js";
import { Simulation } from "./simulation.js";
import { Drive, stick } from "./stick.js";
import { Ways } from "./ways.js";
import { setText, Why } from "./why.js";
import { WorldView } from "./world_view.js";

const $ = (id) => document.getElementById(id);
const TABS = ["teach", "drive", "goals", "lessons", "more"];
const IN_CHARGE = [...TABS, "behaviours", "levels"]; // what only the teacher may touch
const FASTEST_BY_HAND_M_S = 0.6;
const SAID_MS = 8000;
const PICTURE_MS = 1000;
const LIST_MS = 5000;

const link = new Link();
const drive = new Drive(link);
const why = new Why();
const pad = new ActionPad($("actions"), teach);
const lessons = new Lessons((lesson) => tell("undo", { lesson }));
const ways = new Ways(teachWay);
const goals = new Goals(tell);
const critic = new Critic(appraise);
const health = new Health();
const explanation = new Explanation(link);
const organising = new Organising(tell);
const files = new Files(tell, say);
const exam = new Exam(tell);
const simulation = new Simulation(tell);
const world = new WorldView($("world-view"), (name, args) => tell(name, args));

let hello = null;
let page = { seat: "elsewhere", device: "", robot: "" };

// ---- Orders

const TEACHES = ["answer", "correct", "reward", "appraise", "undo", "name"];
let teaching = 0; // orders of these that are not answered yet
let taught = 0; // number of the newest that was

// Says what became of an order: pending, then saved or refused.
async function tell(name, args = {}, doing = words(name)) {
  say("pending", `${doing} …`);
  if (!TEACHES.includes(name)) return heed(await link.order(name, args));
  teaching += 1;
  const answer = await link.order(name, args);
  teaching -= 1;
  taught = Math.max(taught, answer.done ?? 0);
  return heed(answer);
}

function heed(answer) {
  say(answer.accepted ? "saved" : "refused", answer.text || (answer.accepted ? "done" : `refused: ${answer.why}`));
  navigator.vibrate?.(answer.accepted ? 20 : [30, 40, 30]);
  return answer;
}

let forgetting = null;

function say(outcome, text) {
  const line = $("said");
  line.className = outcome;
  setText(line, text);
  clearTimeout(forgetting);
  if (outcome !== "pending") forgetting = setTimeout(() => setText(line, "\u00a0"), SAID_MS);
}

function teach(action) {
  if (!link.state) return;
  // Beyond R there is no RLA to correct, nor where its action was withdrawn, whether the robot asks just now or not.
  const { nearest, nearest_action: its, distance, radius, asks_at: at } = link.state;
  // While the mid level asks, these are of that level; a correction is right however near the basic one's RLAs are.
  const asks = at === BASIC && (nearest === null || its === WITHDRAWN || distance === null || distance > radius);
  give(pad, action, asks ? "answer" : "correct", asks ? { level: BASIC, beside: false } : { level: BASIC }, asks);
}

// At the mid level; `meant` says whether it is right here, possible too, or wanted only this once.
function teachWay(behaviour, meant) {
  if (!link.state?.mid) return;
  if (meant === "once") {
    if (!tooEarly(behaviour)) tell("pursue", { behaviour }, `${words(behaviour)}, this once`);
    return;
  }
  const { nearest, nearest_behaviour: its, distance, radius } = link.state.mid;
  const asks = nearest === null || its === WITHDRAWN || distance === null || distance > radius;
  const beside = !asks && meant === "beside";
  if (asks || beside) give(ways, behaviour, "answer", { level: MID, beside }, asks);
  else give(ways, behaviour, "correct", { level: MID }, false);
}

// A lesson from the buttons of a pad: `asks` where it answers a question.
async function give(from, action, name, args, asks) {
  if (tooEarly(action)) return;
  if (asks) busy(true);
  from.mark(action, "pending");
  const answer = await tell(name, { action, ...args }, `${name}: ${words(action)}`);
  from.mark(action, answer.accepted ? "saved" : "refused");
  setTimeout(() => from.mark(action, null), 900);
  if (!asks) return;
  if (answer.accepted || answer.why === "unknown") await pictureAfter(answer.tick ?? -1);
  busy(false);
}

// The question on the screen is answered already, or has just taken another one's place: a second answer would be a
// second RLA beside the first.
function tooEarly(action) {
  if (!asking && !ways.justTurned) return false;
  const wait = asking ? "wait for the picture after the last answer" : "the question has just changed, look again";
  say("busy", `${words(action)} was not sent: ${wait}`);
  return true;
}

let asking = false;

function busy(is) {
  asking = is;
  for (const id of ["actions", "ways"]) $(id).setAttribute("aria-busy", String(is));
}

// A picture that came from now on and is newer than a tick; or for a second none did.
function pictureAfter(tick) {
  return new Promise((resolve) => {
    const end = () => {
      clearTimeout(timer);
      link.removeEventListener("state", see);
      resolve();
    };
    const see = ({ detail }) => detail.tick > tick && end();
    const timer = setTimeout(end, PICTURE_MS);
    link.addEventListener("state", see);
  });
}

// The newest lesson that stands, once the list has all that was taught from here; undefined without one.
async function newestLesson() {
  const until = performance.now() + LIST_MS;
  while (teaching || lessons.after < taught) {
    if (performance.now() > until) return undefined;
    await new Promise((resolve) => setTimeout(resolve, 50));
  }
  return lessons.newest;
}

let meant = null;

// The lesson is named at the first tap; whatever is taught until the second one stays.
async function askUndo() {
  meant = newestLesson();
  const lesson = await meant;
  if (lesson) say("asks", `undo ${lesson.text}? touch again`);
}

async function undoLast() {
  const lesson = await meant;
  if (lesson) tell("undo", { lesson: lesson.command_id });
  else say("refused", "no lesson that stands is in the list; nothing was sent");
}

// In phase 4 the signals are the critic's lessons.
function signal(value) {
  if (link.state && critic.teaches(link.state)) {
    const name = critic.nameOf(value);
    if (name !== undefined) appraise(name);
  } else if (value) {
    tell("reward", { value }, value > 0 ? "right" : "wrong");
  }
}

function appraise(appraisal) {
  tell("appraise", { appraisal }, `to the critic: ${words(appraisal)}`);
}

const go = () => tell("resume", {}, "go");

async function stop() {
  drive.release();
  say("pending", "stop …");
  heed(await link.stop());
}

// ---- What comes

link.addEventListener("page", ({ detail }) => {
  page = detail;
  claim();
});

link.addEventListener("hello", ({ detail }) => {
  hello = detail;
  organising.build(hello);
  pad.build(hello.actions);
  ways.build(hello);
  goals.build(hello);
  critic.build(hello);
  world.greet(hello);
  files.build(hello);
  exam.build(hello);
  setText($("what"), hello.what || `Task ${words(hello.task)}`);
  simulation.build(hello);
  setText($("robot-name"), `${hello.robot}, task ${hello.task}, at ${page.robot}`);
  setText($("keys-actions"), (hello.mid ? "the ways, or " : "") + hello.actions.slice(0, 9).map((name, i) => `${i + 1} ${words(name)}`).join(", "));
  $("view").hidden = !hello.simulated;
  document.body.classList.toggle("simulated", hello.simulated);
  if (!hello.simulated) showView("robot");
  pace();
});

link.addEventListener("world", ({ detail }) => {
  world.world = detail;
});
link.addEventListener("simulation", ({ detail }) => simulation.see(detail));
link.addEventListener("exam", ({ detail }) => exam.see(detail));
link.addEventListener("health", ({ detail }) => health.see(detail));
link.addEventListener("situations", ({ detail }) => goals.list(detail.situations));
link.addEventListener("lessons", ({ detail }) => lessons.show(detail.lessons, detail.after));
link.addEventListener("let_go", ({ detail }) => {
  drive.release();
  say("refused", detail.text || "the press was ended; press anew");
});
link.addEventListener("silent", ({ detail }) => setText($("no-picture-why"), detail.text));
link.addEventListener("open", () => {
  taught = 0; // the server may be another one, which counts from the beginning
  setText($("no-picture-why"), "waiting for the robot's picture …");
});
// A STOP that nobody has answered yet is shown for as long.
link.addEventListener("stopwish", ({ detail: wished }) => {
  $("stop").classList.toggle("wished", wished);
  setText($("stop"), wished ? "STOP …" : "STOP");
});
link.addEventListener("closed", () => {
  setText($("no-picture-why"), "no link to this page's server; trying again …");
  page = { ...page, seat: "elsewhere" };
});
link.addEventListener("stopped", ({ detail }) => heed(detail));
link.addEventListener("freshness", freshness);

link.addEventListener("state", ({ detail: state }) => {
  world.see(state);
  requestAnimationFrame(show);
});

let shown = null;

function show() {
  const state = link.state;
  if (!state || !hello || shown === state) return;
  shown = state;
  setText($("phase"), `phase ${state.phase}`);
  setText($("phase-name"), organising.phaseNames[state.phase - 1] ?? "");
  setText($("clock"), clock(state.clock_s));
  setText($("session"), state.session ?? "no session");
  setText($("lesson-count"), String(state.lessons));
  $("go").disabled = !state.stands.needs_go || state.by_hand || !inCharge();
  showLink(state);
  showProgress(state, simulation.measure);
  why.show(state, hello);
  announce(state);
  pad.show(state);
  ways.show(state);
  goals.show(state);
  critic.show(state, lessons.newestOf(CRITIC));
  warn(state);
  health.show(state);
  if (state.refused && drive.held) say("refused", state.refused);
  organising.show(state, inCharge());
  claim();
  draw();
}

let announced = "";

// The question alone is said by a screen reader without being asked, once for each time that the robot begins to ask.
function announce(state) {
  const { asks: does, needs_go: waits, reason } = state.stands;
  const asks = does && !waits ? `${reason} ${state.behaviour}` : "";
  if (asks === announced) return;
  announced = asks;
  setText($("announce"), asks ? $("sentence").textContent : "");
}

function draw() {
  drawRobot($("robot-view"), hello, link.state);
  world.draw();
}

function showLink(state) {
  const { age_ms: age, rtt_ms: rtt, pictures_per_s: rate } = state.link;
  const both = rtt === null ? null : rtt + (link.pageRttMs ?? 0);
  const parts = [`${Math.round(rate ?? 0)}/s`, both === null ? "" : `${both.toFixed(0)} ms`, age > 150 ? `${age} ms old` : ""];
  setText($("link-text"), parts.filter(Boolean).join(" · "));
  $("link").title = `pictures a second, round trip to the robot (${rtt?.toFixed(1) ?? "–"} ms) and to this page's server`;
}

function freshness() {
  const lost = !link.fresh;
  document.body.classList.toggle("no-picture", lost);
  for (const id of IN_CHARGE) $(id).inert = lost || !inCharge();
  if (lost) {
    drive.release();
    setText($("link-text"), "no picture");
    $("go").disabled = true;
  }
}

function warn(state) {
  setText($("guard"), state.guard.length ? `guard: ${state.guard.join(", ")}` : "");
  const lines = state.trouble ? [state.trouble] : [];
  lines.push(...health.urgent(state));
  if (state.unsaved) lines.push(`${state.unsaved} not saved yet`);
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

// ---- Who is in charge

function inCharge() {
  return page.seat === "here" && link.state?.teacher === page.device;
}

function claim() {
  const state = link.state;
  const box = $("claim");
  box.hidden = inCharge() || !state;
  for (const id of IN_CHARGE) $(id).inert = !inCharge() || !link.fresh;
  if (box.hidden) return;
  drive.release();
  const another = state.teacher && state.teacher !== page.device;
  const text =
    another ? `${state.teacher} is the teacher. This page watches; it can stop the robot.`
    : page.seat === "elsewhere" ? "Another page has the pad. This one watches; it can stop the robot."
    : page.seat === "free" ? "No page has the pad. This one watches; it can stop the robot."
    : "Nobody teaches the robot.";
  setText($("claim-text"), text);
  setText($("claim-button"), another ? `Take over from ${state.teacher}` : page.seat === "here" ? "Take the robot" : "Take the pad here");
}

const take = () => tell("take", {}, "take");
$("claim-button").addEventListener("click", take);
$("take-here").addEventListener("click", take);

// ---- Touch

$("stop").addEventListener("pointerdown", (event) => {
  // At the first touch, not when the finger is lifted.
  event.preventDefault();
  stop();
});
$("stop").addEventListener("click", (event) => {
  if (event.detail === 0) stop(); // from a keyboard or a screen reader: no touch came before it
});
$("go").addEventListener("click", go);
$("praise").addEventListener("click", () => signal(1));
$("blame").addEventListener("click", () => signal(-1));
twice($("undo-last"), "sure?", undoLast, askUndo);

stick($("stick"), $("knob"), drive);
drive.addEventListener("change", ({ detail }) => {
  const [left, right] = detail.speeds;
  setText($("speeds"), detail.held ? `left ${left.toFixed(2)}, right ${right.toFixed(2)} m/s` : "hold the circle; let go to stop");
});

for (const button of $("pace").querySelectorAll("button")) {
  button.addEventListener("click", () => {
    for (const each of $("pace").querySelectorAll("button")) each.setAttribute("aria-pressed", String(each === button));
    pace();
  });
}

function pace() {
  const share = Number($("pace").querySelector("[aria-pressed=true]").dataset.share);
  drive.most = share * Math.min(FASTEST_BY_HAND_M_S, hello?.max_m_s ?? FASTEST_BY_HAND_M_S);
}

function showTab(name) {
  drive.release();
  for (const each of TABS) {
    $(each).hidden = each !== name;
    $(`tab-${each}`).setAttribute("aria-selected", String(each === name));
  }
}
TABS.forEach((name) => {
  $(`tab-${name}`).addEventListener("click", (event) => {
    showTab(name);
    if (event.detail > 0) event.currentTarget.blur(); // clicked: the arrow keys are for the wheels
  });
  $(`tab-${name}`).addEventListener("keydown", (event) => {
    if (name === "drive") return; // there they steer
    const step = { ArrowRight: 1, ArrowLeft: -1 }[event.key];
    if (!step) return;
    event.stopPropagation();
    const tabs = TABS.filter((each) => !$(`tab-${each}`).hidden);
    const next = tabs[(tabs.indexOf(name) + step + tabs.length) % tabs.length];
    showTab(next);
    $(`tab-${next}`).focus();
  });
});

function showView(name) {
  for (const each of ["robot", "world"]) $(`${each}-view`).hidden = each !== name;
  setText($("view"), name === "robot" ? "World" : "Robot");
  draw();
}
$("view").addEventListener("click", () => showView($("robot-view").hidden ? "robot" : "world"));
new ResizeObserver(draw).observe($("stage"));
onTheme(draw);
new Bubbles();

// Not modal: STOP and GO stay free.
const help = () => ($("keys").open ? $("keys").close() : $("keys").show());
$("show-keys").addEventListener("click", help);
$("close-keys").addEventListener("click", () => $("keys").close());

keyboard({
  drive,
  stop,
  go: () => !$("go").disabled && go(),
  act: (i) => {
    if (!inCharge()) return;
    if (ways.level === MID) ways.names[i] && ways.choose(ways.names[i]);
    else if (pad.names[i]) teach(pad.names[i]);
  },
  signal: (value) => inCharge() && signal(value),
  undo: () => inCharge() && $("undo-last").checkVisibility() && $("undo-last").click(),
  why: () => explanation.toggle(),
  help,
  mayDrive: () => inCharge() && link.fresh,
});
gamepad({ drive, mayDrive: () => inCharge() && link.fresh, say });

// ---- The screen stays on where the browser allows it.

async function stayAwake() {
  if (document.visibilityState !== "visible" || !navigator.wakeLock) return;
  try {
    await navigator.wakeLock.request("screen");
  } catch {
    // Refused, by a low battery for one: the screen's own time-out then ends presence, and the robot stands.
  }
}
document.addEventListener("visibilitychange", stayAwake);
stayAwake();

link.start();
