/** The keyboard. */

/** Actions by key, as in KeyboardEvent.key (letters in lower case; "Shift+ArrowLeft" with shift). */
export type Keys = Record<string, () => void>;

export function listen(keys: Keys): void {
  window.addEventListener("keydown", (event) => {
    if (event.ctrlKey || event.metaKey || event.altKey) return;
    if (event.target instanceof HTMLSelectElement) return;
    const name = event.key.length === 1 ? event.key.toLowerCase() : event.key;
    const action = (event.shiftKey && keys[`Shift+${name}`]) || keys[name];
    if (!action) return;
    event.preventDefault();
    action();
  });
}
