/** Binds an object's methods to it, so that they can be handed on alone. @param {any} object */
export function bindMethods(object) {
  for (const name of Object.getOwnPropertyNames(Object.getPrototypeOf(object)))
    if (name !== 'constructor' && typeof object[name] === 'function') object[name] = object[name].bind(object);
}
