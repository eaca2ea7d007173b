// Names of selectors and of their errors. The page shows these names, with the selector as their tooltip.
import { text } from '../text.js';

/** Splits a selector into its kind and value, such as "sphere" and "0,0,0,1". @param {string} selector */
function partsOf(selector) {
  const at = selector.indexOf('=');
  return at < 0 ? { kind: selector, value: '' } : { kind: selector.slice(0, at), value: selector.slice(at + 1) };
}

/** Returns a selector's name, such as “painted area on glaze”. @param {string} selector */
export function selectorName(selector) {
  const { kind, value } = partsOf(selector);
  const name = text.region.names[/** @type {keyof typeof text.region.names} */ (kind)];
  return name ? name(kind === 'mask' ? value.match(/@(.*)$/)?.[1] ?? '' : value) : selector;
}

/** Returns the colour that a selector names, or ''. @param {string} selector */
export function selectorColor(selector) {
  const { kind, value } = partsOf(selector);
  return kind === 'color' && /^#[0-9a-f]{6}$/i.test(value) ? value : '';
}

/**
 * Returns the selector that an error of the server is about, and the error in the page's words.
 * @param {string} message such as "words=the spout: nothing was found on the model; ..." @param {string[]} selectors of the region
 */
export function regionProblem(message, selectors) {
  const wrong = selectors.find((selector) => message.startsWith(`${selector}: `)) ?? '';
  const said = message.slice(wrong ? wrong.length + 2 : 0).split('; ')[0];
  const { cannotFind, outside, sameEverywhere } = text.region;
  if (wrong === 'auto' && said.includes('about the same everywhere')) return { wrong, said: sameEverywhere };
  if (wrong && /^nothing /.test(said)) return { wrong, said: cannotFind(selectorName(wrong)) };
  if (wrong && /outside the model/.test(said)) return { wrong, said: outside(selectorName(wrong)) };
  return { wrong, said: wrong ? `${selectorName(wrong)}: ${said}.` : said };
}
