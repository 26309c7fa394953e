// Where the infra-red sensors are and what they see, by the law that the robot tells of them.

const LAW = [86.016, 0.04, 64.4, 0.1, 0.6, 76]; // of a robot that does not tell its own
const MOST_LINES = 3;

// The distance in metres that a reading stands for, from the sensor's face; the farthest where it sees nothing.
export function distance({ law }, counts) {
  const [numerator, offset, bias, near, far, nothing] = law ?? LAW;
  return counts <= nothing ? far : Math.min(far, Math.max(near, numerator / (counts + bias) - offset));
}

// The distance up to which sensors see anything.
export function farthest({ law }) {
  return (law ?? LAW)[4];
}

// The features of a question whose texts tell a difference: [name, here, there, place, its text here, and there].
// The nearest or farthest of some sensors says nothing new next to the sensor that it is.
function told(question) {
  const ofSome = ([name]) => /^(maximum|minimum) /.test(name);
  const again = (line) => ofSome(line) && question.some((other) => !ofSome(other) && other[4] === line[4]);
  return question.filter((line) => line[4] !== line[5] && !again(line)).slice(0, MOST_LINES);
}

// Sensors that make the difference while the robot asks, by name, with what they read; empty while it does not ask.
export function differing(state, hello) {
  const names = new Set(hello.sensors.map(([name]) => name));
  const asks = state.cause === "unknown" ? told(state.question) : [];
  return new Map(asks.filter(([name]) => names.has(name)).map(([name, , , , here]) => [name, here.replace(/ within.*| or less/, "")]));
}

// "front left: 13 cm, was 40 cm", a line for each feature.
export function differenceList(question) {
  const list = document.createElement("ul");
  list.append(
    ...told(question).map(([, , , place, here, there]) => {
      const line = document.createElement("li");
      const where = document.createElement("b");
      where.textContent = place;
      line.append(where, `: ${here}, was ${there}`);
      return line;
    }),
  );
  return list;
}
