// Light that leaves the surface, kilolux per channel. Alpha 1: simulated.
#version 460

layout(location = 0) in vec3 pointInWorld;
layout(location = 1) in vec3 light;

layout(location = 0) out vec4 colour;

void main() {
    colour = vec4(light, 1);
}
