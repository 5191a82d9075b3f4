// @ts-check A voting card: a phone shows one letter, in a colour and a shape that can be distinguished from the last
// row. It needs no network.

import { wantedLanguage, wordsOf } from "./{{asset:words.js}}";

/** Letters with their colours, the ink on them, and their shapes. */
const CARDS = /** @type {const} */ ([
  ["A", "#0b57d0", "#ffffff", "circle"],
  ["B", "#f5a300", "#000000", "square"],
  ["C", "#0a7d33", "#ffffff", "triangle"],
  ["D", "#d81b60", "#ffffff", "diamond"],
  ["E", "#6b2fb3", "#ffffff", "hexagon"],
  ["F", "#ffffff", "#000000", "cross"],
]);

/** @param {readonly [string, string, string, string]} card @param {string} name @param {() => void} onclick */
function button([letter, color, ink, shape], name, onclick) {
  const made = document.createElement("button");
  made.type = "button";
  made.className = "vote";
  made.dataset.shape = shape;
  made.style.setProperty("--card", color);
  made.style.setProperty("--ink", ink);
  made.setAttribute("aria-label", `${letter}, ${name}`);

  const mark = document.createElement("span");
  mark.textContent = letter;
  made.append(mark);

  made.addEventListener("click", onclick);
  return made;
}

/** Shows the card instead of the program. @param {string} [linked] The language of the link. */
export async function showCard(linked) {
  const language = wantedLanguage(linked);
  const words = await wordsOf(language);
  document.documentElement.lang = language;
  document.title = `${words("Voting card")} \u2013 Tilescope`;

  const main = document.querySelector("main");
  const sheet = document.createElement("section");
  sheet.id = "card";
  sheet.setAttribute("aria-label", words("Voting card"));
  main?.replaceChildren(sheet);

  const choose = () => {
    sheet.classList.remove("shown");
    const said = document.createElement("p");
    said.textContent = words("Tap your answer and hold the phone up.");
    const grid = document.createElement("div");
    grid.append(...CARDS.map((card) => button(card, words(card[3]), () => show(card))));
    sheet.replaceChildren(said, grid);
  };

  /** @param {readonly [string, string, string, string]} card */
  const show = (card) => {
    sheet.classList.add("shown");
    sheet.replaceChildren(button(card, words(card[3]), choose));
    sheet.querySelector("button")?.focus();
    // Where the browser has no full screen, as on some phones, the card fills the page.
    document.documentElement.requestFullscreen?.().catch(() => {});
  };

  choose();
}
