// Direct sun behind its panes, added where no shadow volume covers the surface.
#version 460
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_scalar_block_layout : require
#include "shaders/io/scene.io.h"

layout(location = 0) in vec3 pointInWorld;
layout(location = 1) in vec3 light;
layout(set = 0, binding = 0, scalar) readonly buffer Panes {
    SunPaneHeader header;
    SunPane panes[];
};
layout(set = 0, binding = 1) uniform samplerBuffer paneEdges;
#include "shaders/lib/sun_panes.glsl"

layout(location = 0) out vec4 colour;

void main() {
    colour = vec4(light * sunThroughPanes(pointInWorld), 0);
}
