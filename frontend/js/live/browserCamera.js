/**
 * This device's camera: opened, and its newest picture taken as a file.
 *
 * @typedef {{device: string, size: string}} CameraWish  device: an id, "back" or "front"; size: such as "1280x720"
 * @typedef {{width: number, height: number, grab: () => Promise<Blob>, next: () => Promise<void>, close: () => void, onEnd: (act: () => void) => void}} OpenCamera
 */

// JPEG that leaves nothing out that a cell shows.
const QUALITY = 0.95;
// A tab in the background is shown no frames; it goes on at this rate.
const HIDDEN_MS = 500;

/** @param {CameraWish} wish @returns {MediaStreamConstraints} */
function constraints({ device, size }) {
  const [width, height] = size.split("x").map(Number);
  const which = device === "back" || device === "front"
    ? { facingMode: device === "back" ? "environment" : "user" }
    : { deviceId: { exact: device } };
  return { audio: false, video: { ...which, width: { ideal: width }, height: { ideal: height } } };
}

/**
 * @param {CameraWish} wish
 * @returns {Promise<OpenCamera>}
 * @throws {DOMException | TypeError} as of getUserMedia
 */
export async function openCamera(wish) {
  const stream = await navigator.mediaDevices.getUserMedia(constraints(wish));
  const video = document.createElement("video");
  Object.assign(video, { muted: true, playsInline: true, srcObject: stream });
  await video.play();
  const canvas = document.createElement("canvas");

  return {
    width: video.videoWidth,
    height: video.videoHeight,
    /** The newest picture. */
    grab() {
      // A phone that is turned gives pictures of another shape.
      [canvas.width, canvas.height] = [video.videoWidth, video.videoHeight];
      /** @type {CanvasRenderingContext2D} */ (canvas.getContext("2d")).drawImage(video, 0, 0);
      return new Promise((resolve, reject) => {
        canvas.toBlob((blob) => (blob ? resolve(blob) : reject(new Error("the browser made no picture"))), "image/jpeg", QUALITY);
      });
    },
    /** Wait until the camera has another picture. */
    next: () => new Promise((resolve) => {
      const timer = window.setTimeout(resolve, HIDDEN_MS);
      if (!("requestVideoFrameCallback" in video)) return;
      video.requestVideoFrameCallback(() => {
        window.clearTimeout(timer);
        resolve();
      });
    }),
    close() {
      for (const track of stream.getTracks()) track.stop();
      video.srcObject = null;
    },
    /** Call when somebody pulls the camera. */
    onEnd(act) {
      for (const track of stream.getTracks()) track.addEventListener("ended", act);
    },
  };
}

/** Cameras by name; names are told only once a camera may be used. @returns {Promise<{id: string, text: string}[]>} */
export async function listDevices() {
  const devices = await navigator.mediaDevices?.enumerateDevices() ?? [];
  return devices
    .filter(({ kind, deviceId, label }) => kind === "videoinput" && deviceId && label)
    .map(({ deviceId, label }) => ({ id: deviceId, text: label }));
}
