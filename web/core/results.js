// What a result is: its name, what it began with, and the sentence that describes its model.
import { text } from '../text.js';

/** @typedef {import('./types.js').Result} Result */

/** Returns the name that lists show. A light without a sentence is named after its preset. @param {Result} result */
export function nameOf(result) {
  return result.name || result.to || (result.kind === 'relight' ? lightName(result.request) : text.kinds[result.kind]);
}

/** @param {Record<string, any>} request  of a relight */
function lightName({ light, hour, lit, sun, tint }) {
  const name = typeof hour === 'number' ? text.light.skyAt(hour) : !light || light.startsWith('result-') ? '' : light;
  return text.light.named([name, lit || (sun && text.light.sunAt(Math.round(sun[0]), Math.round(sun[1]))), tint].filter(Boolean).join(', '));
}

/** Returns true if the result began with another result that was deleted. @param {Result} result */
export function lostParent({ parent, request }) {
  return parent === null && typeof request?.parent === 'number';
}

/**
 * Returns the edit whose result another edit begins with if `selected` is chosen, or undefined for the source. A relight does not change the model, so its parent counts.
 * @param {Result[]} results @param {string} selected
 */
export function startOf(results, selected) {
  const result = results.find(({ id }) => id === selected);
  const start = result?.kind === 'relight' ? results.find(({ id }) => id === result.parent) : result;
  return start?.state === 'done' && start.kind === 'edit' ? start : undefined;
}

/** Returns the sentence that describes a result, or '' if it is unknown. The source has that of its first edit. An edit of a part does not change what the whole is. @param {Result[]} results @param {string} id '': the source */
export function sentenceOf(results, id) {
  const result = results.find((other) => other.id === id);
  const part = result?.request?.region?.some((selector) => selector !== 'auto') || result?.request?.exclude?.length;
  if (result) return part ? result.from : result.to;
  return results.find((other) => other.kind === 'edit' && other.parent === null && !lostParent(other))?.from ?? '';
}
