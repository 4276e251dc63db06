// page_address.js -- keeps a page's address as its session is, and the session as the address says.

import { fragmentOf, readFragment } from "./address.js";
import { terrainRows } from "./session.js";

/** @typedef {import("./session.js").Session} Session */

const SETTLED = 400; // [ms] without a change until the address says it

/** @param {Session} session @param {() => boolean} hasTime whether the time is one that a user has chosen
 *  @param {(names: string[]) => void} refused */
export function followAddress(session, hasTime, refused) {
  let settling = 0;
  const now = () => fragmentOf(session, { time: hasTime() });

  function write() {
    const text = now();
    try {
      history.replaceState(null, "", text ? `#${text}` : location.pathname + location.search);
    } catch { /* the browser keeps the address of this page as it is */ }
  }

  function read() {
    /** @param {import("./schema.js").Sketch} sketch */
    const rowsOf = (sketch) => [...sketch.shown, ...terrainRows(sketch)];
    const link = readFragment(location.hash, session.sketches, rowsOf);
    session.begin(link);
    if (link.refused.length) refused(link.refused);
  }

  session.follow((news) => {
    if (news === "time" && !hasTime()) return;
    clearTimeout(settling);
    settling = setTimeout(write, SETTLED);
  });
  addEventListener("hashchange", () => {
    if (location.hash.slice(1) !== now()) read();
  });
  return {
    read,
    /** The page's address with what differs. */
    link: () => [location.href.split("#")[0], now()].filter(Boolean).join("#"),
  };
}
