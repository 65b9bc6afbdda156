/**
 * Prints of the pad as files, and what comes back from paper: what the rulers read, and a photo of
 * the test strip.
 *
 * @typedef {object} PrintActionsOptions
 * @property {() => Promise<string | null>} padId  of the stored pad; stores it first where it is not
 * @property {(change: {scale?: [number, number],
 *   strip?: import("./printLogic.js").StripReading | null}) => Promise<void>} onChange
 * @property {(status: import("../shared/components/status.js").Status) => void} onStatus
 */

import { saveFile } from "../shared/address.js";
import { padFileUrl } from "../server/api.js";
import { fetchFile, messageOf } from "../server/request.js";
import * as planApi from "../server/planApi.js";
import { readings } from "./printLogic.js";

/** @param {PrintActionsOptions} options */
export function makePrintActions({ padId, onChange, onStatus }) {
  /** @param {(id: string) => Promise<string>} act  gives what to say of it */
  async function report(act) {
    const id = await padId();
    if (!id) return;
    try {
      onStatus({ kind: "ok", text: await act(id) });
    } catch (error) {
      onStatus({ kind: "bad", text: messageOf(error) });
    }
  }

  return {
    /**
     * Fetched here rather than by the browser, so that a refusal stands in the page.
     * @param {string} form
     * @param {string} query
     */
    fetchFile: (form, query) =>
      report(async (id) => {
        onStatus({ kind: "quiet", text: "Painting …" });
        const file = await fetchFile(padFileUrl(id, form, query));
        saveFile(file);
        return `Made “${file.name}”.`;
      }),
    /** @param {string} x @param {string} y */
    async takeReadings(x, y) {
      const read = readings(x, y);
      if (!read) {
        return onStatus({ kind: "bad", text: "Enter what both rulers read, from 100 to 400 mm." });
      }
      await report(async (id) => {
        await onChange({ scale: (await planApi.setScale(id, read)).scale });
        return "Set the measured size; poses use it from now on.";
      });
    },
    /** @param {File} photo */
    takeStripPhoto: (photo) =>
      report(async (id) => {
        onStatus({ kind: "quiet", text: "Reading the strip …" });
        await onChange({ strip: await planApi.measureCrosstalk(id, photo) });
        return "Read the test strip.";
      }),
    forgetStrip: () =>
      report(async (id) => {
        await planApi.forgetCrosstalk(id);
        await onChange({ strip: null });
        return "Pictures of this pad are not un-mixed any more.";
      }),
  };
}
