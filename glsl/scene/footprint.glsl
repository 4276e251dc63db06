// scene/footprint.glsl -- how much of the ground a pixel covers, where nobody draws a triangle.
//
//   gives    PixelRay, pixel_ray, Footprint, footprint_of, level_of
//   needs    nothing: pure functions; the camera and the picture's size come as arguments
//   units    metres; levels of detail, 0 the finest
//   source   ray differentials: Igehy 1999, "Tracing Ray Differentials" (SIGGRAPH), sections 3.1.1
//            and 3.1.2 for a plane; levels as OpenGL 3.3, section 3.8.11, has them
//   tested   tests/glsl/test_scene.py, against rays through neighbouring pixels in float64
//
// A draw knows it from derivatives; a kernel that lights pixels afterwards has none, so that
// it works out where the rays of the neighbouring pixels meet the ground's plane.
#ifndef SCENE_FOOTPRINT
#define SCENE_FOOTPRINT
struct PixelRay {
    vec3 ahead;  // from the eye to the pixel's middle, on the plane far away
    vec3 right;  // what that changes by from a pixel to the next
    vec3 up;
};

struct Footprint {
    vec2 right;  // how far east and north the point lies that the next pixel sees
    vec2 up;
};

// `back` leads from clip space to the world, `from` is the eye, `pixel` a pixel's middle of
// so many. On a plane of clip space places are linear in pixels.
PixelRay pixel_ray(mat4 back, vec3 from, vec2 pixel, vec2 pixels) {
    vec2 step_of = 2.0 / pixels;
    vec4 far = back * vec4(pixel * step_of - 1.0, 1.0, 1.0);
    return PixelRay(far.xyz / far.w - from, back[0].xyz / far.w * step_of.x,
                    back[1].xyz / far.w * step_of.y);
}

// Of a surface seen edge-on a pixel covers no more than this makes of it.
const float FLATTEST = 0.02;

// Of a point on a plane with that normal, `offset` from the eye.
Footprint footprint_of(PixelRay ray, vec3 offset, vec3 normal) {
    float far = length(ray.ahead);
    float part = length(offset) / far;
    float facing = -max(abs(dot(normal, ray.ahead)), FLATTEST * far);
    if (dot(normal, ray.ahead) > 0.0) facing = -facing;
    vec2 right = (ray.right - ray.ahead * (dot(normal, ray.right) / facing)).xy;
    vec2 up = (ray.up - ray.ahead * (dot(normal, ray.up) / facing)).xy;
    return Footprint(part * right, part * up);
}

// The level of detail of a texture with so many texels a metre, east and north.
// anchor: level
float level_of(Footprint foot, vec2 density) {
    vec2 right = foot.right * density;
    vec2 up = foot.up * density;
    return 0.5 * log2(max(max(dot(right, right), dot(up, up)), 1e-12));
}
// end: level
#endif
