// schema.js -- what Python writes and the runtime reads: types only, nothing runs here.
//
// Written by the modules of playground/publish/web. Paths are those of the flat sketch ("height.sum"); texels
// have row 0 south; angles are degrees, lengths metres, times seconds.

/** A number, a name, or an operation on others: see formulas.js.
 *  Names: "time", "frames"; in a kernel's header "size.x", "iteration", a parameter's own name.
 *  Operations: ["+" | "-" | "*" | "/" | "//" | "%" | "**" | "<" | "<=" | ">" | ">=" | "==" | "!=", a, b],
 *  ["log2" | "bits" | "min" | "max" | "abs" | "floor" | "ceil", ...], ["if", test, then, otherwise],
 *  ["size", path, axis]      texels of a pass that says its size; of base "#terrain" or "#frame" those
 *  ["value", path, menu]     what a uniform gets, by the path of the leaf's parameter; menu: by the choice
 *  ["iteration", loop]       the step of the loop at a path, from 0; ["iterations", loop]: its steps in all
 *  ["last", loop, a]         a, in the last iteration of a loop that runs
 *  ["before", loop, a, b]    in a loop's first iteration a, else b in the iteration before
 *  ["text", words, a]        a, with the words that messages call it by: as its author wrote it
 *  @typedef {number | string | Array<any>} Formula */

/** The sizes that a kernel takes, along x and then, where it has others there, y, smallest first: runs of
 *  numbers as the first, the last, and how far one is from the next.
 *  @typedef {[number, number, number][][]} Accepted */

/** A texture: an output of a leaf, or what a loop feeds back under a name.
 *  @typedef {{path: string, output: string} | {loop: string, name: string}} Source */

/** @typedef {number | boolean | string | number[]} Value */

/** How a texture is read.
 *  @typedef {{filter: "nearest" | "linear", wrap: "clamp" | "repeat" | "mirror", mipmap: boolean,
 *             magnify?: "nearest" | "linear", flip?: boolean, decode?: boolean}} Sampling */

/** A parameter of a kernel: a uniform.
 *  @typedef {{name: string, type: string, widget: string, values?: number[], sampling?: Sampling}} Uniform
 *  values: of a menu, what the uniform gets for each choice. */

/** @typedef {{name: string, sampling: Sampling, fallback: "" | "white" | "black" | "zero",
 *             shape: "" | "cube" | "volume" | "layers" | "line"}} Input */

/** How the text of a stage is made of a kernel's flat text (shader/stage_recipe.py): the lines of `before`,
 *  of which one with names stands only where the text names one of them; the kernel's lines, a function
 *  blanked (`without`) or names replaced (`replace`, where `replaceIf` holds); then `after`.
 *  `text` is a whole stage instead, made of no file.
 *  @typedef {{text?: string, before?: Array<{text: string, names?: string[]}>, after?: string,
 *             without?: string, replace?: Object<string, string>, keepsVersion?: boolean,
 *             file?: string}} Stage  file: of its lines, where they are not the kernel's own */

/** A kernel, a draw, a source or a plain shader: what its header says.
 *  @typedef {object} Kernel
 *  @property {string} name                         "generation/diamond_square"
 *  @property {"kernel" | "draw" | "source" | "plain_fragment"} kind
 *  @property {string} file                         in `Shared.files`
 *  @property {string} title
 *  @property {{name: string, format: string}[]} outputs
 *  @property {Input[]} inputs
 *  @property {Uniform[]} parameters
 *  @property {Formula} repeat                   1: it does not repeat
 *  @property {boolean} countsFrames                its iteration n is at n / 60 seconds
 *  @property {boolean} followsTime                 its repeat names a clock
 *  @property {Object<string, string>} initial      input → output that begins with it
 *  @property {Formula} [stride]
 *  @property {Formula} [atOnce]
 *  @property {"unchanged"} [until]                 no more steps are run once one has changed no texel
 *  @property {"" | "squares" | "triangles"} [between]
 *  @property {string} [accepts]                    as the header has it
 *  @property {Accepted} [accepted]                 the same as numbers
 *  @property {string} [mesh]                       of a draw
 *  @property {Formula} [count]                  of a draw: it may name an input's size, as list.size.x
 *  @property {Formula} [instances]              of a draw: it may name an input's first texel, as list.x
 *  @property {"none" | "add" | "alpha"} [blend]
 *  @property {"none" | "less" | "equal"} [depth]
 *  @property {number} [samples]                    of a draw; 0: the sketch's
 *  @property {string[]} [used]                     names in its header besides those in its text
 *  @property {[string, string][]} [usual]          of a plain shader: uniform → what it is given
 *  @property {string} [dialect]
 *  @property {string[]} extensions                 of GLSL ES that its text needs, if any
 *  @property {Stage} vertex
 *  @property {Stage} fragment
 *  @property {TracedText | {lacks: string}} [trace]   its traced fragment shader, or why it has none */

/** A fragment shader that records what it does (engine/trace), and the table of the places that record.
 *  @typedef {object} TracedText
 *  @property {string} text              in desktop GLSL
 *  @property {boolean} quads            four fragments run a quad's texels, so that derivatives are exact
 *  @property {[string, string, string, string, number, number, number, number[]][]} places   of each: kind,
 *      its name, its function, its type, the number of its file, its line, the last one, the loops around it
 *  @property {import("./trace_values.js").Structs} structs
 *  @property {string[]} files           in `Shared.files`, that it is made of */

/** A leaf pass.
 *  @typedef {object} Leaf
 *  @property {string} path
 *  @property {number} kernel                       index in `Sketch.kernels`
 *  @property {[string, Source | null][]} inputs
 *  @property {Object<string, string>} values       parameter of the kernel → path in `Sketch.values`
 *  @property {string | [number, number]} size      texels; where something in a page changes them the path
 *                                                  in `Sketch.passes` that says them, "#terrain" or "#frame"
 *  @property {DataTexture[]} [data]                of a source: its texels
 *  @property {Clock} [clock]                       of a source that plays a file: which second of it shows */

/** What the processor made, exported as texels. Of what plays a file, `frames` are blobs, of which each
 *  shows from its second in `times` on, the first before that, and `length` are the file's seconds.
 *  Where it repeats and hears what came before, `laps` go on after the file's end: from the second `lead` on,
 *  each shows what the one a length later does.
 *  @typedef {{output: string, format: string, size: [number, number], blob: string,
 *             times?: number[], frames?: string[], length?: number, laps?: Laps}} DataTexture */
/** @typedef {{lead: number, times: number[], frames: string[]}} Laps */

/** At a time shows the second `start + speed * time` of the file, modulo its length where `loop` is true:
 *  paths in `Sketch.values`; without `speed` it is 1.
 *  @typedef {{start: string, speed?: string, loop: string}} Clock */

/** @typedef {{path: string, loop: true, countsFrames: boolean, followsTime: boolean, counting: boolean,
 *             body: Node[], feedback: [string, Source | null, {path: string, output: string}][]}} Loop
 *  counting: a size or a count inside names its iteration, so that each has sizes and counts of its own */

/** @typedef {Leaf | Loop} Node */

/** Every pass at every level, by path: its size, where it says one that something in a page changes; of a
 *  loop its repeat.
 *  @typedef {{size?: [Formula, Formula], repeat?: Formula, where: string, locked?: string}} Pass
 *  where: for errors; locked: why a repeat cannot be stopped early, where it cannot. */

/** One row of the panel.
 *  @typedef {object} Shown
 *  @property {string} path                         as --set takes it
 *  @property {string} pass                         the sketch's own pass
 *  @property {string} label
 *  @property {string} type                         GLSL
 *  @property {string} widget                       a row of shader/widgets.json
 *  @property {string} unit
 *  @property {string} group
 *  @property {string} description
 *  @property {string[]} parts                      what a vector's components are
 *  @property {[number | null, number | null][]} ranges   of each number
 *  @property {number | null} step
 *  @property {string[]} choices
 *  @property {boolean} exported                    an inner parameter otherwise
 *  @property {number} main                         its place among what the sketch is about, from 1; 0: none
 *  @property {string} locked                       why it cannot be changed in a page; "": it can
 *  @property {boolean} [raw]                       of a colour: as it is shown, not linear
 *  @property {Value} value                         at first
 *  @property {string[]} targets                    paths in `Sketch.values` */

/** A camera that orbits a point: engine/camera.py.
 *  @typedef {{azimuth: number, elevation: number, distance: number,
 *             target: [number, number, number] | null, field_of_view: number}} Camera */

/** What keyframes say of one thing: sketch/keyframes.py.
 *  @typedef {{of: "camera" | "value", name: string, targets: string[], times: number[], values: Value[],
 *             eases: ("smooth" | "linear" | "hold")[], holds: boolean, angles: number[]}} Track */

/** An angle that follows a direction while it has its default: sketch/follows.py.
 *  @typedef {{targets: string[], default: Value, direction: string, menu: string, choice: number}} Rule */

/** @typedef {{size: [number, number], extent: [number, number], relief: number, base_elevation: number,
 *             locked: string, lockedMetres?: Record<string, string>, extentFollows?: boolean}} Terrain
 *  locked: why its size cannot be changed; "": it can. lockedMetres: likewise of what is in metres, where
 *  it cannot. extentFollows: nothing says the extent, so that its sides are to each other as the size's
 *  are. */

/** One way to make the picture: a graph with its passes in order.
 *  @typedef {object} Sketch
 *  @property {1} format
 *  @property {string} name
 *  @property {string} title
 *  @property {string} file                         of its TOML or kernel, in `Shared.files`
 *  @property {[number, number]} frame              pixels of the picture at first
 *  @property {number} time
 *  @property {Object<string, number>} steps        repeats that are stopped early, by path
 *  @property {number} samples
 *  @property {boolean} aboveGround             an eye under the terrain is raised over it
 *  @property {Terrain} terrain
 *  @property {Camera} camera
 *  @property {{path: string, output: string}} picture
 *  @property {Kernel[]} kernels
 *  @property {Node[]} nodes                        in an order that wiring allows
 *  @property {Object<string, Pass>} passes
 *  @property {string[]} named                      paths of the values that a size or a count names
 *  @property {boolean} namesTime                   one of them names the time
 *  @property {string[]} continued                  draws that a later draw goes on from, with their samples
 *                                                  and depth, by path
 *  @property {Object<string, Value>} values        of each leaf parameter, by path; of a file its key in
 *                                                  `Shared.images`
 *  @property {Shown[]} shown
 *  @property {{name: string, values: Object<string, Value>}[]} presets   by the paths of `shown`, "size",
 *                                                  "relief" …
 *  @property {Track[]} tracks
 *  @property {number} duration                     time of the last keyframe; 0: none
 *  @property {boolean} moves                       its picture follows the time
 *  @property {Rule[]} rules
 *  @property {{ref: string, path: string, output: string, label: string, height: boolean}[]} textures
 *                                                  for maps
 *  @property {MapView} map
 *  @property {Choice[]} choices                    techniques that may be exchanged
 *  @property {string[]} notes                      what a page does otherwise, or cannot, a sentence each */

/** How any texture is shown from above: the kernel view/map, whose input `shown` is wired when asked for.
 *  @typedef {{kernel: number, input: string, values: Object<string, Value>, shown: Shown[],
 *             size: string | [number, number]}} MapView
 *  size: of a map of one of the view's own textures, as of a leaf */

/** A technique menu: another sketch for each technique, with the same paths where they have the same names.
 *  @typedef {{pass: string, label: string, now: string,
 *             others: {use: string, title: string, sketch: number}[]}} Choice
 *  sketch: index in `Page.sketches`. */

/** What sketches share.
 *  @typedef {object} Shared
 *  @property {Object<string, string>} files        GLSL by name: "noise/hash.glsl", "./waves.glsl"
 *  @property {Object<string, Object<string, string>>} includes   file → what it writes → file
 *  @property {Object<string, [string, string]>} given   name → GLSL type and meaning (reserved_names.GIVEN)
 *  @property {Object<string, string>} own          the engine's own shaders: copy.frag, spread.frag,
 *                                                  fill_between.frag, changed.frag
 *  @property {Object<string, {size: [number, number], kind: "rgba8" | "srgb8" | "rgba16f", blob: string,
 *             file?: string}>} images              image files by key; blob: raw texels, row 0 south, or
 *                                                  (file) the file itself, to be decoded by the browser
 *  @property {Object<string, string>} blobs        by key, see packed.js */

/** A page: what one HTML file holds (see packed.js), or what a book's scripts put together.
 *  @typedef {{format: 1, sketches: Sketch[], shared: Shared}} Page */

export {};
