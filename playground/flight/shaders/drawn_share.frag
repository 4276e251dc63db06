// Which share of all trees is drawn at a distance: from 0 to `reach`, a texel each.
#include "trees/level.glsl"

uniform float whole;
uniform float reach;
uniform float texels;
out float share;
void main() {
    float away = floor(gl_FragCoord.x) / (texels - 1.0) * reach;
    share = drawn_share(kept_share(away, whole, reach));
}
