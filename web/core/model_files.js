// The files of a model that the user chose or dropped, with their places in its folder.

/** @typedef {{file: File, place: string}} ModelFile  place: path relative to the folder, with '/' */

/** Files of a file chooser. @param {FileList} list @returns {ModelFile[]} */
export function chosenFiles(list) {
  return [...list].map((file) => ({ file, place: file.webkitRelativePath || file.name }));
}

/** @param {any} entry a file or folder of a drop @param {string} folder @returns {Promise<ModelFile[]>} */
async function filesOf(entry, folder) {
  if (entry.isFile) return [{ file: await new Promise((resolve, reject) => entry.file(resolve, reject)), place: folder + entry.name }];
  const reader = entry.createReader(), all = [];
  for (;;) { // the browser lists a folder in parts
    const part = await new Promise((resolve, reject) => reader.readEntries(resolve, reject));
    if (!part.length) return all.flat();
    for (const one of part) all.push(await filesOf(one, `${folder}${entry.name}/`));
  }
}

/** Files of a drop, with those in dropped folders. @param {DataTransfer} drop @returns {Promise<ModelFile[]>} */
export async function droppedFiles(drop) {
  const entries = [...drop.items].map((item) => item.webkitGetAsEntry?.()).filter(Boolean); // valid only before the first await
  if (!entries.some((entry) => entry?.isDirectory)) return chosenFiles(drop.files);
  return (await Promise.all(entries.map((entry) => filesOf(entry, '')))).flat();
}
