// editor_words.js -- every word of the editor and of what is said when a picture fails.

/** @typedef {Object<string, string>} Words */

/** @type {Words} */
export const EDITOR_WORDS = {
  // the editor
  file: "File",
  ownFiles: "Of this sketch",
  kernelFiles: "Passes",
  libraryFiles: "Included files",
  edited: "{name} (edited)",
  broken: "{name} (with an error)",
  field: "Text of {name}",
  keys: "Tab inserts spaces; press Esc, then Tab, to leave the field. Ctrl+/ makes lines comments.",
  resetFile: "Reset this file",
  download: "Download my version",
  unedited: "As in the sketch. What you type is compiled at once.",
  compiling: "Compiling",
  compiled: "Compiled and drawn in {time} ms",
  unused: "Compiled: no pass of the picture uses it",
  problem: "1 error: the picture is the last that worked",
  problems: "{count} errors: the picture is the last that worked",
  place: "{file}:{line}: {message}",
  placeless: "{file}: {message}",
  // what an edit does not do in a page
  header: "What a #pragma says is read by Python: changed, it has no effect in this page, but it has in the "
    + "version that you download.",
  annotation: "What a //! says is read by Python: changed, it has no effect in this page, but it has in the "
    + "version that you download.",
  initial: "{names}: the control holds the value; the new initial value is in the version that you download.",
  added: "{names}: has its initial value and no control in this page; the downloaded version has one.",
  removed: "{names}: the control has no effect any more.",
  // the downloaded version
  downloaded: "{name} is saved: playground live {name} opens it",
  withErrors: "{name} is saved with the errors in it: playground live {name} shows them",
  notSaved: "The version cannot be written: {reason}",
  noPack: "This page does not hold what a version needs",
  valuesAside: "A shader's file holds no settings. What was set in the page is in settings.txt.",
  // when there is no picture
  noWebGL: "This browser offers no WebGL2, so the picture stands still. Update the browser, or allow "
    + "hardware acceleration in its settings.",
  noFloat: "This device cannot draw into floating-point textures, which the sketch needs, so the picture "
    + "stands still.",
  lacks: "This device cannot run the sketch, so the picture stands still: {reason}",
  lost: "The graphics device was lost; the picture is made again as soon as it is back.",
  lostByEdit: "The graphics device gave up while {name} was tried: the last text that worked is back. Your "
    + "text is in the editor; look for a loop that does not end.",
  gone: "The graphics device was lost {count} times, so the picture stands still now. Reload the page to try "
    + "again.",
  notBack: "The graphics device was lost and has not come back: reload the page. Texts that worked are kept.",
  slow: "At {size} this takes about {time} s a picture, and the browser may stop it.",
  smaller: "Draw it at {size}",
  anyway: "Draw it all the same",
  hung: "The text of {name} was being tried when this page was closed: it may loop without end. The last "
    + "text that worked is shown.",
  tryAgain: "Open the text that was tried",
  forget: "Forget it",
};
