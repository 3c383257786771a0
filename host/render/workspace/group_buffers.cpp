#include "host/render/workspace/group_buffers.h"

#include "kernels/base/scene_types.h"
#include "kernels/film/film_types.h"
#include "kernels/path/path_types.h"

namespace wavepath {

std::vector<Binding> group_bindings(const GroupBuffers& groups, const Buffer& film) {
  return {{gpu::kBindGroupTable, BindingKind::texels_r32ui, &groups.table},
          {gpu::kBindPathGroups, BindingKind::storage, &groups.paths},
          {gpu::kBindFilmGroups, BindingKind::storage, &film}};
}

std::vector<Binding> group_layout() {
  std::vector<Binding> layout = group_bindings({}, {});
  for (Binding& binding : layout) binding.buffer = nullptr;
  return layout;
}

} // namespace wavepath
