// Types of the server's answers and of the page's state.

/**
 * @typedef {'waiting'|'running'|'paused'|'done'|'failed'|'cancelled'} ResultState
 *
 * @typedef {object} Result
 * @property {string} id
 * @property {string} project
 * @property {string|null} parent  the result whose model was edited; null: the project's own model
 * @property {'edit'|'relight'|'reconstruct'} kind
 * @property {string} from
 * @property {string} to
 * @property {string} [name]
 * @property {Record<string, any>} settings
 * @property {string[]} region
 * @property {{region?: string[], exclude?: string[], feather?: number} & Record<string, any>} request  the request as the page sent it
 * @property {string} command
 * @property {ResultState} state
 * @property {{stage: string, done: number, total: number, seconds: number, seconds_left: number, job_seconds_left?: number, share?: number}} [progress]  edits have the last two, which cover all stages
 * @property {string} message
 * @property {string} created
 * @property {number} seconds
 * @property {Record<string, any>} [scores]
 * @property {boolean} favourite
 * @property {string} note
 * @property {string} [thumbnail]
 * @property {string[]} files
 *
 * @typedef {object} Project
 * @property {string} id
 * @property {string} name
 * @property {{url: string, format: string, triangles: number, materials: {index: number, name: string}[], nodes: any[], has_uv: boolean, warnings?: string[]}|null} model  null: photographs that are not reconstructed yet
 * @property {Result[]} results
 *
 * @typedef {object} Setting
 * @property {string} name
 * @property {string} flag
 * @property {string} type
 * @property {any} default
 * @property {string[]} [choices]  values of a setting of type "choice"
 * @property {number} [minimum]
 * @property {number} [maximum]
 * @property {string} values  the allowed values in words: "integer: 1 or more", "choice: a, b or c"
 * @property {boolean} [path]  true: names a file on the server, so the page leaves it out
 * @property {string} help
 * @property {string} [group]
 *
 * A word that the prior was measured on. In its caption, {o} stands for the object. The base colour is linear.
 * @typedef {{word: string, spellings: string[], caption: string, base_color: number[]|null, accuracy: number}} Word
 *
 * @typedef {object} About
 * @property {string} version
 * @property {{name: string, hash?: string}} prior
 * @property {{colors: Word[], materials: Word[], patterns: Word[], objects: Word[], lights: Word[], all?: string[], parts?: string[]}} words
 * @property {Setting[]} settings
 * @property {string[]} lights
 *
 * @typedef {{include: string[], exclude: string[], feather: number}} Region
 * @typedef {{id: string, on: boolean, strength: number, channels: string[]}} Layer
 * @typedef {{name: string, rotation: number, exposure: number, backdrop: boolean, sun: [number, number]|null, hour: number|null, lit: string, tint: string}} Light
 *
 * @typedef {object} State
 * @property {About|null} about
 * @property {Project|null} project
 * @property {Result[]} results  of the project, oldest first
 * @property {string} selected  id of a result; '': the source
 * @property {'single'|'wipe'|'side'} layout
 * @property {string[]} side  ids of the results that are shown side by side; '': the source
 * @property {string} view
 * @property {boolean} wires
 * @property {boolean} turning
 * @property {'orbit'|'part'|'brush'|'box'} tool
 * @property {'edit'|'layers'|'light'|'result'} tab
 * @property {string} from
 * @property {string} to
 * @property {Record<string, any>} settings  the settings that differ from the defaults
 * @property {Region} region
 * @property {Layer[]} layers
 * @property {Light} light
 * @property {boolean} connected
 * @property {string} busy  what the viewer waits for, or ''
 */

export {};
