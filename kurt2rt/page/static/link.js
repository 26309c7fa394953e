// The WebSocket to the page's server: heartbeats out, pictures in, and whether there is a picture at all.

const BEAT_MS = 100;
const NO_PICTURE_MS = 500;
const NO_WORD_MS = 2000;
const RECONNECT_MS = 500;
const STOP_KEEPS_MS = 5000;

export class Link extends EventTarget {
  #socket = null;
  #heardMs = 0;
  #pictureMs = -Infinity;
  #wasFresh = false;
  #number = 0;
  #waiting = new Map();
  #stopWantedMs = -Infinity;
  #left = false;
  picture = null; // number of the picture on the screen
  state = null;
  pageRttMs = null;

  start() {
    this.#connect();
    setInterval(() => this.#beat(), BEAT_MS);
    document.addEventListener("visibilitychange", () => {
      if (document.visibilityState === "hidden") this.#send({ kind: "hidden" });
      else this.#beat();
    });
    addEventListener("freeze", () => this.#send({ kind: "hidden" }));
    // A page that is left may be kept for the way back: its link is not.
    addEventListener("pagehide", () => {
      this.#left = true;
      this.#send({ kind: "hidden" });
      this.#socket.close();
    });
    addEventListener("pageshow", (event) => {
      if (!event.persisted) return;
      this.#left = false;
      this.#connect();
    });
  }

  get open() {
    return this.#socket?.readyState === WebSocket.OPEN;
  }

  get pictureAgeMs() {
    return performance.now() - this.#pictureMs;
  }

  // Whether what the page shows is what the robot does. While it is not, nothing but a stop is sent.
  get fresh() {
    return this.open && this.pictureAgeMs < NO_PICTURE_MS;
  }

  // An order to the robot; resolves with its answer, or with a refusal when there is none.
  order(name, args = {}) {
    if (!this.fresh) return Promise.resolve({ accepted: false, why: "no picture", text: "no picture: nothing was sent" });
    return this.#ask({ kind: "order", name, arguments: args, picture: this.picture });
  }

  press(hold, left, right) {
    if (!this.fresh) return false;
    this.#send({ kind: "press", hold, left_m_s: left, right_m_s: right, picture: this.picture });
    return true;
  }

  release() {
    this.#send({ kind: "release" });
  }

  // Stop goes out with or without a picture, and again when the link comes back in time.
  stop() {
    this.#stopWantedMs = performance.now();
    if (!this.open) {
      return Promise.resolve({ accepted: false, why: "no link", text: "no link: the robot stops by itself without one" });
    }
    return this.#ask({ kind: "stop" }).then((answer) => {
      if (answer.accepted) this.#stopWantedMs = -Infinity;
      return answer;
    });
  }

  #ask(message) {
    const number = ++this.#number;
    this.#send({ ...message, number });
    return new Promise((resolve) => this.#waiting.set(number, resolve));
  }

  #send(message) {
    if (this.open) this.#socket.send(JSON.stringify(message));
  }

  #beat() {
    const now = performance.now();
    if (document.visibilityState === "visible") {
      this.#send({ kind: "beat", picture: this.picture, at_ms: Math.round(now * 10) / 10 });
    }
    if (this.open && now - this.#heardMs > NO_WORD_MS) this.#socket.close();
    if (this.fresh !== this.#wasFresh) {
      this.#wasFresh = this.fresh;
      this.dispatchEvent(new Event("freshness"));
    }
  }

  #connect() {
    const socket = new WebSocket(`ws://${location.host}/robot`);
    this.#socket = socket;
    this.#heardMs = performance.now();
    socket.onopen = () => {
      this.#heardMs = performance.now();
      this.picture = null;
      this.#beat();
      if (performance.now() - this.#stopWantedMs < STOP_KEEPS_MS) this.stop();
      this.dispatchEvent(new Event("open"));
    };
    socket.onmessage = (event) => this.#hear(JSON.parse(event.data));
    socket.onclose = () => {
      for (const resolve of this.#waiting.values()) {
        resolve({ accepted: false, why: "unknown", text: "the link broke: not known whether it counted; look at the lessons" });
      }
      this.#waiting.clear();
      this.dispatchEvent(new Event("closed"));
      if (!this.#left) setTimeout(() => this.#again(), RECONNECT_MS);
    };
  }

  // A pairing that was renewed or revoked closes the door; the server's page then says what to do.
  async #again() {
    if (this.#left || this.open) return;
    try {
      const response = await fetch("/", { method: "HEAD", cache: "no-store" });
      if (response.status === 403) {
        location.reload();
        return;
      }
    } catch {
      // The server is not there: the WebSocket tries again below.
    }
    this.#connect();
  }

  #hear(message) {
    this.#heardMs = performance.now();
    if (message.kind === "state") {
      this.#pictureMs = this.#heardMs;
      this.picture = message.picture;
      this.state = message;
      if (message.echo) this.pageRttMs = this.#heardMs - message.echo[0] - message.echo[1];
    } else if (message.kind === "answer") {
      this.#waiting.get(message.number)?.(message);
      this.#waiting.delete(message.number);
    }
    this.dispatchEvent(new CustomEvent(message.kind, { detail: message }));
  }
}
