// Saves pictures and tables of a panel as files.

import { html, color } from "bsm/draw";

/** Offers a file for download. */
export function download(name, blob) {
  const address = URL.createObjectURL(blob);
  html("a", { href: address, download: name }).click();
  setTimeout(() => URL.revokeObjectURL(address), 10_000);
}

const STYLES = [
  "fill",
  "fill-opacity",
  "stroke",
  "stroke-width",
  "stroke-dasharray",
  "stroke-linecap",
  "opacity",
  "font-family",
  "font-size",
  "font-weight",
  "text-anchor",
  "paint-order",
];

/**
 * Returns a copy of a picture that needs no style sheet. `below` is the canvas behind the picture, such as
 * the colors of a map.
 */
function alone(drawing, below) {
  const copy = drawing.cloneNode(true);
  const to = [copy, ...copy.querySelectorAll("*")];
  [drawing, ...drawing.querySelectorAll("*")].forEach((element, i) => {
    const style = getComputedStyle(element);
    if (style.display === "none") {
      to[i].setAttribute("visibility", "hidden");
      return;
    }
    to[i].setAttribute("style", STYLES.map((name) => `${name}:${style.getPropertyValue(name)}`).join(";"));
  });
  const { width, height } = drawing.viewBox.baseVal;
  const add = (tag, attributes) => {
    const element = document.createElementNS("http://www.w3.org/2000/svg", tag);
    for (const [name, value] of Object.entries({ x: 0, y: 0, width, height, ...attributes }))
      element.setAttribute(name, value);
    copy.prepend(element);
  };
  if (below) add("image", { href: below.toDataURL(), preserveAspectRatio: "none" });
  add("rect", { fill: color("panel") });
  copy.setAttribute("width", width);
  copy.setAttribute("height", height);
  copy.removeAttribute("tabindex");
  return [new XMLSerializer().serializeToString(copy), width, height];
}

const png = (canvas) => new Promise((then) => canvas.toBlob(then));

/** Converts a drawing to pixels, with three pixels per unit. */
async function raster([text, width, height]) {
  const image = new Image();
  const canvas = html("canvas", { width: 3 * width, height: 3 * height });
  image.src = `data:image/svg+xml;charset=utf-8,${encodeURIComponent(text)}`;
  await image.decode();
  canvas.getContext("2d").drawImage(image, 0, 0, canvas.width, canvas.height);
  return png(canvas);
}

const quoted = (words) => (/[",\n]/.test(words) ? `"${words.replaceAll('"', '""')}"` : words);
const csv = (rows) =>
  `${rows.map((row) => row.map((cell) => quoted(String(cell ?? ""))).join(",")).join("\r\n")}\r\n`;
const cells = (table) => [...table.rows].map((row) => [...row.cells].map((cell) => cell.textContent.trim()));

const named = (words) =>
  words
    .toLowerCase()
    .replace(/[^a-z0-9]+/g, "-")
    .replace(/^-|-$/g, "")
    .slice(0, 60);

/** Returns the files of a panel: names, extensions, and functions that create their content. */
function files(panel) {
  const title = panel.querySelector("h2").textContent;
  const list = [];
  const name = (element, usual) =>
    named(`${title} ${element.closest("figure")?.querySelector("figcaption strong")?.textContent ?? usual}`);
  for (const drawing of panel.querySelectorAll("svg[viewBox]")) {
    const below = drawing.previousElementSibling?.matches("canvas") ? drawing.previousElementSibling : null;
    list.push(
      [`${name(drawing, "")}.svg`, () => new Blob([alone(drawing, below)[0]], { type: "image/svg+xml" })],
      [`${name(drawing, "")}.png`, () => raster(alone(drawing, below))],
    );
  }
  for (const canvas of panel.querySelectorAll("canvas")) {
    if (canvas.width && canvas.height && !canvas.nextElementSibling?.matches("svg"))
      list.push([`${name(canvas, "")}.png`, () => png(canvas)]);
  }
  for (const table of panel.querySelectorAll("table")) {
    list.push([
      `${named(`${title} ${table.caption?.textContent ?? ""}`)}.csv`,
      () => new Blob([csv(cells(table))], { type: "text/csv" }),
    ]);
  }
  // After the pictures, the tables with their data are added.
  for (const [words, columns] of Object.entries(panel.querySelector("h2 ~ div[id]").columns?.() ?? {})) {
    const heads = Object.keys(columns);
    list.push([
      `${named(`${title} ${words}`)}.csv`,
      () =>
        new Blob([csv([heads, ...columns[heads[0]].map((_, i) => heads.map((head) => columns[head][i]))])], {
          type: "text/csv",
        }),
    ]);
  }
  return list;
}

/** Creates a collapsible menu in the heading of a panel, with a button for each file. */
export function offer(panel) {
  const list = html("div", { class: "bar" });
  const title = panel.querySelector("h2");
  const fold = html(
    "details",
    { class: "keep" },
    html("summary", { "aria-label": `Save: ${title.textContent}` }, "Save"),
    list,
  );
  fold.addEventListener("toggle", () => {
    if (!fold.open) return;
    const found = files(panel);
    list.replaceChildren(
      ...(found.length
        ? found.map(([name, make]) =>
            html("button", { type: "button", onclick: async () => download(name, await make()) }, name),
          )
        : [html("span", { class: "small faint" }, "Nothing to save yet.")]),
    );
  });
  title.after(fold);
}
