/**
 * What comes back from a print: what its rulers read, and a photo of its test strip.
 *
 * @typedef {object} PrintReportOptions
 * @property {() => Promise<string | null>} padId  of the stored pad; stores it first where it is not
 * @property {(scale: [number, number]) => Promise<void>} onScale
 * @property {(strip: import("./planApi.js").Crosstalk | null) => void} onStrip
 * @property {(status: import("./components/status.js").Status) => void} onStatus
 */

import { messageOf } from "./api.js";
import * as planApi from "./planApi.js";
import { readings } from "./printLogic.js";

/** @param {PrintReportOptions} options */
export function makePrintReports({ padId, onScale, onStrip, onStatus }) {
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
    /** @param {string} x @param {string} y */
    async takeReadings(x, y) {
      const read = readings(x, y);
      if (!read) {
        return onStatus({ kind: "bad", text: "Enter what both rulers read, from 100 to 400 mm." });
      }
      await report(async (id) => {
        await onScale((await planApi.setScale(id, read)).scale);
        return "Set the measured size; poses use it from now on.";
      });
    },
    /** @param {File} photo */
    takeStripPhoto: (photo) =>
      report(async (id) => {
        onStrip(null);
        onStatus({ kind: "quiet", text: "Reading the strip …" });
        onStrip(await planApi.measureCrosstalk(id, photo));
        return "Read the test strip.";
      }),
  };
}
