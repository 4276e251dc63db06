"""The picture: previews, maps, the last good frame; camera, sun and dividers under the mouse."""
