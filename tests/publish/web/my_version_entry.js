// my_version_entry.js -- the page's engine with the editor on it, for tests: a sketch is edited and saved.

import "../../../playground/publish/web/runtime/with_all.js";
import { createEditor } from "../../../playground/publish/web/runtime/editor.js";
import { EDITOR_WORDS } from "../../../playground/publish/web/runtime/editor_words.js";
import { createEngine } from "../../../playground/publish/web/runtime/engine.js";
import { versionFiles } from "../../../playground/publish/web/runtime/my_version.js";
import { createRecovery } from "../../../playground/publish/web/runtime/recovery.js";
import { finished } from "../../../playground/publish/web/runtime/waiting.js";
import { zip } from "../../../playground/publish/web/runtime/zip.js";

/** Open a page's first sketch with an editor below its picture. */
export async function open(page) {
    const canvas = document.createElement("canvas"), [sketch] = page.sketches;
    const engine = createEngine(canvas, page.shared), player = engine.open(sketch);
    await player.load();
    player.render();
    const done = () => finished(engine.parts.context.gl);
    const recovery = createRecovery(document.body, { words: EDITOR_WORDS.en, poster: () => {}, limit: 1e-9 });
    const editor = createEditor(document.body, player, { words: EDITOR_WORDS.en, shown: async () => { player.render(); await done(); } });
    const rows = new Map(sketch.shown.map((row) => [row.path, row]));
    const version = async (values, camera) => {
        const made = {
            texts: editor.drafts, values: new Map(values), rows, camera, time: 0, steps: new Map(), frame: sketch.frame,
        };
        const { files } = await versionFiles(sketch.pack, sketch, page.shared, made);
        return coded(await zip(files));
    };
    const set = (values, camera) => {
        player.state.values = { ...player.state.values };
        for (const [path, value] of values) {
            for (const leaf of rows.get(path).targets) player.state.values[leaf] = value;
        }
        player.state.camera = camera;
        player.render();
    };
    return {
        editor, player, recovery, done, version, set,
        picture: () => { player.render(); return coded(player.picture()); },
    };
}

function coded(bytes) {
    let text = "";
    for (let at = 0; at < bytes.length; at += 32768) text += String.fromCharCode(...bytes.subarray(at, at + 32768));
    return btoa(text);
}
