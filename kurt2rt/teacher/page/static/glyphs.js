// Arrows of known actions; other actions have a name only.

const SVG = "http://www.w3.org/2000/svg";

const LEFT = {
  bear_left: ["M15 21C15 14 13 9 8.5 5", "M7.5 11 8 4.5 14.5 4.5"],
  curve_left: ["M18 21C18 13 14 9 6 9", "M11 4 6 9 11 14"],
  spin_left: ["M19 13A7.2 7.2 0 1 0 13.6 19.6", "M9.8 16.6 13.8 19.6 10.9 23"],
  quarter_turn_left: ["M17 21V11Q17 9 15 9H6", "M11 4 6 9 11 14"],
  along_left_wall: ["M15 21V4", "M9.5 9.5 15 4 20.5 9.5", "M4 2V22"],
};

// Symbols and behaviours of junctions, by the action of the same arrow.
const SAME_AS = {
  straight: "forward", straight_on: "forward", left: "quarter_turn_left", turn_left: "quarter_turn_left",
  right: "quarter_turn_right", turn_right: "quarter_turn_right",
};

const PATHS = {
  forward: ["M12 21V4", "M6 10 12 4 18 10"],
  back: ["M12 3V20", "M6 14 12 20 18 14"],
  stand: ["M8.5 5V19", "M15.5 5V19"],
  ...LEFT,
};

// Returns an <svg>, or null for an action without a picture.
export function glyph(name) {
  const action = SAME_AS[name] ?? name;
  const mirrored = action.replace("right", "left");
  const flip = mirrored !== action && mirrored in LEFT;
  const paths = PATHS[flip ? mirrored : action];
  if (!paths) return null;
  const svg = document.createElementNS(SVG, "svg");
  svg.setAttribute("viewBox", "0 0 24 24");
  svg.setAttribute("aria-hidden", "true");
  const group = document.createElementNS(SVG, "g");
  if (flip) group.setAttribute("transform", "translate(24 0) scale(-1 1)");
  for (const each of paths) {
    const path = document.createElementNS(SVG, "path");
    path.setAttribute("d", each);
    group.append(path);
  }
  svg.append(group);
  return svg;
}
