import {
  agoInWords, cameraFault, factsOf, lengthFigure, missingInWords, readout, recordingInWords, sessionInWords, sightOf, verdictOf,
  withoutPassword, withRecent, withShown,
} from "/static/js/live/liveLogic.js";
import { equal } from "./check.js";

const ok = (change = {}) => ({
  status: "ok", position_mm: [12, -218.4, 1302.4], position_sigma_mm: [0.4, 0.5, 2.1], heading_deg: 24.1, tilt_deg: 14,
  attitude_sigma_deg: [0.2, 0.3, 0.04], layer: "red", quality: "full", elapsed_ms: {}, ...change,
});
const failed = { status: "failed", stage: "lines", reason: "defocus", detail: "no step is sharp", advice: "focus the lens", elapsed_ms: {} };
const figures = (change = {}) => ({
  frames: 412, read: 405, dropped: 3, recent_frames: 148, recent_read: 148, frames_per_s: 14.8,
  latency_ms: { median: 21.4, p95: 34 }, pose_ms: null, ...change,
});
const session = (change = {}) => ({
  id: "a", source: "rtsp://10.0.0.1/one", pad: { id: "p", name: "roof" }, camera: { id: "c", name: "" }, state: "running", error: null,
  stream: { phase: "open", detail: "", damaged: 0, connections: 1, size_px: [640, 480], codec: "h264" },
  sight: "found", sight_detail: "", newest: 4, figures: figures(), ...change,
});
const shown = (number, taken, size = 10) => ({ frame: { number, taken_s: taken, record: ok(), marks: {} }, picture: { size } });

export const tests = {
  "lengths are read from afar": () => {
    equal(lengthFigure(1302.4, 2.1), { value: "1.302", unit: "m", sigma: "± 2.1 mm" });
    equal(lengthFigure(-218.4, 14), { value: "−218", unit: "mm", sigma: "± 14 mm" });
    equal(lengthFigure(80, undefined).sigma, "");
  },
  "a full pose has a height and places": () => {
    const { names, figures: [height, right, up, heading, tilt] } = readout(ok());
    equal(names[0], "Height");
    equal([height.value, right.value, up.value, heading.value, tilt.value], ["1.302", "12", "−218", "24.1", "14.0"]);
    equal([heading.sigma, tilt.sigma], ["± 0.04°", "± 0.30°"]);
  },
  "of a far pad range and direction alone are shown": () => {
    const { names, figures: [range, right, , heading] } = readout(ok({ quality: "bearing", range_mm: 16200, bearing: [0.1, 0, 0.995] }));
    equal([names[0], range.value, right.value, heading.value], ["Range", "16.200", "5.7", "–"]);
  },
  "a lost pad says why, with what to try": () => {
    equal(sightOf(session(), failed), { kind: "lost", badge: "Lost: out of focus", reason: "No step is sharp. Focus the lens." });
    equal(sightOf(session(), ok()).kind, "found");
  },
  "a stream that is away says so, whatever was seen last": () => {
    const away = session({ stream: { ...session().stream, phase: "lost", detail: "no packet came for 5 s" } });
    equal(sightOf(away, ok()), { kind: "no_stream", badge: "No stream", reason: "No packet came for 5 s." });
    equal(sightOf(away, ok(), true).kind, "found");
    equal(sightOf(session({ state: "failed", error: { code: "x", message: "it died" } }), ok()).reason, "It died.");
    equal(sightOf(null, null).badge, "Not started");
  },
  "the page's question is answered by the last ten seconds": () => {
    equal(verdictOf(figures()).kind, "ok");
    equal(verdictOf(figures({ recent_read: 80 })).kind, "warn");
    equal(verdictOf(figures({ recent_read: 3 })).kind, "bad");
    equal(verdictOf(figures({ recent_read: 0 })).text, "No: none of the frames of the last ten seconds is read.");
    equal(verdictOf(figures({ recent_frames: 2, recent_read: 2 })).kind, "quiet");
  },
  "figures are told": () => {
    const facts = Object.fromEntries(factsOf(session()));
    equal(facts["Read, last 10 s"], "148 of 148 frames");
    equal(facts["Taken or received to pose"], "21 ms, 95th percentile 34 ms");
    equal(facts["Decoded to pose"], "–");
    equal(factsOf(session({ figures: null })), []);
  },
  "ten seconds are kept": () => {
    const kept = [0, 4, 8, 12].reduce((all, taken, k) => withShown(all, shown(k, taken)), []);
    equal(kept.map(({ frame }) => frame.number), [1, 2, 3]);
    equal(agoInWords(kept, 0), "Frame 1, 8.0 s before the newest");
    equal(withShown(kept, shown(9, 12.1, 200_000_000)).length, 1);
  },
  "frames of another session begin anew": () => {
    equal(withShown([shown(7, 3)], shown(0, 0)).length, 1);
  },
  "what is missing is named": () => {
    equal(missingInWords({ pad: "", camera: "", source: "camera", url: "" }), "Choose the pad that was printed.");
    equal(missingInWords({ pad: "p", camera: "c", source: "stream", url: " " }), "Type the stream’s address.");
    equal(missingInWords({ pad: "p", camera: "c", source: "camera", url: "" }), "");
  },
  "each way a browser refuses its camera has its own words": () => {
    const place = { isSecure: true, host: "pad.lan" };
    const words = ["NotAllowedError", "NotFoundError", "NotReadableError", "OverconstrainedError", ""].map((name) => cameraFault({ name }, place));
    equal(new Set(words).size, 5);
    equal(cameraFault({ name: "TypeError" }, { ...place, isSecure: false }).includes("https"), true);
  },
  "passwords are not kept": () => {
    equal(withoutPassword(" rtsp://me:secret@10.0.0.1:554/one "), "rtsp://10.0.0.1:554/one");
    equal(withoutPassword("rtsp://10.0.0.1/a@b"), "rtsp://10.0.0.1/a@b");
    equal(withRecent(["rtsp://10.0.0.1/one", "rtsp://b/"], "rtsp://u:p@10.0.0.1/one"), ["rtsp://10.0.0.1/one", "rtsp://b/"]);
  },
  "a recording is told": () => {
    const recording = { id: "r", is_on: true, phase: "recording", detail: "", frames: 1, bytes: 20_400 };
    equal(recordingInWords(null), "");
    equal(recordingInWords(recording), "Recording: 1 frame, 20.4 kB.");
    equal(recordingInWords({ ...recording, is_on: false, phase: "closed", frames: 31 }), "Recorded 31 frames, 20.4 kB.");
    equal(recordingInWords({ ...recording, phase: "stopped", detail: "the disk is full" }), "The disk is full.");
    equal(recordingInWords({ ...recording, is_on: false, phase: "closed", frames: 0 }).includes("Nothing"), true);
  },
  "a session in a line": () => {
    equal(sessionInWords(session()), "rtsp://10.0.0.1/one: roof, open, 100 % read");
  },
};
