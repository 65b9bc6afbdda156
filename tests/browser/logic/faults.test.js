import { ApiError, isPassing, messageOf } from "/static/js/server/request.js";
import { holdStrayDrops } from "/static/js/shared/components/footer.js";
import { equal } from "./check.js";

const dropped = (kind, file = true) => {
  const dataTransfer = new DataTransfer();
  if (file) dataTransfer.items.add(new File(["x"], "flight.mp4"));
  return new DragEvent(kind, { dataTransfer, bubbles: true, cancelable: true });
};
/** Whether the browser may go on with it. */
const isLeft = (target, event) => target.dispatchEvent(event);

export const tests = {
  "a file that is dropped where nothing takes it does not end the page": () => {
    const place = document.createElement("main");
    equal(["dragover", "drop"].map((kind) => isLeft(place, dropped(kind))), [true, true]);
    holdStrayDrops(place);
    equal(["dragover", "drop"].map((kind) => isLeft(place, dropped(kind))), [false, false]);
  },
  "text that is dragged and fields for files stay the browser's": () => {
    const place = document.createElement("main");
    const field = Object.assign(document.createElement("input"), { type: "file" });
    place.append(field);
    holdStrayDrops(place);
    equal([isLeft(place, dropped("drop", false)), isLeft(field, dropped("drop"))], [true, true]);
  },
  "a file's name stands before what is wrong with it, once": () => {
    const fault = new Error("lens.yaml: holds no keys");
    equal(messageOf(fault, "lens.yaml"), "lens.yaml: holds no keys.");
    equal(messageOf(new Error("holds no keys"), "lens.yaml"), "lens.yaml: Holds no keys.");
    equal(messageOf(fault), "Lens.yaml: holds no keys.");
  },
  "what the server could not answer may go well later, what it refused may not": () => {
    const statuses = [0, 500, 503, 404, 413, 422];
    equal(statuses.map((status) => isPassing(new ApiError({ status, code: "x", message: "x" }))), [true, true, true, false, false, false]);
    equal(isPassing(new Error("x")), false);
  },
};
