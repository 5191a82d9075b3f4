// @ts-check The texts of pages without the program, the voting card and the notes of a talk, in the languages of lessons. The
// tables are the program's own, `assets/words`; one is loaded when its language is first wanted.

/** The addresses of the tables, by language. @type {Record<string, string>} */
const TABLES = {
  de: new URL("./{{asset:de.txt}}", import.meta.url).href,
  es: new URL("./{{asset:es.txt}}", import.meta.url).href,
};
/** The key of the language of lessons in the browser's store, as in `web/app/src/page.rs`. */
const KEY = "language";
const SLOT = /\{[#=]?(\w+)\}/g;

/** @typedef {(english: string, parts?: Record<string, string | number>) => string} Words */

/** Returns the texts as they are in the program, with their slots filled. @type {Words} */
export const english = (text, parts = {}) => text.replace(SLOT, (_, name) => String(parts[name] ?? ""));

/** Returns the language that is wanted first: that of the link, the one chosen last, those of the browser. @param {string} [linked] */
export function wantedLanguage(linked) {
  let chosen = null;
  try {
    chosen = localStorage.getItem(KEY);
  } catch {
    // The browser denies the store.
  }
  const wanted = [linked, chosen, ...navigator.languages].map((name) => name?.split("-")[0].toLowerCase());
  return wanted.find((name) => name === "en" || (name && name in TABLES)) ?? "en";
}

/** Returns the texts of a table, by the English ones: an English line, and below it an indented one. @param {string} table */
function read(table) {
  const lines = table.split("\n").filter((line) => line !== "" && !line.startsWith("#"));
  const rows = lines.flatMap((line, index) => (line.startsWith("    ") ? [/** @type {const} */ ([lines[index - 1], line.slice(4)])] : []));
  return new Map(rows);
}

/** Returns the texts of a language; the English ones if it has no table, or the table does not arrive. @param {string} language @returns {Promise<Words>} */
export async function wordsOf(language) {
  const address = TABLES[language];
  if (!address) {
    return english;
  }

  try {
    const response = await fetch(address);
    if (!response.ok) {
      throw new Error(`the server answered ${response.status}`);
    }

    const table = read(await response.text());
    return (text, parts) => english(table.get(text) ?? text, parts);
  } catch (error) {
    console.warn(`Tilescope shows English texts, since those of "${language}" did not arrive:`, error);
    return english;
  }
}
