// Copies of the knowledge: the robot makes one, and the browser downloads it.

const $ = (id) => document.getElementById(id);

function size(bytes) {
  return bytes < 1e6 ? `${Math.max(1, Math.round(bytes / 1000))} kB` : `${(bytes / 1e6).toFixed(1)} MB`;
}

export class Files {
  #tell;
  #say;

  // `tell` gives an order and resolves with its answer; `say` shows what became of something.
  constructor(tell, say) {
    this.#tell = tell;
    this.#say = say;
    $("load").addEventListener("click", () => $("load-file").click());
    $("load-file").addEventListener("change", () => this.#load());
    $("save").addEventListener("click", () => this.#keep("save", { label: $("save-label").value.trim() }));
    $("export").addEventListener("click", () => this.#keep("export", {}));
  }

  // Knowledge comes back only to a simulated robot: a real one would let go of its bus meanwhile.
  build(hello) {
    $("load").hidden = !hello.simulated;
  }

  async #load() {
    const [file] = $("load-file").files;
    $("load-file").value = ""; // the same file may be chosen again
    if (!file) return;
    $("load").disabled = true;
    this.#say("pending", `${file.name} is being uploaded …`);
    try {
      const response = await fetch("/upload", { method: "POST", body: file });
      if (response.ok) await this.#tell("load", await response.json(), `load ${file.name}`);
      else this.#say("refused", `${file.name}: ${await response.text()}`);
    } catch {
      this.#say("refused", `${file.name}: the upload broke off; choose the file again`);
    } finally {
      $("load").disabled = false;
    }
  }

  async #keep(name, args) {
    const answer = await this.#tell(name, args);
    if (!answer.accepted || !answer.extra.name) return;
    const { name: file, size: bytes } = answer.extra;
    const link = document.createElement("a");
    link.href = `/files/${encodeURIComponent(file)}`;
    link.download = file;
    link.textContent = file;
    const room = bytes ? ` (${size(bytes)})` : "";
    // The link stays: a browser that asks first, or a download that broke off, is one more tap.
    $("saved").replaceChildren("Downloaded: ", link, `${room}; a copy is on the robot.`);
    link.click();
  }
}
