"""Every value of one texel beside the code, two texels or versions side by side, an expression as a map."""
