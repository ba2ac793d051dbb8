/** Small helpers for building the page. */

type Child = Node | string;
type Attributes = Record<string, string | ((event: Event) => void)>;

/** An element: attributes that are functions become event listeners. */
export function h<K extends keyof HTMLElementTagNameMap>(
  tag: K, attributes: Attributes = {}, ...children: Child[]
): HTMLElementTagNameMap[K] {
  const element = document.createElement(tag);
  for (const [name, value] of Object.entries(attributes)) {
    if (typeof value === "function") element.addEventListener(name, value);
    else element.setAttribute(name, value);
  }
  element.append(...children);
  return element;
}

const paths = {
  play: "M8 5.5v13l11-6.5z",
  pause: "M7 5.5h3.6v13H7zM13.4 5.5H17v13h-3.6z",
  back: "M6 6h2.2v12H6zM18 6v12l-8.5-6z",
  forward: "M15.8 6H18v12h-2.2zM6 6l8.5 6L6 18z",
  loop: "M7 7h9V4l4.5 4.5L16 13v-3H9.5v3H7zm10 10H8v3l-4.5-4.5L8 11v3h6.5v-3H17z",
  camera:
    "M9 4 7.4 6H4a1.5 1.5 0 0 0-1.5 1.5v10A1.5 1.5 0 0 0 4 19h16a1.5 1.5 0 0 0 1.5-1.5v-10A1.5 1.5 0 0 0 20 6h-3.4L15 4zm3 4a4.4 4.4 0 1 1 0 8.8A4.4 4.4 0 0 1 12 8zm0 2a2.4 2.4 0 1 0 0 4.8 2.4 2.4 0 0 0 0-4.8z",
  theme: "M12 3a9 9 0 1 0 0 18 9 9 0 0 0 0-18zm0 2.2v13.6a6.8 6.8 0 0 1 0-13.6z",
  charts: "M4 4h2v14h14v2H4zm4.5 10.5 3-4 2.6 2.4L18.5 7l1.5 1.2-5.6 7.2-2.6-2.3-1.7 2.4z",
  sliders: "M4 7h9a3 3 0 0 1 5.8 0H21v2h-2.2A3 3 0 0 1 13 9H4zm0 8h2.2a3 3 0 0 1 5.8 0h9v2h-9a3 3 0 0 1-5.8 0H4z",
  frame: "M4 9V4h5v2H6v3zm11-5h5v5h-2V6h-3zM4 15h2v3h3v2H4zm14 0h2v5h-5v-2h3z",
  help: "M12 3a9 9 0 1 1 0 18 9 9 0 0 1 0-18zm-1 13v2.2h2.2V16zm1-10.2c-2 0-3.6 1.3-3.7 3.3h2.1c.1-.9.7-1.4 1.6-1.4s1.5.5 1.5 1.3c0 .8-.5 1.2-1.2 1.7-.9.6-1.4 1.2-1.3 2.6v.3h2.1v-.3c0-.8.4-1.1 1.2-1.7.8-.6 1.4-1.3 1.4-2.6 0-2-1.6-3.2-3.7-3.2z",
  close: "m6.4 5 5.6 5.6L17.6 5 19 6.4 13.4 12l5.6 5.6-1.4 1.4-5.6-5.6L6.4 19 5 17.6l5.6-5.6L5 6.4z",
} as const;
export type Icon = keyof typeof paths;

export function icon(name: Icon): SVGSVGElement {
  const svg = document.createElementNS("http://www.w3.org/2000/svg", "svg");
  svg.setAttribute("viewBox", "0 0 24 24");
  const path = document.createElementNS("http://www.w3.org/2000/svg", "path");
  path.setAttribute("d", paths[name]);
  svg.append(path);
  return svg;
}

/** A round button with an icon; `title` is its tooltip and its name for screen readers. */
export function iconButton(name: Icon, title: string, click: () => void): HTMLButtonElement {
  const button = h("button", { class: "icon", title, "aria-label": title, type: "button", click });
  button.append(icon(name));
  return button;
}

/** A number with about four digits, short at every size. */
export function format(value: number): string {
  if (!Number.isFinite(value)) return "–";
  const size = Math.abs(value);
  if (size === 0) return "0";
  if (size >= 1e5 || size < 1e-3) return value.toExponential(2).replace("e+", "e").replace("-", "−");
  if (Number.isInteger(value)) return String(value).replace("-", "−");
  const digits = size >= 1000 ? 0 : size >= 100 ? 1 : size >= 10 ? 2 : 3;
  return value.toFixed(digits).replace("-", "−");
}

/** A tick of an axis: no digits that say nothing. */
export function formatTick(value: number): string {
  const size = Math.abs(value);
  const text = size !== 0 && (size >= 1e5 || size < 1e-3) ? value.toExponential() : String(Number(value.toPrecision(4)));
  return text.replace("e+", "e").replaceAll("-", "−");
}
