/**
 * What the server takes and answers, as types; other modules take them from here.
 *
 * @typedef {object} PadSpec
 * @property {string} name
 * @property {number} window  b: every b × b window of a layer is there once
 * @property {number} levels  Y: levels of a cell
 * @property {number} rows  rows of the red layer
 * @property {number} cols  columns of the red layer
 * @property {number} ratio  red cells along one blue cell; 1 leaves the blue layer out
 * @property {number} cell_mm  side of a red cell
 * @property {number} quiet_mm  white margin
 * @property {"rotation" | "plain"} unique
 * @property {number} distance  least number of cells in which two windows differ
 * @property {boolean} visible_lines  each window shows a change of level across each inner line
 * @property {LayerFields} layers
 * @property {"growth" | "auto"} method
 * @property {number | null} seed  null: drawn by the server
 *
 * @typedef {"independent" | "paper"} LayerFields  paper: the blue field is the red one's corner
 *
 * @typedef {"red" | "green" | "blue"} Channel
 *
 * @typedef {object} PadFile
 * @property {string} name
 * @property {number} window
 * @property {number} levels
 * @property {number} [quiet_mm]
 * @property {boolean} [visible_lines]
 * @property {LayerFields} [layer_fields]
 * @property {{channel: Channel, cell_mm: number, codes: string[]}[]} layers
 *
 * @typedef {object} NearPair
 * @property {number} row
 * @property {number} col
 * @property {number} other_row
 * @property {number} other_col
 * @property {number} turn  quarter turns of the other that bring the two nearest
 * @property {number} distance  cells in which they then differ
 *
 * @typedef {object} Verification
 * @property {string} [channel]
 * @property {number} window
 * @property {number} windows
 * @property {number} windows_possible
 * @property {boolean} unique
 * @property {boolean} unique_under_rotation
 * @property {boolean} visible_lines
 * @property {number} distance_limit
 * @property {number | null} [min_distance]
 * @property {number | null} [min_distance_under_rotation]
 * @property {number[]} [histogram]
 * @property {number[]} [histogram_under_rotation]
 * @property {number[]} [level_counts]
 * @property {NearPair[]} [weakest]
 * @property {OtherLayer[]} [others]
 * @property {LayersApart[]} [apart]  of each two layers
 * @property {string[]} [broken]  promises of the pad that do not hold
 *
 * @typedef {object} LayersApart  windows of two layers beside each other, in any turn
 * @property {[string, string]} channels  of the finer layer and the coarser one
 * @property {"independent" | "near" | "shared"} relation
 * @property {number} shared  windows that occur in both
 * @property {boolean} is_corner  the coarser layer is a copy of the finer one's corner
 * @property {number} min_distance  cells in which two windows differ at least
 *
 * @typedef {Pick<Verification, "unique" | "unique_under_rotation" | "min_distance" |
 *   "min_distance_under_rotation"> & {channel: string}} OtherLayer
 *
 * @typedef {object} SheetPlan  lengths on the page in mm from its top left
 * @property {string} paper
 * @property {"portrait" | "landscape"} orientation
 * @property {[number, number]} paper_mm
 * @property {[number, number]} page_mm
 * @property {number} rows
 * @property {number} cols
 * @property {number} count
 * @property {number} paper_m2
 * @property {boolean} on_cells
 * @property {number[]} x_seams_mm
 * @property {number[]} y_seams_mm
 * @property {{name: string, row: number, col: number,
 *   core_mm: [number, number, number, number], at_mm: [number, number]}[]} sheets
 *
 * @typedef {object} PadShape  what sheets and coverage depend on
 * @property {number} window
 * @property {number} levels
 * @property {number} quiet_mm
 * @property {{channel: string, rows: number, cols: number, cell_mm: number}[]} layers
 *
 * @typedef {"dense" | "paper"} Method
 *
 * @typedef {object} Span  heights at which a layer reads at one tilt; null where at none
 * @property {string} layer  a channel, or "outline": the sign as a whole
 * @property {number} tilt_deg
 * @property {number | null} low_mm
 * @property {number | null} high_mm
 *
 * @typedef {object} DeadBand
 * @property {number} tilt_deg
 * @property {number} low_mm
 * @property {number} high_mm
 * @property {string} message
 *
 * @typedef {object} MethodCoverage
 * @property {Method} method
 * @property {number} cell_px
 * @property {number | null} sign_cell_px
 * @property {Span[]} spans
 * @property {DeadBand[]} dead_bands
 *
 * @typedef {{width_px: number, height_px: number, focal_px: number}} View  a camera as a pinhole
 *
 * @typedef {{camera: string, view: View, methods: MethodCoverage[]}} CoverageChart
 *
 * @typedef {object} Simulation  a job
 * @property {string} id
 * @property {string} name
 * @property {"queued" | "running" | "done" | "failed" | "cancelled"} state
 * @property {number} frames_total
 * @property {number} frames_done
 * @property {string | null} upload
 * @property {string | null} flight  its analysis
 * @property {{code: string, message: string} | null} error
 *
 * @typedef {object} PoseRecord
 * @property {"ok" | "failed"} status
 * @property {[number, number, number]} [position_mm]
 * @property {number[][]} [rotation]
 * @property {[number, number, number, number]} [quaternion_xyzw]
 * @property {number} [heading_deg]
 * @property {number} [tilt_deg]
 * @property {string} [layer]
 * @property {number} [cells_read]
 * @property {number} [cells_wrong]
 * @property {number} [log10_false_alarm]
 * @property {number} [reprojection_px]
 * @property {number | null} [flatness_mm]
 * @property {[number, number, number] | null} [position_sigma_mm]
 * @property {[number, number, number] | null} [attitude_sigma_deg]
 * @property {number} [range_mm]  from the camera to the pad's centre
 * @property {number | null} [range_sigma_mm]
 * @property {[number, number, number]} [bearing]  unit vector to the pad's centre, camera frame
 * @property {number | null} [bearing_sigma_deg]
 * @property {Quality | null} [quality]  null where unknown
 * @property {string} [pad_id]  of the pad that the pose is of
 * @property {string} [stage]
 * @property {string} [reason]
 * @property {string} [detail]
 * @property {string} [advice]
 * @property {{reason: string, detail: string, advice: string}[]} [findings]  of a second look
 * @property {Record<string, number>} elapsed_ms
 * @property {{unix_s?: number, number?: number, latency_ms?: number}} [live]  of a frame that a live session recorded
 *
 * @typedef {{id: string, name: string, pad_id: string}} KnownPad  pad_id: as of poses
 *
 * @typedef {"full" | "bearing"} Quality  "bearing": range and bearing alone can be used
 *
 * @typedef {object} Failure
 * @property {string} stage
 * @property {string} reason
 * @property {string} detail
 * @property {string} [advice]
 *
 * @typedef {object} StageAnswer
 * @property {string} name
 * @property {Channel | null} channel
 * @property {number} elapsed_ms
 * @property {Failure | null} failure
 * @property {string | null} picture
 * @property {string | null} thumbnail
 *
 * @typedef {object} DetectAnswer
 * @property {PoseRecord & {source: string}} result
 * @property {(PoseRecord & {source: string})[]} [results]  one for each pad that was found, the best first
 * @property {KnownPad[]} [pads]  those that were looked for
 * @property {{width: number, height: number}} image
 * @property {number} camera_scale
 * @property {{id: string, result_picture: string | null, stages: StageAnswer[]} | null} trace
 * @property {import("./bundleApi.js").Bundle | null} [bundle]  that it was opened from
 *
 * @typedef {object} Column
 * @property {number} column  from 0
 * @property {number} first_frame
 * @property {number} last_frame
 * @property {number | null} time_s
 * @property {number | null} z_min_mm
 * @property {number | null} z_max_mm
 * @property {number[]} outcomes  frames, as OUTCOMES
 * @property {Record<string, number>} stages  first failing stage: frames
 * @property {Record<string, Record<string, number>>} [failed_at]  the same by channel
 *
 * @typedef {object} Timeline
 * @property {number} first_frame
 * @property {number} last_frame
 * @property {number} frames_per_column
 * @property {Column[]} columns  those that hold frames
 *
 * @typedef {object} Trajectory  columns of equal length, null where a frame has no pose
 * @property {number[]} frame
 * @property {(number | null)[]} time_s
 * @property {(number | null)[]} x_mm
 * @property {(number | null)[]} y_mm
 * @property {(number | null)[]} z_mm
 * @property {(Quality | null)[]} quality
 *
 * @typedef {object} HeightFit
 * @property {number} slope
 * @property {number} slope_low
 * @property {number} slope_high
 * @property {number} offset_mm
 * @property {number} scatter_mm
 * @property {number} samples
 * @property {number} range_m
 * @property {"agrees" | "too_high" | "too_low" | "uncertain"} verdict
 *
 * @typedef {object} Figures
 * @property {Trajectory} trajectory
 * @property {{number: number, frame: number, quality?: Quality | null, position_mm: [number, number, number] | null,
 *   axis: [number, number, number] | null}[]} samples
 * @property {{frame: number[], telemetry_m: number[], pose_mm: number[], fit: HeightFit | null} | null} heights
 */

/**
 * @typedef {object} VehicleComparison  poses beside the vehicle's log
 * @property {string} kind
 * @property {{is_flights: boolean, offset_s: number | null, sigma_s: number | null, climb_correlation: number | null,
 *   turn_correlation: number | null, overlap_s: number, reason: string}} clock
 * @property {{rotation: number[][], turned_deg: number, lean_forward_deg: number, lean_right_deg: number,
 *   sigma_deg: number[], residual_deg: number, undetermined: number[][]} | null} mount
 * @property {string} mount_reason
 * @property {HeightFit | null} fit
 * @property {{value: number, low: number, high: number} | null} scale_error
 * @property {Record<string, (number | null)[]>} columns
 */

export {};
