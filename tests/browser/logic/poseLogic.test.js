import {
  doubtInWords, evidenceFacts, poseFacts, poseInWords, qualityBadge, rangeFacts, rangeInWords, verdict,
} from "/static/js/shared/poseLogic.js";
import { equal } from "./check.js";

const RECORD = {
  status: "ok",
  position_mm: [-40.34, 0.01, 3500],
  quaternion_xyzw: [1, 0, 0, -0.00001],
  heading_deg: 350,
  tilt_deg: 12.34,
  layer: "red",
  cells_read: 5120,
  cells_wrong: 3,
  log10_false_alarm: -300.2,
  reprojection_px: 0.2126,
  position_sigma_mm: [0.311, 0.2, 0.1],
  attitude_sigma_deg: null,
  elapsed_ms: { total: 1234.5 },
};

const FAR = {
  ...RECORD, quality: "bearing", range_mm: 16_200, range_sigma_mm: 90, bearing: [0.0543, -0.0174, 0.9984],
  bearing_sigma_deg: 0.0123, position_sigma_mm: [2000, 2300, 60], attitude_sigma_deg: [8, 7, 0.1],
};

export const tests = {
  "where range and bearing alone are known, they come first, and why": () => {
    equal([verdict(FAR), qualityBadge(FAR)], ["Range and direction found from the red layer", "bearing only"]);
    equal(poseInWords(FAR), [
      "The pad's centre is 16.20 m ± 90.0 mm away, 3.1° to the right and 1.0° up.",
      "The camera's attitude, and so the place across, is too uncertain to use.",
    ]);
    equal(doubtInWords(FAR),
      "Not to be used: one standard deviation is 10.6° of attitude and 3.05 m of place, 19 % of the distance. " +
        "A pad that is small in the picture hardly shows its tilt.");
    equal(rangeInWords({ ...FAR, bearing: [0, 0, 1], range_sigma_mm: null }), "16.20 m, straight ahead");
    equal(doubtInWords({ ...FAR, quality: "full" }), "");
  },
  "range and direction in figures, of any pose": () => {
    equal(rangeFacts(FAR), [
      ["Range", "16.20 m ± 90.0 mm"], ["Right of straight ahead", "3.11°"], ["Below it", "−1.00°"],
      ["Direction ±", "0.012°"], ["Bearing xyz", "0.0543, −0.0174, 0.9984"],
    ]);
    equal(rangeFacts({ ...FAR, range_sigma_mm: null, bearing_sigma_deg: null }).length, 4);
    equal(rangeFacts(RECORD), []);
  },
  "a pose of unknown quality is said to be one": () => {
    equal(qualityBadge({ ...FAR, quality: "full" }), "");
    equal([qualityBadge(RECORD), verdict(RECORD)], ["quality unknown", "Pose found from the red layer"]);
    equal(qualityBadge({ status: "failed", elapsed_ms: {} }), "");
  },
  "a pose in words": () => {
    equal(poseInWords(RECORD), [
      "The camera is 3.50 m above the pad, 40.3 mm to the left from the pad's centre.",
      "It looks 12.3° away from straight down.",
      "The top of the picture points 10.0° anticlockwise from the top of the page.",
    ]);
    equal(poseInWords({ ...RECORD, position_mm: [0, 0, 65.4], heading_deg: 360, tilt_deg: 0 }), [
      "The camera is 65.4 mm above the pad, straight over the pad's centre.",
      "It looks straight down.",
      "The top of the picture is the top of the page.",
    ]);
    equal(poseInWords({ ...RECORD, position_mm: [5, -120, 500] })[0],
      "The camera is 500 mm above the pad, 5.0 mm to the right and 120 mm down the page from the pad's centre.");
  },
  "a pose in figures, with its deviation": () => {
    equal(poseFacts(RECORD).slice(0, 4), [
      ["X", "−40.34 ± 0.31 mm"], ["Y", "0.01 ± 0.20 mm"], ["Z", "3500.00 ± 0.10 mm"], ["Heading", "350.00°"],
    ]);
    equal(poseFacts(RECORD).at(-1), ["Quaternion xyzw", "1.0000, 0.0000, 0.0000, 0.0000"]);
    equal(poseFacts({ ...RECORD, position_sigma_mm: null })[0], ["X", "−40.34 mm"]);
  },
  "what the pose rests on": () => {
    const facts = Object.fromEntries(evidenceFacts(RECORD));
    equal(facts["Chance of a false match"], "below 10⁻³⁰⁰");
    equal([facts["Cells read"], facts["Cells that differ"], facts.Time], ["5120", "3", "1.23 s"]);
    equal("Paper bent by" in facts, false);
    equal(Object.fromEntries(evidenceFacts({ ...RECORD, flatness_mm: 6.04 }))["Paper bent by"], "6.0 mm");
  },
  "the verdict names the layer, or the stage and the reason": () => {
    equal(verdict(RECORD), "Pose found from the red layer");
    equal(verdict({ ...RECORD, layer: "outline" }), "Pose found from the outline of the pad");
    equal(verdict({ status: "failed", stage: "block_mean", reason: "no_contrast", elapsed_ms: {} }),
      "No pose: no contrast at stage Block mean");
  },
};
