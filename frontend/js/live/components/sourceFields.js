/** Where pictures come from: a camera of this device, or a stream's address. */

/**
 * @param {{source: HTMLElement, camera: HTMLElement, stream: HTMLElement}} roots
 * @param {(change: {source?: string, device?: string, size?: string, url?: string}) => void} onChange
 */
export function mountSourceFields({ source, camera, stream }, onChange) {
  const find = (/** @type {string} */ name) =>
    /** @type {any} */ (camera.querySelector(`[data-ref=${name}]`) ?? stream.querySelector(`[data-ref=${name}]`));
  const device = /** @type {HTMLSelectElement} */ (find("device"));
  const own = [...device.options];
  let shown = "";
  source.addEventListener("change", (event) => onChange({ source: /** @type {any} */ (event.target).value }));
  device.addEventListener("change", () => onChange({ device: device.value }));
  find("size").addEventListener("change", () => onChange({ size: find("size").value }));
  find("address").addEventListener("input", () => onChange({ url: find("address").value }));

  return {
    /**
     * @param {{source: string, device: string, devices: {id: string, text: string}[], size: string, url: string,
     *   recent: string[], advice: string, isBusy: boolean}} state
     */
    update(state) {
      for (const input of source.querySelectorAll("input")) {
        input.checked = input.value === state.source;
        input.disabled = state.isBusy;
      }
      camera.hidden = state.source !== "camera";
      stream.hidden = state.source !== "stream";
      const key = JSON.stringify([state.devices, state.recent]);
      if (key !== shown) {
        shown = key;
        device.replaceChildren(...own, ...state.devices.map(({ id, text }) => new Option(text, id)));
        find("recent").replaceChildren(...state.recent.map((each) => new Option(each, each)));
      }
      device.value = state.device;
      // A device that is gone: the one at the back is what is asked for.
      if (!device.value) device.value = "back";
      find("size").value = state.size;
      if (find("address").value !== state.url) find("address").value = state.url;
      for (const name of ["device", "size", "address"]) find(name).disabled = state.isBusy;
      if (find("advice").textContent !== state.advice) find("advice").textContent = state.advice;
    },
  };
}
