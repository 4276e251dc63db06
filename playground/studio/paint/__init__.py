"""The brush: masks, heights, erosion under the mouse."""
