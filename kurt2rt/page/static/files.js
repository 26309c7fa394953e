// Copies of the knowledge: the robot makes one, and the browser downloads it.

const $ = (id) => document.getElementById(id);

function size(bytes) {
  return bytes < 1e6 ? `${Math.max(1, Math.round(bytes / 1000))} kB` : `${(bytes / 1e6).toFixed(1)} MB`;
}

export class Files {
  #tell;

  // `tell` gives an order and resolves with its answer.
  constructor(tell) {
    this.#tell = tell;
    $("save").addEventListener("click", () => this.#keep("save", { label: $("save-label").value.trim() }));
    $("export").addEventListener("click", () => this.#keep("export", {}));
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
