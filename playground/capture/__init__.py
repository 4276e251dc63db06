"""Export what a sketch computes for other programs: heights, textures, the terrain as a mesh.

`export` chooses; `extensions` says what each kind of file holds; `values`, `exr`,
`mesh`, `gltf` and `obj` encode arrays as bytes, and `atomic_group` writes those. Pictures of a
sketch are frames (`playground.engine.frame`), not exports.
"""
