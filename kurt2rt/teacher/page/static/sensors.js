// Infra-red sensors: distances by the law of the robot's introduction, and differing features.

const LAW = [86.016, 0.04, 64.4, 0.1, 0.6, 76]; // for a robot without a law
const MOST_LINES = 3;

// Returns the distance of a reading in metres, from the sensor's face; the farthest if it sees nothing.
function distance({ law }, counts) {
  const [numerator, offset, bias, near, far, nothing] = law ?? LAW;
  return counts <= nothing ? far : Math.min(far, Math.max(near, numerator / (counts + bias) - offset));
}

// Returns the range of the sensors in metres.
export function farthest({ law }) {
  return (law ?? LAW)[4];
}

// Returns what each sensor sees, in the robot's frame: a ray from x, y in the direction `angle`, `metres` long, to `end`.
export function rays(hello, state) {
  return hello.sensors.map(([name, , x, y, heading], i) => {
    const metres = distance(hello, state.infrared[i] ?? 0);
    const angle = (heading * Math.PI) / 180;
    const end = [x + metres * Math.cos(angle), y + metres * Math.sin(angle)];
    return { name, x, y, angle, metres, end, nothing: metres >= farthest(hello) };
  });
}

// Returns the features of a question with different texts: [name, here, there, place, text here, text there].
// A minimum or maximum is left out if its sensor is listed.
function visible(question) {
  const ofSome = ([name]) => /^(maximum|minimum) /.test(name);
  const again = (line) => ofSome(line) && question.some((other) => !ofSome(other) && other[4] === line[4]);
  return question.filter((line) => line[4] !== line[5] && !again(line)).slice(0, MOST_LINES);
}

// Returns the names of the differing sensors while the robot asks.
export function differing(state, hello) {
  const names = new Set(hello.sensors.map(([name]) => name));
  const asks = ["unknown", "doubt"].includes(state.cause) ? visible(state.question) : [];
  return new Set(asks.map(([name]) => name).filter((name) => names.has(name)));
}

// Returns a list with a line for each feature, such as "front left: 13 cm, was 40 cm".
export function differenceList(question) {
  const list = document.createElement("ul");
  list.append(
    ...visible(question).map(([, , , place, here, there]) => {
      const line = document.createElement("li");
      const where = document.createElement("b");
      where.textContent = place;
      line.append(where, `: ${here}, was ${there}`.replaceAll(/ within [^,]*/g, ""));
      return line;
    }),
  );
  return list;
}
