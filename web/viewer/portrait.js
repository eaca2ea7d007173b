// Thumbnail of the source: taken from the stage when it first shows the source alone, in the usual light.

const EDGE = 96; // pixels

/** @param {import('./viewer.js').Viewer} viewer @param {import('../core/store.js').Store} store */
export function takePortraits(viewer, store) {
  const { stage } = viewer;
  const canvas = document.createElement('canvas');
  canvas.width = canvas.height = EDGE;
  const context = /** @type {CanvasRenderingContext2D} */ (canvas.getContext('2d'));
  stage.addEventListener('drawn', () => { // the drawing can be read only now
    const { project, portrait, selected, layout, view, wires, tool, tab, light } = store.state;
    const plain = !selected && layout === 'single' && view === 'shaded' && !wires && tool === 'orbit' && tab === 'edit' && light.name === 'studio' && light.exposure === 0;
    if (!plain || !project || portrait?.project === project.id || viewer.project !== project.id || !stage.shown.length || viewer.lighting || !viewer.light) return;
    const { width, height } = stage.canvas, edge = Math.min(width, height);
    context.clearRect(0, 0, EDGE, EDGE);
    context.drawImage(stage.canvas, (width - edge) / 2, (height - edge) / 2, edge, edge, 0, 0, EDGE, EDGE);
    store.set({ portrait: { project: project.id, image: canvas.toDataURL() } });
  });
}
