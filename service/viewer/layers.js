/** The layers of the map, from the ground up. Each draws in m, with the camera applied. */

import { colour, shade } from "./palette.js";
import { meet } from "./geometry.js";

const SMALL = 48; // pixels; a smaller zone is drawn with few points
const DETAIL = 8; // pixels; a smaller zone has no walls
const FRONTIER = 14; // pixels

/** @typedef {CanvasRenderingContext2D} Context */
/** @typedef {import("./camera.js").Camera} Camera */

/** @param {Context} context @param {Camera} camera @param {number} ratio the unexplored: dim, with a dot each metre */
export function drawGround(context, camera, ratio) {
  context.setTransform(ratio, 0, 0, ratio, 0, 0);
  context.fillStyle = colour("dim");
  context.fillRect(0, 0, camera.width, camera.height);
  let step = 1;
  while (step * camera.scale < 22) step *= 5;
  if (step > 1e5) return;
  const [x0, y0, x1, y1] = camera.window;
  context.fillStyle = colour("dots");
  for (let x = Math.ceil(x0 / step) * step; x <= x1; x += step) {
    for (let y = Math.ceil(y0 / step) * step; y <= y1; y += step) {
      const [px, py] = camera.toScreen(x, y);
      context.fillRect(px - 0.75, py - 0.75, 1.5, 1.5);
    }
  }
}

/** @param {Context} context @param {Camera} camera @param {any} world what the simulated sensor senses */
export function drawWorld(context, camera, world) {
  context.lineWidth = camera.pixel;
  context.strokeStyle = colour("world");
  context.setLineDash([3 * camera.pixel, 3 * camera.pixel]);
  context.stroke(world.space);
  context.stroke(world.obstacle);
  context.strokeStyle = colour("passage");
  context.globalAlpha = 0.5;
  context.stroke(world.passage);
  context.globalAlpha = 1;
  context.setLineDash([]);
}

/** @param {Camera} camera @param {import("./model.js").Zone} zone @returns {number} pixels */
function extent(camera, zone) {
  return Math.max(zone.box[2] - zone.box[0], zone.box[3] - zone.box[1]) * camera.scale;
}

/** @param {Context} context @param {Camera} camera @param {import("./model.js").Zone[]} zones */
export function drawZones(context, camera, zones) {
  const { window } = camera;
  context.lineWidth = camera.pixel;
  context.lineJoin = "round";
  for (const zone of zones) {
    if (!meet(zone.box, window)) continue;
    const { area, line } = shade(zone.number);
    const size = extent(camera, zone);
    const path = size < SMALL ? zone.coarse : zone.path;
    context.fillStyle = area;
    context.fill(path, "evenodd");
    if (size < 6) continue;
    context.strokeStyle = line;
    context.globalAlpha = 0.55;
    context.stroke(path);
    context.globalAlpha = 1;
  }
}

/** @param {Context} context @param {Camera} camera @param {any[]} doorways @param {number} seq those found by this step */
export function drawDoorways(context, camera, doorways, seq) {
  context.fillStyle = colour("passage-soft");
  for (const { since, box, path } of doorways) {
    if (since <= seq && meet(box, camera.window)) context.fill(path, "evenodd");
  }
}

/**
 * Walls, passages and frontiers. A frontier that is no longer than a few pixels is a gap between two
 * beams, and nothing that could be told from the wall around it: it is left out until one looks nearer.
 * @param {Context} context @param {Camera} camera @param {import("./model.js").Zone[]} zones @param {import("./walls.js").Walls} walls
 */
export function drawBorders(context, camera, zones, walls) {
  const { pixel, window } = camera;
  const thin = Math.min(Math.max(camera.scale / 30, 0.5), 1); // lines of what is small
  const seen = zones.filter((zone) => extent(camera, zone) > DETAIL && meet(zone.box, window));
  const borders = seen.map((zone) => walls.of(zone)).filter((one) => one !== undefined);
  context.lineCap = "round";
  context.lineJoin = "round";
  context.lineWidth = 1.75 * thin * pixel;
  context.strokeStyle = colour("frontier");
  context.setLineDash([5 * pixel, 4 * pixel]);
  for (const { free } of borders) {
    for (const [length, path] of free) if (length * camera.scale > FRONTIER) context.stroke(path);
  }
  context.setLineDash([]);
  context.lineWidth = 2 * thin * pixel;
  context.strokeStyle = colour("wall");
  for (const { obstacle } of borders) context.stroke(obstacle);
  context.lineWidth = 3 * thin * pixel;
  context.strokeStyle = colour("passage");
  for (const { passage } of borders) context.stroke(passage);
}

/** @param {Context} context @param {Camera} camera @param {[number, number, number][]} poses @param {number} first @param {number} count up to this step */
export function drawTrail(context, camera, poses, first, count) {
  context.beginPath();
  let pen = false;
  let last = [Infinity, Infinity];
  const least = 1.5 * camera.pixel; // nearer points would not show
  for (let n = first; n < count; n += 1) {
    const pose = poses[n];
    if (!pose) { pen = false; continue; }
    if (pen && n < count - 1 && Math.abs(pose[0] - last[0]) + Math.abs(pose[1] - last[1]) < least) continue;
    if (pen) context.lineTo(pose[0], pose[1]);
    else context.moveTo(pose[0], pose[1]);
    pen = true;
    last = pose;
  }
  context.lineWidth = 1.5 * camera.pixel;
  context.strokeStyle = colour("trail");
  context.lineCap = "butt";
  context.lineJoin = "bevel";
  if (count < 2_000) context.setLineDash([2 * camera.pixel, 3 * camera.pixel]); // dashes take long
  context.stroke();
  context.setLineDash([]);
}

/** @param {Context} context @param {Camera} camera @param {any} sight */
export function drawBeams(context, camera, sight) {
  const { x, y } = sight.pose;
  context.fillStyle = colour("beam");
  context.strokeStyle = colour("beam");
  context.lineWidth = camera.pixel;
  context.globalAlpha = sight.ends.length > 200 ? 0.12 : 0.3;
  context.beginPath();
  for (const end of sight.ends) {
    context.moveTo(x, y);
    context.lineTo(end[0], end[1]);
  }
  context.stroke();
  context.globalAlpha = 0.9;
  const r = 1.6 * camera.pixel;
  for (const end of sight.ends) context.fillRect(end[0] - r, end[1] - r, 2 * r, 2 * r);
  context.globalAlpha = 1;
}

/** @param {Context} context @param {Camera} camera @param {[number, number, number]} pose */
export function drawRobot(context, camera, [x, y, theta]) {
  const size = 9 * camera.pixel;
  context.save();
  context.translate(x, y);
  context.rotate(theta);
  context.beginPath();
  context.arc(0, 0, size, 0, 2 * Math.PI);
  context.fillStyle = colour("robot");
  context.fill();
  context.lineWidth = 2.5 * camera.pixel;
  context.strokeStyle = colour("halo");
  context.stroke();
  context.beginPath();
  context.moveTo(size * 0.7, 0);
  context.lineTo(-size * 0.35, size * 0.5);
  context.lineTo(-size * 0.35, -size * 0.5);
  context.closePath();
  context.fillStyle = colour("halo");
  context.fill();
  context.restore();
}

/** @param {Context} context @param {Camera} camera @param {[number, number][]} points @param {string} stroke @param {number} width */
function drawLine(context, camera, points, stroke, width) {
  context.beginPath();
  points.forEach(([x, y], n) => (n === 0 ? context.moveTo(x, y) : context.lineTo(x, y)));
  context.lineCap = "round";
  context.lineJoin = "round";
  context.lineWidth = (width + 3) * camera.pixel;
  context.strokeStyle = colour("halo");
  context.stroke();
  context.lineWidth = width * camera.pixel;
  context.strokeStyle = stroke;
  context.stroke();
}

/** @param {Context} context @param {Camera} camera @param {[number, number]} point @param {{fill: string, closed?: boolean, large?: boolean}} look */
export function drawPoint(context, camera, [x, y], { fill, closed = false, large = false }) {
  const r = (large ? 7 : Math.min(4.5, Math.max(2, 0.13 * camera.scale))) * camera.pixel;
  context.beginPath();
  context.arc(x, y, r, 0, 2 * Math.PI);
  context.fillStyle = fill;
  context.fill();
  context.lineWidth = (large ? 2 : Math.min(2, 0.045 * camera.scale)) * camera.pixel;
  context.strokeStyle = colour("halo");
  context.stroke();
  if (!closed) return;
  context.beginPath();
  context.moveTo(x - r, y - r);
  context.lineTo(x + r, y + r);
  context.moveTo(x - r, y + r);
  context.lineTo(x + r, y - r);
  context.lineWidth = 2.5 * camera.pixel;
  context.strokeStyle = colour("bad");
  context.stroke();
}

/** @param {Context} context @param {Camera} camera @param {[number, number]} point @param {string} stroke */
function drawRing(context, camera, [x, y], stroke) {
  context.beginPath();
  context.arc(x, y, 11 * camera.pixel, 0, 2 * Math.PI);
  context.lineWidth = 7 * camera.pixel;
  context.strokeStyle = colour("halo");
  context.stroke();
  context.lineWidth = 3.5 * camera.pixel;
  context.strokeStyle = stroke;
  context.stroke();
}

/** @param {Context} context @param {Camera} camera @param {import("./ask.js").Answer} answer */
export function drawAnswer(context, camera, answer) {
  for (const line of answer.lines) drawLine(context, camera, line, colour("route"), 3.5);
  for (const point of answer.points) drawPoint(context, camera, point, { fill: colour("route"), large: true });
  context.setLineDash([8 * camera.pixel, 6 * camera.pixel]);
  for (const line of answer.missing) drawLine(context, camera, line, colour("bad"), 2.5);
  context.setLineDash([]);
  for (const point of answer.frontiers) drawRing(context, camera, point, colour("frontier"));
}
