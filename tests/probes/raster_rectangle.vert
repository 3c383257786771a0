// Corners of a rasterization test, already in clip space.
#version 460

struct Corner {
  vec4 position, colour;
};
layout(set = 0, binding = 0, std430) readonly buffer Corners { Corner corners[]; };

layout(location = 0) flat out vec4 colour;
layout(location = 1) flat out uint rectangle;

void main() {
  colour = corners[gl_VertexIndex].colour;
  rectangle = uint(gl_VertexIndex) / 6u + 100u * uint(gl_InstanceIndex);
  gl_Position = corners[gl_VertexIndex].position;
}
