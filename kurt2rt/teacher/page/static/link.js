// The WebSocket to the page's server: heartbeats out, pictures in, and whether there is a picture at all.

const BEAT_MS = 100;
const NO_PICTURE_MS = 500;
const NO_WORD_MS = 2000;
const RECONNECT_MS = 500;
const CONNECT_MS = 3000;
const STOP_AGAIN_MS = 500;
const AUTONOMOUS = 5;

export class Link extends EventTarget {
  #socket = null;
  #heardMs = 0;
  #pictureMs = -Infinity;
  #wasFresh = false;
  #number = 0;
  #waiting = new Map();
  #stopWished = false;
  #stopAsked = false;
  #stopAskedMs = -Infinity;
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
      this.#drop();
    });
    addEventListener("pageshow", (event) => {
      if (!event.persisted) return;
      this.#left = false;
      if (!this.#alive) this.#connect();
    });
  }

  get open() {
    return this.#socket?.readyState === WebSocket.OPEN;
  }

  // Open, or on its way to be.
  get #alive() {
    return this.open || this.#socket?.readyState === WebSocket.CONNECTING;
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
    if (name === "resume") this.#wishStop(false);
    return this.#ask({ kind: "order", name, arguments: args, picture: this.picture });
  }

  // What the robot's newest decision rests on; anybody who sees the page may ask.
  why() {
    if (!this.fresh) return Promise.resolve({ accepted: false, text: "no picture: nothing was asked" });
    return this.#ask({ kind: "why" });
  }

  press(hold, left, right) {
    if (!this.fresh) return false;
    this.#send({ kind: "press", hold, left_m_s: left, right_m_s: right, picture: this.picture });
    return true;
  }

  release() {
    this.#send({ kind: "release" });
  }

  // Stop goes out with or without a picture. It stays wished, also over a link that breaks, until the robot has
  // answered it or GO is said.
  async stop() {
    this.#wishStop(true);
    if (this.open) {
      const answer = await this.#askStop();
      return this.#stopWished ? { ...answer, text: "STOP is not answered yet; it is sent again until it is" } : answer;
    }
    const meanwhile = this.state?.phase === AUTONOMOUS ? "in phase 5 the robot drives on until then" : "without its teacher the robot stops by itself";
    return { accepted: false, why: "no link", text: `no link: STOP goes out as soon as it is back; ${meanwhile}` };
  }

  async #askStop() {
    this.#stopAsked = true;
    this.#stopAskedMs = performance.now();
    const answer = await this.#ask({ kind: "stop" });
    this.#stopAsked = false;
    if (answer.accepted && this.#stopWished) this.#wishStop(false);
    return answer;
  }

  #wishStop(wished) {
    if (this.#stopWished === wished) return;
    this.#stopWished = wished;
    this.dispatchEvent(new CustomEvent("stopwish", { detail: wished }));
  }

  #stopAgain() {
    if (!this.#stopWished || this.#stopAsked || !this.open) return;
    if (performance.now() - this.#stopAskedMs < STOP_AGAIN_MS) return;
    this.#askStop().then((answer) => {
      if (answer.accepted) this.dispatchEvent(new CustomEvent("stopped", { detail: answer }));
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
    if (this.open && now - this.#heardMs > NO_WORD_MS) this.#drop();
    this.#stopAgain();
    this.#tellFreshness();
  }

  // Also at once with each picture and with the end of the link: a link that lives shorter than a beat must not leave
  // a picture behind that looks alive.
  #tellFreshness() {
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
    // A network that swallows everything answers an attempt only after minutes.
    setTimeout(() => this.#socket === socket && socket.readyState === WebSocket.CONNECTING && this.#drop(), CONNECT_MS);
    // What comes of a socket that was given up is nothing to us.
    socket.onopen = () => {
      if (this.#socket !== socket) return;
      this.#heardMs = performance.now();
      this.picture = null;
      this.#beat();
      this.dispatchEvent(new Event("open"));
    };
    socket.onmessage = (event) => {
      if (this.#socket === socket) this.#hear(JSON.parse(event.data));
    };
    socket.onclose = () => {
      if (this.#socket === socket) this.#drop();
    };
  }

  // The link is lost, or given up: a socket takes its time to close, and nobody waits for that.
  #drop() {
    const socket = this.#socket;
    this.#socket = null;
    socket?.close();
    for (const resolve of this.#waiting.values()) {
      resolve({ accepted: false, why: "unknown", text: "the link broke: not known whether it counted; look at the lessons" });
    }
    this.#waiting.clear();
    this.#stopAsked = false;
    this.#stopAskedMs = -Infinity;
    this.dispatchEvent(new Event("closed"));
    this.#tellFreshness();
    if (!this.#left) setTimeout(() => this.#again(), RECONNECT_MS);
  }

  // A pairing that was renewed or revoked closes the door; the server's page then says what to do.
  async #again() {
    if (this.#left || this.#alive) return;
    try {
      const response = await fetch("/", { method: "HEAD", cache: "no-store", signal: AbortSignal.timeout(CONNECT_MS) });
      if (response.status === 403) {
        location.reload();
        return;
      }
    } catch {
      // The server is not there: the WebSocket tries again below.
    }
    if (!this.#left && !this.#alive) this.#connect();
  }

  #hear(message) {
    this.#heardMs = performance.now();
    if (message.kind === "state") {
      this.#pictureMs = this.#heardMs;
      this.picture = message.picture;
      this.state = message;
      this.#tellFreshness();
      if (message.echo) this.pageRttMs = this.#heardMs - message.echo[0] - message.echo[1];
    } else if (message.kind === "answer") {
      this.#waiting.get(message.number)?.(message);
      this.#waiting.delete(message.number);
    }
    this.dispatchEvent(new CustomEvent(message.kind, { detail: message }));
  }
}
