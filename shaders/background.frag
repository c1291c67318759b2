// Where nothing is drawn.
#version 460
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_scalar_block_layout : require
#include "shaders/io/scene.io.h"

layout(push_constant, scalar) uniform Push { SolidParams params; };

layout(location = 0) out vec4 colour;

void main() {
    colour = params.colour;
}
