// Requests to the server. Addresses are relative, so that the page works behind a prefix and a tunnel.

import { withoutFolders } from './format.js';
import { text } from '../text.js';

const RECONNECT = 2000; // milliseconds
const FORBIDDEN = 403;

/** An error that the server answered. `hint` says what to try. */
export class ApiError extends Error {
  /** @param {string} message @param {string} hint @param {number} status */
  constructor(message, hint, status) {
    super(message);
    this.hint = hint;
    this.status = status;
  }
}

/**
 * Sends a request.
 * @param {string} path
 * @param {{method?: string, json?: any, body?: BodyInit, signal?: AbortSignal}} [options]
 * @returns {Promise<any>} the answer's JSON
 */
export async function api(path, { method, json, body, signal } = {}) {
  const response = await fetch(`api/${path}`, {
    method: method ?? (json !== undefined || body !== undefined ? 'POST' : 'GET'),
    body: json !== undefined ? JSON.stringify(json) : body,
    headers: json !== undefined ? { 'Content-Type': 'application/json' } : body instanceof FormData || body === undefined ? {} : { 'Content-Type': 'application/octet-stream' },
    signal,
  }).catch((error) => {
    throw error.name === 'AbortError' ? error : new ApiError(text.unreachable, text.unreachableHint, 0);
  });
  const answer = await response.json().catch(() => null);
  if (response.status === FORBIDDEN && answer === null) throw new ApiError(text.forbidden, text.forbiddenHint, FORBIDDEN);
  if (!response.ok) throw new ApiError(withoutFolders(answer?.error ?? `${response.status} ${response.statusText}`, body instanceof File ? body.name : ''), answer?.hint ?? '', response.status);
  return answer;
}

/** Returns an identifier as the number that the server uses. @param {string|null} id */
export function asNumber(id) {
  return id === null ? null : Number(id);
}

/** Returns a result whose identifiers are strings, as everywhere on the page. @param {any} result @returns {import('./types.js').Result} */
export function asResult(result) {
  const { id, project, parent } = result;
  return { ...result, id: String(id), project: String(project), parent: parent === null || parent === undefined ? null : String(parent) };
}

/** @param {string} result @param {string} name */
export function fileUrl(result, name) {
  return `api/results/${encodeURIComponent(result)}/files/${name.split('/').map(encodeURIComponent).join('/')}`;
}

/**
 * Listens to the server's events. The browser reconnects by itself. `lost` and `back` are called when the connection is lost and restored,
 * `refused` when the server answers but does not know this browser, because it was started again.
 * @param {{result: (data: any) => void, removed: (id: string) => void, project: (project: any) => void, preview: (data: any) => void, reset: () => void, lost: () => void, refused: () => void, back: () => void}} on
 */
export function listen(on) {
  let broken = false;
  /** @type {EventSource} */
  let source;
  const connect = () => {
    source = new EventSource('api/events');
    source.addEventListener('result', (event) => on.result(asResult(JSON.parse(event.data))));
    source.addEventListener('removed', (event) => on.removed(String(JSON.parse(event.data).id)));
    source.addEventListener('preview', (event) => {
      const data = JSON.parse(event.data);
      on.preview({ ...data, id: String(data.id) });
    });
    source.addEventListener('project', (event) => on.project(JSON.parse(event.data)));
    source.addEventListener('reset', () => on.reset());
    source.onopen = () => {
      if (broken) on.back();
      broken = false;
    };
    source.onerror = () => {
      if (!broken) on.lost();
      broken = true;
      if (source.readyState !== EventSource.CLOSED) return;
      setTimeout(connect, RECONNECT);
      api('projects?limit=1').catch(({ status }) => { if (status === FORBIDDEN) on.refused(); });
    };
  };
  connect();
}
