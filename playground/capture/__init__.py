"""Take what a sketch makes to other programs: heights, textures, the land as a mesh.

`export` chooses; `endings` says what each kind of file holds; `values`, `pictures`, `exr`,
`mesh`, `gltf` and `obj` turn arrays into bytes, and `together` writes those. Pictures of a
sketch are frames (`playground.engine.frame`), not exports.
"""
