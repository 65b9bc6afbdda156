import { cameraGroups, missing, namesInSample, resultNotes } from "/static/js/shared/readingLogic.js";
import { compact, duration, length, moment, number, powerOfTen } from "/static/js/shared/formatLogic.js";
import {
  faultBeforeUpload, frameNote, frameOfAnswer, kindOfFile, newFrame, nextWaiting, requeued, tally,
  withFrame,
} from "/static/js/shared/queueLogic.js";
import { contains, equal } from "./check.js";

const answer = (status) => ({
  result: { status, source: "a.jpg", position_mm: [0, 0, 512], layer: "blue", stage: "lines", reason: "too_few_lines" },
  image: { width: 1360, height: 765 },
  camera_scale: 0.5,
  trace: null,
});
const frames = () => ["a.jpg", "b.jpg", "c.jpg"].map((name) => newFrame(new File(["x"], name)));

export const tests = {
  "the selected picture is read first, then in order": () => {
    const list = frames();
    equal(nextWaiting(list, list[2].id).name, "c.jpg");
    equal(nextWaiting(withFrame(list, list[0].id, { status: "ok" }), null).name, "b.jpg");
    equal(nextWaiting([], null), null);
  },
  "under new terms all files wait again, results without a file go": () => {
    const done = frames().map((frame) => ({ ...frame, status: "failed", message: "x" }));
    const again = requeued([frameOfAnswer(answer("ok")), ...done]);
    equal(again.map((frame) => [frame.status, frame.message]), Array(3).fill(["waiting", ""]));
  },
  "a frame says in a few words what became of it": () => {
    equal(frameNote(frameOfAnswer(answer("ok"))), "512 mm, blue");
    equal(frameNote(frameOfAnswer(answer("failed"))), "Lines: too few lines");
    equal(frameNote(newFrame(new File([], "x"), "The file is empty.")), "not readable");
  },
  "the tally leaves out what is not there": () => {
    equal(tally([frameOfAnswer(answer("ok")), ...frames()]), "1 with a pose, 3 to read");
    equal(tally([]), "");
  },
  "a file is known by its name and beginning": () => {
    const kinds = [["x.YAML", ""], ["x.json", '{"format": "padstudio.pad"'], ["x.json", "{}"], ["x.jpg", ""]];
    equal(kinds.map(([name, head]) => kindOfFile(name, head)), ["camera", "pad", "camera", "image"]);
  },
  "pictures that show range and bearing alone are counted apart": () => {
    const far = frameOfAnswer({ ...answer("ok"), result: { ...answer("ok").result, quality: "bearing", range_mm: 16_200 } });
    equal(tally([far, frameOfAnswer(answer("ok")), frameOfAnswer(answer("failed"))]),
      "1 with a pose, 1 with range and bearing only, 1 without");
    equal(frameNote(far), "16.20 m away, bearing only");
  },
  "what need not be sent": () => {
    contains(faultBeforeUpload({ size: 0 }, 9e6), "empty");
    contains(faultBeforeUpload({ size: 12e6 }, 9e6), "12 MB; the limit is 9 MB");
    equal(faultBeforeUpload({ size: 9e6 }, 9e6), "");
  },
  "what is still missing": () => {
    equal(missing({ pad: "", camera: "", frames: [] }), "Choose a pad, a camera and a picture.");
    equal(missing({ pad: "p", camera: "", frames: frames() }), "Choose a camera.");
    equal(missing({ pad: "p", camera: "c", frames: frames() }), "");
  },
  "notes on a scaled and a nominal camera": () => {
    const notes = resultNotes(frameOfAnswer(answer("ok")), { nominal: true });
    contains(notes[0], "scaled by 0.5");
    contains(notes[1], "nominal");
    equal(resultNotes(null, undefined), []);
  },
  "calibrated cameras stand before nominal ones": () => {
    const camera = (id, nominal) => ({ id, name: id, width: 4, height: 3, nominal });
    const groups = cameraGroups([camera("own", false)], [camera("preset", true)]);
    equal(groups.map((group) => group.options[0].text), ["own, 4 × 3", "preset, 4 × 3"]);
  },
  "the sample's names": () => {
    equal(namesInSample('{"name": "A"}', "image_width: 3\ncamera_name: cam one\nx: 1\n"), { pad: "A", camera: "cam one" });
    equal(namesInSample('{"name": "A"}', "x: 1\n").camera, "");
  },
  "figures as people read them": () => {
    equal([number(14641), number(1234), number(-0.04, 1), number(-1.25, 1)], ["14\u202f641", "1234", "0.0", "−1.3"]);
    equal([compact(10), compact(2.5), compact(0.125, 2)], ["10", "2.5", "0.13"]);
    equal([length(2400), length(512.4), length(-65.43)], ["2.40 m", "512 mm", "−65.4 mm"]);
    equal([duration(0), duration(2.34), duration(72.4), duration(1234), duration(61000)],
      ["< 0.1 ms", "2.3 ms", "72 ms", "1.23 s", "61.0 s"]);
    equal([powerOfTen(-7), powerOfTen(12)], ["10⁻⁷", "10¹²"]);
    equal(moment("not a date"), "");
  },
};
