/** Colours for canvases: those of the theme, and one for each zone, as in the printed maps. */

import { isDark, onTheme } from "./theme.js";

const GOLDEN = 0.381966; // of a full turn: neighbours in order are far apart
const FIRST = 0.58; // blue, for the zone found first

/** @type {Map<string, string>} */
const known = new Map();
onTheme(() => known.clear());

/** @param {string} name of a custom property in base.css, without its dashes */
export function colour(name) {
  let value = known.get(name);
  if (value === undefined) {
    value = getComputedStyle(document.documentElement).getPropertyValue(`--${name}`).trim();
    known.set(name, value);
  }
  return value;
}

/**
 * @param {number} number of the zone, in order of finding
 * @returns {{area: string, line: string, text: string}}
 */
export function shade(number) {
  const hue = Math.round((((FIRST + number * GOLDEN) % 1) * 360 + 360) % 360);
  const tier = Math.floor(number / 8) % 3; // hues draw near each other after eight
  if (isDark()) {
    const light = [25, 30, 21][tier];
    return { area: `hsl(${hue} 34% ${light}%)`, line: `hsl(${hue} 48% 64%)`, text: `hsl(${hue} 45% 84%)` };
  }
  const light = [86, 80, 90][tier];
  return { area: `hsl(${hue} 62% ${light}%)`, line: `hsl(${hue} 45% 38%)`, text: `hsl(${hue} 50% 22%)` };
}
