// Copies of the knowledge: the robot writes one, and the browser downloads it.

import { text } from "./texts.js";

const $ = (id) => document.getElementById(id);

function size(bytes) {
  return bytes < 1e6 ? `${Math.max(1, Math.round(bytes / 1000))} kB` : `${(bytes / 1e6).toFixed(1)} MB`;
}

export class Files {
  #sendCommand;
  #showMessage;

  // `sendCommand` resolves with the answer; `showMessage` shows an outcome and a sentence.
  constructor(sendCommand, showMessage) {
    this.#sendCommand = sendCommand;
    this.#showMessage = showMessage;
    $("load").addEventListener("click", () => $("load-file").click());
    $("load-file").addEventListener("change", () => this.#load());
    $("save").addEventListener("click", () => this.#save("/save", { label: $("save-label").value.trim() }));
    $("export").addEventListener("click", () => this.#save("/export", { form: "package" }));
  }

  // Only a simulated robot loads knowledge: a real one would leave its bus meanwhile.
  build(hello) {
    $("load").hidden = !hello.simulated;
  }

  async #load() {
    const [file] = $("load-file").files;
    $("load-file").value = ""; // the same file may be chosen again
    if (!file) return;
    $("load").disabled = true;
    this.#showMessage("pending", text("uploading", { name: file.name }));
    try {
      const response = await fetch("/upload", { method: "POST", body: file });
      if (response.ok) await this.#sendCommand("/load", await response.json(), `load ${file.name}`);
      else this.#showMessage("refused", `${file.name}: ${await response.text()}`);
    } catch {
      this.#showMessage("refused", text("uploadBroke", { name: file.name }));
    } finally {
      $("load").disabled = false;
    }
  }

  async #save(path, fields) {
    const answer = await this.#sendCommand(path, fields);
    if (!answer.accepted || !answer.extra.name) return;
    const { name: file, size: bytes } = answer.extra;
    const link = document.createElement("a");
    link.href = `/files/${encodeURIComponent(file)}`;
    link.download = file;
    link.textContent = file;
    const room = bytes ? ` (${size(bytes)})` : "";
    // The link stays for another tap, if the browser asks first or the download broke off.
    $("saved").replaceChildren("Downloaded: ", link, `${room}; a copy is on the robot.`);
    link.click();
  }
}
