// Writes a colour and a number: two attachments of different formats.
#version 460

layout(location = 0) flat in vec4 colour;
layout(location = 1) flat in uint rectangle;
layout(location = 0) out vec4 colour_out;
layout(location = 1) out uint rectangle_out;

void main() {
  colour_out = colour;
  rectangle_out = rectangle;
}
