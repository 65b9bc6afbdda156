/**
 * The controller of the Cameras page: what is stored, and the calibration of a new one.
 *
 * @typedef {import("../server/api.js").CameraSummary} CameraSummary
 * @typedef {import("../server/calibrationApi.js").Calibration} Calibration
 *
 * @typedef {object} State
 * @property {import("../server/api.js").PadSummary[]} pads
 * @property {string} pad  chosen
 * @property {string} lens
 * @property {{stored: CameraSummary[] | null, presets: CameraSummary[]}} cameras
 * @property {string} form  in which cameras are saved
 * @property {import("./calibrationRun.js").PictureFile[]} files
 * @property {boolean} sending
 * @property {Calibration | null} job
 * @property {number} picture  of the result, the one whose residuals are shown
 * @property {string} stored  what became of the camera, in words
 * @property {import("../shared/components/status.js").Status} status
 */

import { addressKeeper, readAddress } from "../shared/address.js";
import * as api from "../server/api.js";
import { storeCamera } from "../server/calibrationApi.js";
import { messageOf } from "../server/request.js";
import { mountChoice } from "../shared/components/choice.js";
import { mountDropZone } from "../shared/components/dropZone.js";
import { mountFooter } from "../shared/components/footer.js";
import { loadFault, mountStatus } from "../shared/components/status.js";
import { kindIn } from "../shared/intake.js";
import { padGroups, padNote } from "../shared/readingLogic.js";
import { mountCalibrationResult } from "./components/calibrationResult.js";
import { mountCameraFiles } from "./components/cameraFiles.js";
import { mountCameraList } from "./components/cameraList.js";
import { mountPictureFiles } from "./components/pictureFiles.js";
import { isAtWork, missingInWords, progressInWords } from "./calibrationLogic.js";
import { makeCalibrationRun } from "./calibrationRun.js";

const byId = (/** @type {string} */ id) => /** @type {any} */ (document.getElementById(id));
const address = readAddress();

/** @type {State} */
const state = {
  pads: [],
  pad: address.get("pad") ?? "",
  lens: address.get("lens") ?? "auto",
  cameras: { stored: null, presets: [] },
  form: "ROS",
  files: [],
  sending: false,
  job: null,
  picture: 0,
  stored: "",
  status: null,
};

const padChoice = mountChoice(byId("pad-choice"), {
  onChoose: (pad) => set({ pad }),
  onFile: (file) => void attempt(() => importPad(file), file.name),
});
const files = mountPictureFiles(byId("picture-files"), {
  onRemove: (key) => run.remove((file) => key === null || file.key === key),
});
const result = mountCalibrationResult(byId("result"), {
  onStore: (wanted) => void attempt(() => store(wanted)),
  onPicture: (picture) => set({ picture }),
});
const cameras = mountCameraList(byId("stored"));
const cameraFiles = mountCameraFiles(byId("camera-files"), { onForm: (form) => set({ form }) });
const status = mountStatus(byId("status"));
const run = makeCalibrationRun({
  onFiles: (files) => set({ files }),
  onJob: (job) => set({ job, ...(job?.id === state.job?.id ? {} : { picture: 0, stored: "" }) }),
  onFault: (error) => set({ status: { kind: "bad", text: messageOf(error) } }),
});
const keepAddress = addressKeeper(() => ({
  pad: state.pad,
  lens: state.lens === "auto" ? null : state.lens,
  calibration: state.job?.id ?? null,
}));

/** @param {Partial<State>} change */
function set(change) {
  Object.assign(state, change);
  render();
  keepAddress();
}

function render() {
  const { job, pads, pad, sending } = state;
  const isBusy = sending || isAtWork(job);
  const found = pads.find((each) => each.id === pad);
  padChoice.update({ groups: padGroups(pads), chosen: pad, note: padNote(found) });
  files.update(state);
  result.update(state);
  cameras.update(state.cameras, state.form);
  cameraFiles.update(state);
  byId("lens").value = state.lens;
  const lacks = missingInWords({ pad, files: state.files.length });
  byId("missing").textContent = isBusy ? "" : lacks;
  byId("start").disabled = isBusy || Boolean(lacks);
  byId("stop").hidden = !isBusy;
  byId("running").hidden = !isBusy;
  const words = job && isAtWork(job) ? progressInWords(job) : "Sending the pictures …";
  if (byId("running-words").textContent !== words) byId("running-words").textContent = words;
  const bar = byId("running-bar");
  if (job?.steps_total && !sending) Object.assign(bar, { max: job.steps_total, value: job.steps_done });
  else bar.removeAttribute("value");
  byId("no-result").hidden = isBusy || Boolean(job?.result);
  const failed = job?.state === "failed" && job.error ? job.error.message : "";
  status.update(failed ? { kind: "bad", text: `No calibration: ${failed}.` } : state.status);
}

/** @param {() => Promise<void>} act @param {string} [file]  name of the one that it is done with */
async function attempt(act, file) {
  try {
    await act();
  } catch (error) {
    set({ status: { kind: "bad", text: messageOf(error, file) } });
  }
}

/** @param {File} file */
async function importPad(file) {
  const { id, name } = await api.importPad(file);
  const { items } = await api.listPads();
  set({ pads: items, pad: id, status: { kind: "ok", text: `Imported the pad “${name}”.` } });
}

/** @param {File} file */
async function importCamera(file) {
  const { name, note } = await cameraFiles.send(file);
  const text = `Imported the camera “${name}”.${note ? ` Note: ${note}.` : ""}`;
  set({ cameras: await api.listCameras(), status: { kind: note ? "warn" : "ok", text } });
}

/** @param {{name: string | null, readout_ms: number | null}} wanted */
async function store(wanted) {
  const { name } = await storeCamera(/** @type {Calibration} */ (state.job).id, wanted);
  set({ cameras: await api.listCameras(), stored: `Stored as “${name}”; choose it on Diagnose and Flights.` });
}

async function start() {
  set({ sending: true, status: null, job: null });
  await run.start({ pad: state.pad, lens: state.lens });
  set({ sending: false });
}

byId("order").addEventListener("submit", (/** @type {Event} */ event) => {
  event.preventDefault();
  void start();
});
byId("stop").addEventListener("click", () => void run.stop());
byId("lens").addEventListener("change", () => set({ lens: byId("lens").value }));
byId("camera-file").addEventListener("change", () => {
  const [file] = byId("camera-file").files;
  byId("camera-file").value = "";
  if (file) void attempt(() => importCamera(file), file.name);
});
mountDropZone(byId("drop-zone"), {
  onFiles: (chosen) => void takeFiles(chosen),
});

/** Whatever was dropped: pads and cameras are stored, the rest is of the calibration. @param {File[]} chosen */
async function takeFiles(chosen) {
  const pictures = [];
  for (const file of chosen) {
    const kind = await kindIn(file);
    if (kind === "pad") await attempt(() => importPad(file), file.name);
    else if (kind === "camera") await attempt(() => importCamera(file), file.name);
    else if (kind !== "truth") pictures.push(file);
  }
  if (pictures.length) run.add(pictures);
}
mountFooter();
render();
void Promise.all([api.listPads(), api.listCameras()]).then(
  ([pads, known]) => {
    const isKnown = pads.items.some(({ id }) => id === state.pad);
    set({ pads: pads.items, cameras: known, pad: isKnown ? state.pad : (pads.items[0]?.id ?? "") });
  },
  (error) => set({ status: loadFault(error) }),
);
const made = address.get("calibration");
if (made) void run.open(made);
