// Canvas with the screen's resolution, in CSS pixels and in the colours of the page's theme.

const LIGHT = {
  ink: "#10151c", paper: "#ffffff", blue: "#0b4a8f", red: "#b00020", grey: "#5a6472", faint: "#c9d0d8",
  pale: "#dbe8f5", shade: "#edf0f4", trail: "#3e7cb1", far: "#3e7cb1", near: "#b00020", differs: "#d9480f",
};
const DARK = {
  ink: "#eef2f6", paper: "#10151c", blue: "#8fc1ff", red: "#ff8a8f", grey: "#a9b3bf", faint: "#3a444f",
  pale: "#1d3a5c", shade: "#232b35", trail: "#6fb0e8", far: "#4f8fc6", near: "#ff6b72", differs: "#ff9a5c",
};

// Colours of the present theme.
export let INK, PAPER, BLUE, RED, GREY, FAINT, PALE, SHADE, TRAIL, FAR, NEAR, DIFFERS;

function paintIn(theme) {
  INK = theme.ink;
  PAPER = theme.paper;
  BLUE = theme.blue;
  RED = theme.red;
  GREY = theme.grey;
  FAINT = theme.faint;
  PALE = theme.pale;
  SHADE = theme.shade;
  TRAIL = theme.trail;
  FAR = theme.far;
  NEAR = theme.near;
  DIFFERS = theme.differs;
}

const dark = matchMedia("(prefers-color-scheme: dark)");
paintIn(dark.matches ? DARK : LIGHT);

// Calls `draw` after the browser has changed between light and dark.
export function onTheme(draw) {
  dark.addEventListener("change", () => {
    paintIn(dark.matches ? DARK : LIGHT);
    draw();
  });
}

// Returns the colour between two of the form #rrggbb; `share` 0 is the first, 1 the second.
export function between(one, other, share) {
  const part = (text, i) => parseInt(text.slice(1 + 2 * i, 3 + 2 * i), 16);
  return `rgb(${[0, 1, 2].map((i) => Math.round(part(one, i) + (part(other, i) - part(one, i)) * share)).join(" ")})`;
}

// Clears a canvas and returns { paint, width, height }, or null while it is hidden.
export function sheet(canvas) {
  const width = canvas.clientWidth;
  const height = canvas.clientHeight;
  if (!width || !height) return null;
  const ratio = Math.min(devicePixelRatio || 1, 3);
  if (canvas.width !== Math.round(width * ratio) || canvas.height !== Math.round(height * ratio)) {
    canvas.width = Math.round(width * ratio);
    canvas.height = Math.round(height * ratio);
  }
  const paint = canvas.getContext("2d");
  paint.setTransform(ratio, 0, 0, ratio, 0, 0);
  paint.clearRect(0, 0, width, height);
  paint.lineCap = "round";
  paint.lineJoin = "round";
  return { paint, width, height };
}

// Draws the robot's body in its own frame, x forward, in metres.
export function body(paint, length, width, { fill, line, lineWidth }) {
  paint.beginPath();
  paint.roundRect(-length / 2, -width / 2, length, width, 0.03);
  paint.fillStyle = fill;
  paint.fill();
  paint.lineWidth = lineWidth;
  paint.strokeStyle = line;
  paint.stroke();
  paint.beginPath();
  paint.moveTo(length * 0.34, 0);
  paint.lineTo(length * 0.06, width * 0.2);
  paint.lineTo(length * 0.06, -width * 0.2);
  paint.closePath();
  paint.fillStyle = line;
  paint.fill();
}
