/**
 * Cameras of which nothing is known but about how wide they look: good for a first look.
 *
 * @typedef {{id: string, text: string, name: string, wide_deg: number}} Nominal
 *   wide_deg: along the picture's longer side
 */

/** @type {Nominal[]} */
export const NOMINAL = [
  { id: "nominal-65", text: "a phone’s main camera, about 65° wide", name: "phone", wide_deg: 65 },
  { id: "nominal-60", text: "a laptop’s webcam, about 60° wide", name: "laptop webcam", wide_deg: 60 },
  { id: "nominal-70", text: "a webcam on a stand, about 70° wide", name: "webcam", wide_deg: 70 },
  { id: "nominal-85", text: "a wide camera, about 85° wide", name: "wide camera", wide_deg: 85 },
];

/** @param {string} id @returns {Nominal | undefined} */
export const nominalOf = (id) => NOMINAL.find((each) => each.id === id);

/**
 * The camera file of one, for pictures of a size.
 * @param {Nominal} nominal
 * @param {number} width
 * @param {number} height
 * @returns {string}  ROS YAML
 */
export function cameraFile({ name, wide_deg: wide }, width, height) {
  const focal = Math.max(width, height) / 2 / Math.tan((wide * Math.PI) / 360);
  const matrix = [focal, 0, (width - 1) / 2, 0, focal, (height - 1) / 2, 0, 0, 1];
  return [
    `image_width: ${width}`,
    `image_height: ${height}`,
    `camera_name: "${name}, about ${wide} degrees wide"`,
    "nominal: true",
    "camera_matrix:",
    "  rows: 3",
    "  cols: 3",
    `  data: [${matrix.join(", ")}]`,
    "distortion_model: plumb_bob",
    "distortion_coefficients:",
    "  rows: 1",
    "  cols: 5",
    "  data: [0, 0, 0, 0, 0]",
    "",
  ].join("\n");
}
