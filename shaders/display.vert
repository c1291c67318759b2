// Corners of the parts of the picture that are drawn.
#version 460
layout(location = 0) in vec2 corner; // clip space

void main() {
    gl_Position = vec4(corner, 0, 1);
}
