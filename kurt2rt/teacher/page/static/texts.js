// The page's own sentences; texts of the robot's codes come from its server.

const TEXTS = {
  commandWithoutPicture: "no picture of the robot: nothing was sent",
  whyWithoutPicture: "no picture of the robot: nothing was asked",
  linkBroke: "the link broke: it is not known whether the command was carried out; look at the lessons",
  stopUnanswered: "STOP has no answer yet; it is sent again until the robot answers",
  stopWithoutLink: "no link: STOP is sent as soon as the link is back; {meanwhile}",
  autonomousMeanwhile: "in phase 5 the robot drives on until then",
  supervisedMeanwhile: "without its teacher the robot stops by itself",
  awaitPicture: "{action} was not sent: wait for the picture after the last answer",
  questionChanged: "{action} was not sent: the question has just changed, look again",
  undoAgain: "undo {lesson}? touch again",
  undoEarlier: "your last touch taught nothing; undo the lesson before it, {lesson}? touch again",
  nothingToUndo: "the list has no lesson to undo; nothing was sent",
  driveEnded: "the drive was ended; press again",
  awaitRobot: "waiting for the robot's picture …",
  awaitServer: "no link to this page's server; trying again …",
  otherTeacher: "{teacher} is the teacher. This page only watches; it can stop the robot.",
  controlElsewhere: "Another page has control. This page only watches; it can stop the robot.",
  controlFree: "No page has control. This page only watches; it can stop the robot.",
  noTeacher: "The robot has no teacher.",
  takeOver: "Take over from {teacher}",
  takeRobot: "Take the robot",
  takeControl: "Take control",
  rewound: "{seconds} s before it stood: {sentence}. Touch the action that was right there.",
  standAgain: "Touch stand once more to teach it: by this rule the robot stays there until a teacher drives it on.",
  holding: "{action} is held, lessons: {lessons}",
  held: "{action} was held, lessons: {lessons}",
  holdEnded: "the hold was ended; press again",
  holdCircle: "hold the circle; let go to stop",
  gamepadUnknown: "gamepad: its buttons are not known; use another one",
  gamepadReady: "gamepad: hold a shoulder button, then the left stick drives; hold the cross, X or B to correct",
  uploading: "{name} is being uploaded …",
  uploadBroke: "{name}: the upload broke off; choose the file again",
  bubbleWhy: "Here you read what the robot does and why. When it asks, this turns yellow.",
  bubblePanel: "Take the robot, then touch the right action: each touch is a lesson and acts at once.",
  bubbleStop: "STOP stops the robot, from every device. GO lets it drive on.",
  phase1: "In an unknown situation it stops and asks; your answer becomes a rule.",
  phase2: "It drives by its rules, and you also correct it while it drives.",
  phase3: "Right and wrong change the values of its rules; a rule with too low a value is asked for again.",
  phase4: "Right and wrong teach its critic to judge by itself.",
  phase5: "It drives without a teacher and never asks; a trusted critic repairs its rules.",
};

// The sentence of a key, with the values of its fields.
export function text(key, fields = {}) {
  return TEXTS[key].replace(/\{(\w+)\}/g, (_, name) => fields[name]);
}
