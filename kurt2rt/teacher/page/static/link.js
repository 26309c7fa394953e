// WebSocket to the page's server: heartbeats and commands out, states in, and the freshness of the last state.

import { text } from "./texts.js";

const HEARTBEAT_MS = 100;
const STALE_MS = 500;
const SILENT_MS = 2000;
const RECONNECT_MS = 500;
const CONNECT_MS = 3000;
const STOP_REPEAT_MS = 500;
const AUTONOMOUS = 5;

export class Link extends EventTarget {
  #socket = null;
  #heardMs = 0;
  #stateMs = -Infinity;
  #wasFresh = false;
  #number = 0;
  #pressId = 0;
  #waiting = new Map();
  #stopPending = false;
  #stopSent = false;
  #stopSentMs = -Infinity;
  #leaving = false;
  picture = null; // number of the state on the screen
  stops = 0; // number of stops from this page
  state = null;
  pageRttMs = null;

  start() {
    this.#connect();
    setInterval(() => this.#sendHeartbeat(), HEARTBEAT_MS);
    document.addEventListener("visibilitychange", () => {
      if (document.visibilityState === "hidden") this.#send({ kind: "hidden" });
      else this.#sendHeartbeat();
    });
    addEventListener("freeze", () => this.#send({ kind: "hidden" }));
    // The browser may cache a page that is left; its link is closed.
    addEventListener("pagehide", () => {
      this.#leaving = true;
      this.#send({ kind: "hidden" });
      this.#close();
    });
    addEventListener("pageshow", (event) => {
      if (!event.persisted) return;
      this.#leaving = false;
      if (!this.#alive) this.#connect();
    });
  }

  get open() {
    return this.#socket?.readyState === WebSocket.OPEN;
  }

  // True while the socket is open or opening.
  get #alive() {
    return this.open || this.#socket?.readyState === WebSocket.CONNECTING;
  }

  get stateAgeMs() {
    return performance.now() - this.#stateMs;
  }

  // True while the page shows the present state. Otherwise only a stop is sent.
  get fresh() {
    return this.open && this.stateAgeMs < STALE_MS;
  }

  // Sends a command to its path on the wire, given on the state `picture`; resolves with its answer, or with a refusal without one.
  command(path, fields = {}, picture = this.picture) {
    if (!this.fresh) return Promise.resolve({ accepted: false, why: "no picture", text: text("commandWithoutPicture") });
    if (path === "/resume") this.#setStopPending(false);
    return this.#request({ kind: "command", path, fields, picture });
  }

  // Asks for the facts of the newest decision; allowed without control.
  why() {
    if (!this.fresh) return Promise.resolve({ accepted: false, text: text("whyWithoutPicture") });
    return this.#request({ kind: "why" });
  }

  // Number of a new press; presses of speeds and of actions count in one sequence.
  nextPress() {
    return ++this.#pressId;
  }

  // Sends a message of a held action; false without a fresh state.
  hold(pressId, action) {
    if (!this.fresh) return false;
    this.#send({ kind: "hold", press_id: pressId, action, picture: this.picture });
    return true;
  }

  press(pressId, left, right) {
    if (!this.fresh) return false;
    this.#send({ kind: "press", press_id: pressId, left_m_s: left, right_m_s: right, picture: this.picture });
    return true;
  }

  release() {
    this.#send({ kind: "release" });
  }

  // Sends a stop, with or without a fresh state. It stays pending, also over a broken link, until the robot answers
  // or GO is touched.
  async stop() {
    this.stops += 1;
    this.#setStopPending(true);
    if (this.open) {
      const answer = await this.#sendStop();
      return this.#stopPending ? { ...answer, text: text("stopUnanswered") } : answer;
    }
    const meanwhile = text(this.state?.phase === AUTONOMOUS ? "autonomousMeanwhile" : "supervisedMeanwhile");
    return { accepted: false, why: "no link", text: text("stopWithoutLink", { meanwhile }) };
  }

  async #sendStop() {
    this.#stopSent = true;
    this.#stopSentMs = performance.now();
    const answer = await this.#request({ kind: "stop" });
    this.#stopSent = false;
    if (answer.accepted && this.#stopPending) this.#setStopPending(false);
    return answer;
  }

  #setStopPending(pending) {
    if (this.#stopPending === pending) return;
    this.#stopPending = pending;
    this.dispatchEvent(new CustomEvent("stoppending", { detail: pending }));
  }

  #repeatStop() {
    if (!this.#stopPending || this.#stopSent || !this.open) return;
    if (performance.now() - this.#stopSentMs < STOP_REPEAT_MS) return;
    this.#sendStop().then((answer) => {
      if (answer.accepted) this.dispatchEvent(new CustomEvent("stopped", { detail: answer }));
    });
  }

  #request(message) {
    const number = ++this.#number;
    this.#send({ ...message, number });
    return new Promise((resolve) => this.#waiting.set(number, resolve));
  }

  #send(message) {
    if (this.open) this.#socket.send(JSON.stringify(message));
  }

  #sendHeartbeat() {
    const now = performance.now();
    if (document.visibilityState === "visible") {
      this.#send({ kind: "beat", picture: this.picture, at_ms: Math.round(now * 10) / 10 });
    }
    if (this.open && now - this.#heardMs > SILENT_MS) this.#close();
    this.#repeatStop();
    this.#publishFreshness();
  }

  // Called with each heartbeat, each state and the end of the link, so that no old state looks fresh.
  #publishFreshness() {
    if (this.fresh === this.#wasFresh) return;
    this.#wasFresh = this.fresh;
    this.dispatchEvent(new Event("freshness"));
  }

  #connect() {
    const place = new URL("/robot", location.href);
    place.protocol = location.protocol.endsWith("s:") ? "wss:" : "ws:";
    const socket = new WebSocket(place);
    this.#socket = socket;
    this.#heardMs = performance.now();
    // In a network that drops all packets, an attempt ends only after minutes.
    setTimeout(() => this.#socket === socket && socket.readyState === WebSocket.CONNECTING && this.#close(), CONNECT_MS);
    // Events of a socket that was given up are ignored.
    socket.onopen = () => {
      if (this.#socket !== socket) return;
      this.#heardMs = performance.now();
      this.picture = null;
      this.#sendHeartbeat();
      this.dispatchEvent(new Event("open"));
    };
    socket.onmessage = (event) => {
      if (this.#socket === socket) this.#onMessage(JSON.parse(event.data));
    };
    socket.onclose = () => {
      if (this.#socket === socket) this.#close();
    };
  }

  // Gives up the socket without waiting until it is closed.
  #close() {
    const socket = this.#socket;
    this.#socket = null;
    socket?.close();
    for (const resolve of this.#waiting.values()) {
      resolve({ accepted: false, why: "unknown", text: text("linkBroke") });
    }
    this.#waiting.clear();
    this.#stopSent = false;
    this.#stopSentMs = -Infinity;
    this.dispatchEvent(new Event("closed"));
    this.#publishFreshness();
    if (!this.#leaving) setTimeout(() => this.#reconnect(), RECONNECT_MS);
  }

  // After the pairing was renewed or revoked, the server answers 403 with a page that says what to do.
  async #reconnect() {
    if (this.#leaving || this.#alive) return;
    try {
      const response = await fetch("/", { method: "HEAD", cache: "no-store", signal: AbortSignal.timeout(CONNECT_MS) });
      if (response.status === 403) {
        location.reload();
        return;
      }
    } catch {
      // The server does not answer: the WebSocket tries again below.
    }
    if (!this.#leaving && !this.#alive) this.#connect();
  }

  #onMessage(message) {
    this.#heardMs = performance.now();
    if (message.kind === "state") {
      this.#stateMs = this.#heardMs;
      this.picture = message.picture;
      this.state = message;
      this.#publishFreshness();
      if (message.echo) this.pageRttMs = this.#heardMs - message.echo[0] - message.echo[1];
    } else if (message.kind === "answer") {
      this.#waiting.get(message.number)?.(message);
      this.#waiting.delete(message.number);
    }
    this.dispatchEvent(new CustomEvent(message.kind, { detail: message }));
  }
}
