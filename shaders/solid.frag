// A flat colour, as solid.vert has it.
#version 460
layout(location = 0) flat in vec4 colourIn;
layout(location = 0) out vec4 colour;

void main() {
    colour = colourIn;
}
