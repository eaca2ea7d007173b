// The dark or light theme, which is the system's until the user chooses one.

const KEY = 'item3d.theme';

export function applyTheme() {
  const chosen = read();
  if (chosen) document.documentElement.dataset.theme = chosen;
}

export function switchTheme() {
  const dark = document.documentElement.dataset.theme ?? (matchMedia('(prefers-color-scheme: dark)').matches ? 'dark' : 'light');
  const next = dark === 'dark' ? 'light' : 'dark';
  document.documentElement.dataset.theme = next;
  try {
    localStorage.setItem(KEY, next);
  } catch { /* storage is off: the choice lasts until the page is left */ }
}

function read() {
  try {
    return localStorage.getItem(KEY);
  } catch {
    return null;
  }
}
