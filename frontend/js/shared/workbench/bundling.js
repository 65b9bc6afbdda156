/**
 * Saves what is looked at as a bundle: one zip that opens again in any install, at the same view.
 *
 * @typedef {import("../../server/tuningApi.js").Reading} Reading
 */

import { saveFile } from "../address.js";
import { makeBundle } from "../../server/bundleApi.js";
import { messageOf } from "../../server/request.js";

/**
 * @param {Reading} reading
 * @param {Record<string, string | null>} address  of the page
 * @param {(status: import("../components/status.js").Status) => void} onStatus
 */
export async function saveBundle(reading, address, onStatus) {
  const view = Object.entries(address).filter(([, value]) => value !== null && value !== "");
  onStatus({ kind: "quiet", text: "Making the bundle …" });
  try {
    const file = await makeBundle(reading, /** @type {Record<string, string>} */ (Object.fromEntries(view)));
    saveFile(file);
    onStatus({ kind: "ok", text: `Saved ${file.name}. Dropped on Diagnose it opens again, in any install.` });
  } catch (error) {
    onStatus({ kind: "bad", text: messageOf(error) });
  }
}
