// The lists of an irregular z-buffer. Include kernels/hybrid/shadows/bindings.glsl first.
#ifndef WAVEPATH_IZB_GLSL
#define WAVEPATH_IZB_GLSL

#include "kernels/hybrid/shadows/izb_types.h"

layout(set = 0, binding = kBindIzbCells, std430) buffer IzbCellBlock { uint izb_cells[]; };
layout(set = 0, binding = kBindIzbLinks, std430) buffer IzbLinkBlock { uint izb_links[]; };
layout(set = 0, binding = kBindIzbItems) uniform usamplerBuffer izb_items;

uint cell_word(uint cell) { return kIzbFirstCell + kIzbCellWords * cell; }
uint link_word(uint ray) { return kIzbLinkWords * ray; }

#endif
