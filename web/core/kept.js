// Settings of the edit form, kept for each project in this tab, so that a reload does not lose them.

const key = (/** @type {string} */ project) => `item3d.settings.${project}`;

/** @param {string} project @param {Record<string, any>} settings */
export function keepSettings(project, settings) {
  try {
    sessionStorage.setItem(key(project), JSON.stringify(settings));
  } catch { /* storage is off: the settings last until the page is left */ }
}

/** @param {string} project @returns {Record<string, any>} */
export function keptSettings(project) {
  try {
    return JSON.parse(sessionStorage.getItem(key(project)) ?? '{}');
  } catch {
    return {};
  }
}
