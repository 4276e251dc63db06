"""The picture: previews, maps, the last good frame, camera and sun under the mouse."""
