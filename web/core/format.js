// Texts of numbers and times.

/** @param {number} seconds */
export function duration(seconds) {
  if (!(seconds >= 0)) return '';
  if (seconds < 90) return `${Math.round(seconds)} s`;
  const rest = (/** @type {number} */ part) => String(Math.floor(part)).padStart(2, '0');
  if (seconds < 3600) return `${Math.floor(seconds / 60)}:${rest(seconds % 60)} min`;
  return `${Math.floor(seconds / 3600)}:${rest(seconds % 3600 / 60)} h`;
}

/** Returns a message that names files as the user does, without the server's folders. @param {string} message @param {string} uploaded name of the uploaded file, which the server reads under another name */
export function withoutFolders(message, uploaded) {
  return message.replace(/(?:[^\s'"]*\/)?incoming\/[^\s:]+/g, uploaded).replace(/(?:[^\s'"]*\/)?projects\/\d+(?:\/source)?\//g, '');
}

/** @param {number} bytes */
export function size(bytes) {
  if (bytes < 1e6) return `${Math.max(1, Math.round(bytes / 1e3))} KB`;
  if (bytes < 1e9) return `${(bytes / 1e6).toFixed(bytes < 1e7 ? 1 : 0)} MB`;
  return `${(bytes / 1e9).toFixed(1)} GB`;
}

/** @param {string} time ISO 8601 */
export function when(time) {
  const then = new Date(time);
  if (Number.isNaN(then.getTime())) return '';
  const today = new Date().toDateString() === then.toDateString();
  return then.toLocaleString(undefined, { ...(today ? {} : { day: 'numeric', month: 'short' }), hour: '2-digit', minute: '2-digit', hourCycle: 'h23' });
}

/** @param {number} value @param {number} digits */
export function signed(value, digits) {
  return `${value > 0 ? '+' : value < 0 ? '−' : ''}${Math.abs(value).toFixed(digits)}`;
}
