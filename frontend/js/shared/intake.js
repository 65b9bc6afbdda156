/**
 * Takes files in: pictures go to the queue, pads and cameras to the server.
 *
 * @typedef {import("../server/api.js").PadSummary} PadSummary
 * @typedef {import("../server/api.js").CameraSummary} CameraSummary
 * @typedef {import("./components/status.js").Status} Status
 *
 * @typedef {object} IntakeOptions
 * @property {() => {pads: PadSummary[], stored: CameraSummary[]}} known
 * @property {(pad: string, pads: PadSummary[]) => void} onPad  chosen id and the new list
 * @property {(camera: string, cameras: {presets: CameraSummary[], stored: CameraSummary[]}) => void} onCamera
 * @property {(files: File[]) => void} onPictures
 * @property {(file: File) => Promise<string>} [onBundle]  what was done with a zip, in words
 * @property {(status: Status) => void} onStatus
 */

import * as api from "../server/api.js";
import { fetchFile, messageOf } from "../server/request.js";
import { namesInSample } from "./readingLogic.js";
import { framesFromQuery, parseFrames } from "./frameLogic.js";
import { kindOfFile } from "./queueLogic.js";
import { simulateFrames } from "./simulatedFrames.js";

const HEAD_BYTES = 400;

/** What a file is, by its name and its beginning. @param {File} file */
export async function kindIn(file) {
  const head = /\.json$/i.test(file.name) ? await file.slice(0, HEAD_BYTES).text() : "";
  return kindOfFile(file.name, head);
}

/**
 * @param {IntakeOptions} options
 */
export function makeIntake({ known, onPad, onCamera, onPictures, onBundle, onStatus }) {
  /** @param {string} doing @param {string} file  its name, or empty @param {() => Promise<string>} act */
  async function report(doing, file, act) {
    onStatus({ kind: "quiet", text: doing });
    try {
      onStatus({ kind: "ok", text: await act() });
    } catch (error) {
      onStatus({ kind: "bad", text: messageOf(error, file) });
    }
  }

  /** @param {File} file */
  async function importPad(file) {
    const { id, name } = await api.importPad(file);
    onPad(id, (await api.listPads()).items);
    return `Imported the pad “${name}”.`;
  }

  /** @param {File} file */
  async function importCamera(file) {
    const { id, name, note } = await api.importCamera(file);
    onCamera(id, await api.listCameras());
    return `Added the camera “${name}”.${note ? ` Note: ${note}.` : ""}`;
  }

  async function importSample() {
    const sample = await api.getSample();
    const [padFile, cameraFile, ...pictures] = await Promise.all(
      [sample.pad, sample.camera, ...sample.pictures].map(fetchFile),
    );
    // A second try must not store the sample's pad and camera again.
    const names = namesInSample(await padFile.text(), await cameraFile.text());
    const { pads } = known();
    const pad = pads.find((each) => each.name === names.pad);
    if (pad) onPad(pad.id, pads);
    else await importPad(padFile);
    const cameras = await api.listCameras();
    const camera = cameras.stored.find((each) => each.name === names.camera);
    if (camera) onCamera(camera.id, cameras);
    else await importCamera(cameraFile);
    onPictures(pictures);
    return `Opened the sample: ${pictures.length} pictures.`;
  }

  const takePad = (/** @type {File} */ file) =>
    report(`Sending ${file.name} …`, file.name, () => importPad(file));
  const takeCamera = (/** @type {File} */ file) =>
    report(`Sending ${file.name} …`, file.name, () => importCamera(file));

  return {
    takePad,
    takeCamera,
    /** @param {string} camera  id @param {number | null} readoutMs */
    takeReadout: (camera, readoutMs) =>
      report("Storing the readout time …", "", async () => {
        const { id, name } = await api.setReadout(camera, readoutMs);
        onCamera(id, await api.listCameras());
        return `Stored the readout time of “${name}”.`;
      }),
    /**
     * Pictures that the Plan page asks for in the address.
     * @param {string} query
     * @param {{pad: string, camera: string}} reading
     */
    takeSimulated: (query, { pad, camera }) =>
      report("Simulating …", "", async () => {
        const { wishes } = parseFrames(framesFromQuery(new URLSearchParams(query)));
        if (!wishes) throw new Error("The address asks for pictures that cannot be simulated.");
        for await (const { file } of simulateFrames(wishes, { pad, camera })) onPictures([file]);
        return wishes.length > 1 ? `Simulated ${wishes.length} pictures.` : "Simulated the picture.";
      }),
    takeSample: () => report("Fetching the sample …", "", importSample),
    /** Whatever was dropped: pads and cameras first, so that pictures find them. @param {File[]} files */
    async takeFiles(files) {
      const pictures = [];
      for (const file of files) {
        const kind = await kindIn(file);
        if (kind === "pad") await takePad(file);
        else if (kind === "camera") await takeCamera(file);
        else if (kind === "bundle" && onBundle) await report(`Opening ${file.name} …`, file.name, () => onBundle(file));
        else if (kind !== "truth") pictures.push(file);
      }
      if (pictures.length) onPictures(pictures);
    },
  };
}
