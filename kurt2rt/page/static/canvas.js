// A canvas that is as sharp as the screen, in CSS pixels.

export const INK = "#10151c";
export const PAPER = "#ffffff";
export const BLUE = "#0b4a8f";
export const RED = "#b00020";
export const GREY = "#5a6472";
export const FAINT = "#c9d0d8";

// Clears it and returns { paint, width, height }, or null while it is not shown.
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

// The robot's body in its own frame, x forward, in metres; the pen is there already.
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
