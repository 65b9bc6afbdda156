import {
  cameraGroups, missing, namesInSample, otherPads, othersNote, padIds, readoutFrom, readoutText, resultNotes,
} from "/static/js/shared/readingLogic.js";
import { padAmongSeveral } from "/static/js/shared/poseLogic.js";
import { compact, duration, length, moment, number, powerOfTen } from "/static/js/shared/formatLogic.js";
import {
  faultBeforeUpload, frameNote, frameOfAnswer, kindOfFile, newFrame, nextWaiting, requeued, tally, triedAgain,
  withFrame, withReading,
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
  "what is never sent stays refused under new terms": () => {
    const video = newFrame(new File(["x"], "a.mp4"), faultBeforeUpload({ name: "a.mp4", size: 1 }, 0));
    equal(requeued([video]), [video]);
    equal(nextWaiting(triedAgain([video]), video.id), null);
  },
  "pictures that the server could not answer for are tried again, those that it refused are not": () => {
    const [lost, refused, done] = frames();
    const list = [{ ...lost, status: "refused", message: "x", passing: true }, { ...refused, status: "refused", message: "y" }, { ...done, status: "ok" }];
    equal(triedAgain(list).map(({ status, message, passing }) => [status, message, Boolean(passing)]), [["waiting", "", false], ["refused", "y", false], ["ok", "", false]]);
  },
  "what the server keeps stays under new terms, and is as the workbench read it last": () => {
    const kept = frameOfAnswer({ ...answer("ok"), trace: { id: "t" } });
    equal(requeued([kept]), [kept]);
    const look = { result: answer("failed").result, image: { width: 16, height: 9 }, camera_scale: 1, stages: [] };
    const read = withReading(kept, look);
    equal([read.status, frameNote(read), read.answer.trace.id, read.answer.image.width], ["failed", "Lines: too few lines", "t", 16]);
    const own = frames()[0];
    equal(withReading(own, look), own);
  },
  "a frame says in a few words what became of it": () => {
    equal(frameNote(frameOfAnswer(answer("ok"))), "512 mm, blue");
    equal(frameNote(frameOfAnswer(answer("failed"))), "Lines: too few lines");
    equal(frameNote(newFrame(new File([], "x"), "The file is empty.")), "not readable");
  },
  "a frame of a flight that a bundle brings is named by its number": () => {
    equal(frameOfAnswer({ ...answer("ok"), bundle: { recorded: { frame: 7 } } }).name, "a.jpg, frame 7");
    equal(frameOfAnswer({ ...answer("ok"), bundle: { recorded: null } }).name, "a.jpg");
  },
  "the tally leaves out what is not there": () => {
    equal(tally([frameOfAnswer(answer("ok")), ...frames()]), "1 with a pose, 3 to read");
    equal(tally([]), "");
  },
  "a file is known by its name and beginning": () => {
    const kinds = [["x.YAML", ""], ["x.json", '{"format": "padstudio.pad"'], ["x.json", "{}"], ["x.jpg", ""], ["x.ZIP", ""], ["x.cameramodel", ""], ["truth.json", '[\n {"file": "a.jpg"'], ["metadata.yaml", ""],
      ["session.json", '{\n "format": "padstudio.live",'], ["0001.jsonl", ""]];
    equal(kinds.map(([name, head]) => kindOfFile(name, head)), ["camera", "pad", "camera", "image", "bundle", "camera", "truth", "truth", "live", "live"]);
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
    contains(faultBeforeUpload({ size: 9e6, name: "a.MP4" }, 9e6), "Flights reads videos");
    equal(faultBeforeUpload({ size: 9e6, name: "a.jpg" }, 9e6), "");
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
  "of several pads, what is offered, asked for and told": () => {
    const pads = ["a", "b", "c"].map((id) => ({ id, name: id.toUpperCase(), size_mm: [100, 100] }));
    equal(otherPads(pads, "b").map(({ id }) => id), ["a", "c"]);
    equal(padIds({ pads, pad: "b", others: ["c", "b", "gone"] }), ["b", "c"]);
    equal(othersNote([], "dense"), "");
    contains(othersNote(["c"], "dense"), "2 pads are looked for");
    contains(othersNote(["c"], "paper"), "reads one pad");
    const known = [{ id: "a", name: "A", pad_id: "AAAA" }, { id: "b", name: "B", pad_id: "BBBB" }];
    const found = { ...answer("ok"), camera_scale: 1, pads: known };
    const first = { ...found.result, pad_id: "BBBB" };
    const results = [first, { ...first, pad_id: "AAAA", quality: "full", position_mm: [0, 0, 2345] }];
    equal(padAmongSeveral(first, known), "pad “B”");
    equal([padAmongSeveral(first, known.slice(0, 1)), padAmongSeveral({ status: "failed" }, known)], ["", ""]);
    equal(resultNotes(frameOfAnswer({ ...found, results }), undefined),
      ["Also in the picture: the pad “A”, 2.35 m below the camera."]);
  },
  "a readout time as it is typed": () => {
    equal(["", " 18,5 ", "0", "1000"].map((text) => readoutFrom(text).readout), [null, 18.5, 0, 1000]);
    for (const text of ["-1", "fast", "1001"]) contains(readoutFrom(text).fault, "Milliseconds from 0");
    equal([readoutText(null), readoutText(0), readoutText(18.5)], ["", "0", "18.5"]);
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
